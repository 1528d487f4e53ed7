"""Instances and categories of a scene's meshes, for masks."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from blender_scenes.scene.description import Scene
from sensors.camera.views import FrameView
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.core.geometry.poses import pose_X_WR
from symolo.dataset.annotations import CATEGORIES, Category

ON_THE_FLOOR = frozenset({"floor", "line"})
"""Categories on which the robot may drive; they are flat and hide nothing."""


@dataclass(frozen=True)
class Instance:
    """A wall, an obstacle, the line or another thing that annotations name."""

    id: int
    """Number from 1; 0 means that there is no surface."""
    name: str
    """Name in the arena, else the mesh's name."""
    category: Category
    moving: int | None = None
    """Index of its pose among a view's moving poses; None if it stands still, and for the robot."""

    @property
    def moves(self) -> bool:
        return self.moving is not None or self.category == "robot"

    def pose_X_WI(self, view: FrameView) -> Array:
        """Return the pose (4, 4) of the frame of its geometry: W, R, or its own frame if it moves."""
        if self.category == "robot":
            return pose_X_WR(*view.robot_pose)
        return np.eye(4) if self.moving is None else pose_X_WR(*view.moving[self.moving])


@dataclass(frozen=True)
class Instances:
    """All instances of a scene, with those that its meshes belong to."""

    known: tuple[Instance, ...]
    """All instances, sorted by id."""
    of_mesh: tuple[int, ...]
    """Instance of each mesh: at 0 for no mesh, from 1 the scene's meshes, then the robot's, then the moving ones."""

    def named(self, name: str, category: Category) -> Instance:
        return next(one for one in self.known if (one.name, one.category) == (name, category))

    @property
    def category_ids(self) -> NDArray[np.int64]:
        """Category of each instance by its id; 0 for id 0."""
        return np.array([0, *(CATEGORIES.index(one.category) for one in self.known)])


class _NamedMesh(NamedTuple):
    name: str
    category: Category


def instances(scene: Scene, arena: Arena) -> Instances:
    """Return an instance for each mesh, in the order of `Scene.meshes`, and one for the whole robot.

    Raises:
        ValueError: The scene does not belong to the arena.
    """
    line = range(len(arena.line.strips))
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
