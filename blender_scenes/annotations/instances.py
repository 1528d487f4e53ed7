"""What each mesh of a scene is to somebody who reads its masks: an instance with an id, and a category."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from blender_scenes.scene.description import Scene
from sensors.camera.views import FrameView
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.core.poses import pose_X_WR
from symolo.dataset.annotations import CATEGORIES, Category

ON_THE_FLOOR = frozenset({"floor", "line"})
"""What the robot may drive on; flat, so that it hides nothing."""


@dataclass(frozen=True)
class Instance:
    id: int
    """From 1; 0 is where no surface is met."""
    name: str
    """As the arena calls it, else the mesh's name."""
    category: Category
    moving: int | None = None
    """Which of a view's moving poses it has; None for what stands still, and for the robot."""

    @property
    def moves(self) -> bool:
        return self.moving is not None or self.category == "robot"

    def pose_X_WI(self, view: FrameView) -> Array:
        """(4, 4) pose of the frame that its geometry is told in: W itself, its own where it moves, or R."""
        if self.category == "robot":
            return pose_X_WR(*view.robot_pose)
        return np.eye(4) if self.moving is None else pose_X_WR(*view.moving[self.moving])


@dataclass(frozen=True)
class Instances:
    known: tuple[Instance, ...]
    """By their ids."""
    of_mesh: tuple[int, ...]
    """Id of each mesh by its number: 0 no mesh, from 1 the scene's meshes, then the robot's, then the moving ones."""

    def named(self, name: str, category: Category) -> Instance:
        return next(one for one in self.known if (one.name, one.category) == (name, category))

    @property
    def category_ids(self) -> NDArray[np.int64]:
        """(known + 1,), category id by instance id."""
        return np.array([0, *(CATEGORIES.index(one.category) for one in self.known)])


class _NamedMesh(NamedTuple):
    name: str
    category: Category


def instances(scene: Scene, arena: Arena) -> Instances:
    """One instance for each mesh, by the order that `Scene.meshes` has, but one for all of the robot.

    Raises:
        ValueError: The scene has less than the arena.
    """
    line = range(len(arena.line.pieces))
    standing = [box for box in arena.boxes if box.motion is None]
    named = [_NamedMesh("floor", "floor"), *(_NamedMesh(f"line_{i}", "line") for i in line)]
    named += [_NamedMesh(box.name, box.kind) for box in standing]
    still, moving, arenas = len(scene.meshes), len(scene.moving), len(named)
    if arenas > still or moving != len(arena.moving):
        raise ValueError(f"a scene of {still} meshes and {moving} moving ones is not of arena {arena.name}")
    named += [_NamedMesh(mesh.name, "room") for mesh in scene.meshes[arenas:]]
    named += [_NamedMesh(box.name, box.kind) for box in arena.moving]
    known = [Instance(i + 1, *one, moving=i - still if i >= still else None) for i, one in enumerate(named)]
    robot = Instance(len(known) + 1, "robot", "robot")
    of_mesh = (*range(still + 1), *[robot.id] * len(scene.robot_parts), *range(still + 1, still + moving + 1))
    return Instances((*known, robot), of_mesh)
