"""Images that are taken from inside a wall or an obstacle, and paths that lead through one."""

from collections.abc import Iterator, Sequence
from math import hypot

import numpy as np
from numpy.typing import NDArray

from configs.schema.arena import ArenaConfig
from configs.schema.mesh import MeshFile
from configs.schema.scenario import SceneSpec
from physics.arena.mesh_interior import contains
from pipeline.stages.cameras import RunCamera, cameras_of
from symolo.arena.footprints import obstacle_footprint, wall_footprint
from symolo.arena.mesh import unpacked
from symolo.arena.obstacle_motion import ObstacleMotion
from symolo.core.arrays import Array
from symolo.core.geometry.pinhole import pose_X_RC
from symolo.core.geometry.poses import pose_X_WR
from symolo.core.progress import plural
from symolo.dataset.tables.rows import Rows

STEP_M = 0.005
"""Distance between the places at which a path is examined; walls are usually thicker."""
MAX_PLACES = 20_000
MAX_PLACES_IN_MESH = 1000
"""Places in the box around a mesh that are examined; a place between them counts as the one before."""
PATH_HEIGHT_M = 0.001
"""Height at which the path is examined, just above the lower side of things on the floor."""


def inside_warnings(spec: SceneSpec, rows: Rows) -> tuple[str, ...]:
    """Return a line for each camera and thing whose inside is seen, or else one for each thing on the path.

    Args:
        spec: The arena and the robot.
        rows: Rows of data.csv.
    """
    cameras = tuple(text for camera in cameras_of(spec) for text in _camera_texts(camera, rows))
    return cameras or tuple(_on_the_path(spec, rows))


def things_around(camera: RunCamera, rows: Rows) -> dict[int, str]:
    """Return wall or obstacle by the number of each image of a camera that is taken from inside it."""
    spec, at_images = camera.spec, camera.rows(rows)
    taken = at_images.image > 0
    pose, t_s = at_images.pose[taken], 1e-3 * at_images.t_ms[taken]
    X_RC = pose_X_RC(spec.robot.camera, spec.robot.chassis.base_height_m)
    places = np.array([(pose_X_WR(*each) @ X_RC)[:3, 3] for each in pose.tolist()]).reshape(-1, 3)
    around = {}
    for name, inside in _insides(spec.arena, places, t_s, only_solid=False):
        around |= dict.fromkeys(at_images.image[taken][inside].tolist(), name)
    return around


def _camera_texts(camera: RunCamera, rows: Rows) -> Iterator[str]:
    around, at_images = things_around(camera, rows), camera.rows(rows)
    taken = at_images.image > 0
    for name in dict.fromkeys(around.values()):
        numbers = [number for number, thing in around.items() if thing == name]
        t_s = 1e-3 * float(at_images.t_ms[at_images.image == min(numbers)][0])
        which = f"the camera {camera.name}" if camera.name else "the camera"
        images = f"{len(numbers)} of {plural(int(taken.sum()), 'image')}"
        yield f"at {t_s:.1f} s {which} is inside {name}, as in {images}: move {name}, or choose another arena or path"


def _on_the_path(spec: SceneSpec, rows: Rows) -> Iterator[str]:
    """Yield the solid things that the middle of the axle drives through."""
    place, row_t_s = rows.pose[:, :2], 1e-3 * rows.t_ms
    along_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(place, axis=0).T))])
    count = min(MAX_PLACES, 2 + int(along_m[-1] / STEP_M))
    at_m = np.linspace(0.0, along_m[-1], count)
    # The times of the rows, too: while a robot stands, an obstacle may drive through it.
    t_s = np.union1d(np.interp(at_m, along_m, row_t_s), row_t_s)
    x, y = (np.interp(t_s, row_t_s, values) for values in place.T)
    for name, inside in _insides(
        spec.arena, np.stack([x, y, np.full(len(x), PATH_HEIGHT_M)], axis=1), t_s, only_solid=True
    ):
        first = int(np.argmax(inside))
        yield f"at {t_s[first]:.1f} s the robot drives through {name}, at x = {x[first]:.2f}, y = {y[first]:.2f} m"


def _insides(
    arena: ArenaConfig, places: Array, t_s: Array, *, only_solid: bool
) -> Iterator[tuple[str, NDArray[np.bool_]]]:
    """Yield the name of each thing that contains some of the places (N, 3) at the times (N,), and which ones."""
    for wall in arena.walls:
        if hypot(wall.end[0] - wall.start[0], wall.end[1] - wall.start[1]) > 0.0:
            body = wall_footprint(wall)
            pose = np.array([(*body.center, body.yaw_rad)])
            inside = _inside(places, pose, (*body.size, wall.height_m))
            yield from [(f"wall {wall.name}", inside)] if inside.any() else []
    for obstacle in arena.obstacles:
        if only_solid and not obstacle.solid:
            continue
        body, motion = obstacle_footprint(obstacle), ObstacleMotion.from_config(obstacle)
        pose = np.array([(*body.center, body.yaw_rad)]) if motion is None else motion.poses_at(t_s)
        inside = _inside(places, pose, obstacle.size)
        if obstacle.mesh is not None and inside.any():
            inside[inside] = _inside_mesh(obstacle.mesh, places[inside], pose[inside] if len(pose) > 1 else pose)
        yield from [(f"obstacle {obstacle.name}", inside)] if inside.any() else []


def _inside(places: Array, pose: Array, size: Sequence[float]) -> NDArray[np.bool_]:
    """Return which places (N, 3) are inside a box on the floor with poses (N, 3) or (1, 3)."""
    ahead, left, up = np.abs(_in_frame(places, pose)).T
    length_m, width_m, height_m = size
    return (ahead < 0.5 * length_m) & (left < 0.5 * width_m) & (places[:, 2] >= 0.0) & (up < height_m)


def _inside_mesh(mesh: MeshFile, places: Array, pose: Array) -> NDArray[np.bool_]:
    """Return which places (N, 3) in the box around a mesh with poses (N, 3) or (1, 3) are inside the mesh itself."""
    examined = np.arange(0, len(places), 1 + len(places) // MAX_PLACES_IN_MESH)
    inside = contains(unpacked(mesh.packed), _in_frame(places, pose)[examined])
    return inside[np.searchsorted(examined, np.arange(len(places)), side="right") - 1]


def _in_frame(places: Array, pose: Array) -> Array:
    """Return places (N, 3) in the frame of a body on the floor with poses (N, 3) or (1, 3)."""
    x, y = (places[:, :2] - pose[:, :2]).T
    c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    return np.stack([c * x + s * y, c * y - s * x, places[:, 2]], axis=1)
