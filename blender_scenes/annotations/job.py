"""The annotation of a run's images as a file: geometry, views, instances and key points."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import get_args

import numpy as np

from blender_scenes.annotations.instances import Instances, instances
from blender_scenes.render.job import RenderJob
from blender_scenes.render.job_text import JobText
from blender_scenes.render.light_paths import LightPathLimits
from blender_scenes.render.sampling import TracingSettings
from blender_scenes.scene.description import Mesh, Point3, Scene, Sky
from blender_scenes.scene.shading import Color, Surface
from sensors.camera.views import FrameView
from symolo.arena.geometry import Arena, Box
from symolo.core.arrays import Array
from symolo.core.geometry.pinhole import Intrinsics, Shutter
from symolo.core.geometry.poses import PlanarPose, pose_X_WR
from symolo.dataset.annotations import RECORD_KINDS, AnnotationName, KeyPoint, annotation_file

RECORDS_DIR = "records"

_LINE_SPACING_M = 0.05
_ONE_RAY = TracingSettings(
    seed=0,
    samples=1,
    denoise=False,
    paths=LightPathLimits(0, 0, 0, caustics=False, clamp=0.0),
    filter_width_px=0.01,  # the minimum in Blender: no ray is more than 0.005 px from the pixel's middle
)
_CORNERS = np.array([(x, y, z) for z in (-0.5, 0.5) for x, y in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))])
_PLAIN = Surface("plain", Color((0.5, 0.5, 0.5)))
_DARK = Sky("studio", 0.0, 0.0, 1.0, 1.0)


@dataclass(frozen=True)
class Solid:
    """A wall or an obstacle as a box; its frame O is in the box's middle, with axes along the edges."""

    instance_id: int
    size_m: Point3
    pose: PlanarPose
    """Pose of the point below O on the floor, in the frame of the instance."""

    def pose_X_WO(self, X_WI: Array) -> Array:
        """Return the pose (4, 4) of O in W from that of the instance's frame."""
        X_IO = pose_X_WR(*self.pose)
        X_IO[2, 3] = 0.5 * self.size_m[2]
        return X_WI @ X_IO

    def corners(self, X_WI: Array) -> Array:
        """Return the corners (8, 3) in W, the lower four first, counter-clockwise."""
        X_WO = self.pose_X_WO(X_WI)
        return (_CORNERS * self.size_m) @ X_WO[:3, :3].T + X_WO[:3, 3]


@dataclass(frozen=True)
class AnnotationJob(JobText):
    """What a Blender process needs to annotate the images of a run."""

    FORMAT = 4
    KIND = "annotation"

    kinds: tuple[AnnotationName, ...]
    scene: Scene
    """The scene's geometry without light, all of one opaque surface, so that glass counts as a surface."""
    camera: Intrinsics
    frames: tuple[FrameView, ...]
    sampling: TracingSettings
    shutter: Shutter
    """Shutter of an instant: annotations hold for the frame's time."""
    instances: Instances
    solids: tuple[Solid, ...]
    key_points: tuple[KeyPoint, ...]

    def following(self, number: int) -> FrameView | None:
        """Return the view after that of a number; None after the last."""
        numbers = [view.number for view in self.frames]
        later = numbers.index(number) + 1
        return self.frames[later] if later < len(numbers) else None

    def files(self, number: int) -> tuple[str, ...]:
        """Return the names of a frame's files; the last frame has no flow."""
        last = self.following(number) is None
        images = [kind for kind in self.kinds if kind not in RECORD_KINDS and not (kind == "flow" and last)]
        records = [record_file(number)] if set(RECORD_KINDS) & set(self.kinds) else []
        return (*(annotation_file(kind, number) for kind in images), *records)


def record_file(number: int) -> str:
    return f"{RECORDS_DIR}/{number:06d}.json"


def build_annotation_job(job: RenderJob, arena: Arena, kinds: Sequence[AnnotationName]) -> AnnotationJob:
    """Return the annotation job of a run; materials, light and camera response do not matter to it."""
    known = instances(job.scene, arena)
    return AnnotationJob(
        format=AnnotationJob.FORMAT,
        kinds=tuple(kind for kind in get_args(AnnotationName) if kind in kinds),
        scene=_geometry(job.scene),
        camera=job.camera,
        # Of a view only the poses at its time matter.
        frames=tuple(FrameView(v.number, v.t_s, v.robot_pose, v.X_WC, v.moving) for v in job.frames),
        sampling=_ONE_RAY,
        shutter=Shutter(),
        instances=known,
        solids=tuple(_solid(box, known) for box in arena.boxes),
        key_points=tuple(KeyPoint(i, *point) for i, point in enumerate(_key_points(arena, known), start=1)),
    )


def _geometry(scene: Scene) -> Scene:
    def plain(meshes: tuple[Mesh, ...]) -> tuple[Mesh, ...]:
        return tuple(replace(mesh, face_surface=(_PLAIN.name,) * len(mesh.faces)) for mesh in meshes)

    return Scene(
        surfaces=(_PLAIN,),
        meshes=plain(scene.meshes),
        robot=plain(scene.robot),
        panels=(),
        sun=None,
        sky=_DARK,
        moving=plain(scene.moving),
        robot_in_sight=plain(scene.robot_in_sight),
    )


def _solid(box: Box, known: Instances) -> Solid:
    pose = (*box.center[:2], box.yaw_rad) if box.motion is None else (0.0, 0.0, 0.0)
    return Solid(known.named(box.name, box.kind).id, box.size, pose)


def _key_points(arena: Arena, known: Instances) -> Iterator[tuple[str, str, int, Point3]]:
    """Yield name, kind, instance and place of points along the middle of the line, and of the corners of boxes."""
    for i, strip in enumerate(arena.line.strips):
        line = known.named(f"line_{i}", "line")
        along = np.linspace(0.0, strip.length_m, math.ceil(strip.length_m / _LINE_SPACING_M) + 1)
        for k, (x, y) in enumerate(strip.at(along).tolist()):
            yield f"{line.name}_{k:02d}", "line", line.id, (x, y, 0.0)
    for box in arena.boxes:
        solid = _solid(box, known)
        for k, (x, y, z) in enumerate(solid.corners(np.eye(4)).tolist()):
            yield f"{box.name}_{k}", f"{box.kind}_corner", solid.instance_id, (x, y, z)
