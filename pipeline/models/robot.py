"""The parts of a robot model beside the simulated links: visual shapes and frames of the sensors."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import radians

import numpy as np

from blender_scenes.scene.robot_body import robot_body
from configs.effects.base import Slot
from configs.robot_sensors import MountedSettings
from configs.schema.robot import RobotConfig, TofMount, TofMounts
from configs.schema.scenario import RunSpec, SceneSpec
from physics.robot.links import BASE, CASTER, LEFT_WHEEL, RIGHT_WHEEL, BoxShape, RobotLink, robot_links
from physics.robot.model import applied
from pipeline.models.colours import colours
from pipeline.models.geometry import CylinderShape, Placement, Visual, bounding_box
from pipeline.stages.cameras import cameras_of
from symolo.core.geometry.pinhole import Intrinsics, horizontal_field_of_view_rad, intrinsics, pose_X_RC
from symolo.dataset.documents.camera_model import X_CB
from symolo.dataset.documents.camera_specification import KIND
from symolo.dataset.documents.sensor_sections import optical_frame, sensor_frame
from symolo.dataset.rates import IMAGE_HZ

CAMERA, CAMERA_OPTICAL, LINE_SENSOR = "camera_link", "camera_optical_frame", "line_sensor"
_ROUND = {
    "robot_tyre_left": LEFT_WHEEL,
    "robot_hub_left": LEFT_WHEEL,
    "robot_tyre_right": RIGHT_WHEEL,
    "robot_hub_right": RIGHT_WHEEL,
    "robot_caster": CASTER,
}
"""Link of each part of the rendered robot that is a cylinder; all other parts are boxes of the base."""


@dataclass(frozen=True)
class NamedFrame:
    """A named frame that is fixed to the base."""

    name: str
    placement: Placement
    """Pose in R."""


@dataclass(frozen=True)
class Lens:
    """A camera: its lens, rate and whether it sees the robot."""

    intrinsics: Intrinsics
    horizontal_field_of_view_rad: float
    rate_hz: float
    sees_robot: bool

    @classmethod
    def from_spec(cls, spec: SceneSpec, rate_hz: float) -> "Lens":
        """Return the camera of data.csv of a specification."""
        camera = spec.robot.camera
        lens = intrinsics(camera, spec.render.width_px, spec.render.height_px)
        wide_rad = 2 * lens.fisheye.half_field_rad if lens.fisheye else horizontal_field_of_view_rad(camera)
        return cls(lens, wide_rad, rate_hz, camera.sees_robot)


@dataclass(frozen=True)
class RobotParts:
    """A robot as model files describe it: bodies, visual shapes, frames and cameras."""

    config: RobotConfig
    links: tuple[RobotLink, ...]
    visuals: dict[str, tuple[Visual, ...]]
    """Visual shapes by link."""
    frames: tuple[NamedFrame, ...]
    """`camera_link` (x along the axis), `camera_optical_frame` (z along the axis), `tof_*` (x along the axis),
    `line_sensor`, and `sensors/NAME` for each sensor of `robot.sensors` that has a place."""
    lens: Lens
    """The camera of data.csv."""
    further_lenses: dict[str, Lens]
    """The further cameras by name."""
    control_hz: int
    """Rate of the controller [Hz]."""

    @classmethod
    def from_spec(cls, spec: RunSpec) -> "RobotParts":
        links = robot_links(spec.robot)
        return cls(
            spec.robot,
            links,
            _visuals(spec, links),
            frames(spec.robot),
            Lens.from_spec(spec, spec.rates.camera_hz or IMAGE_HZ),
            {one.name: Lens.from_spec(one.spec, 1 / one.period_s) for one in cameras_of(spec)[1:]},
            spec.rates.control_hz,
        )

    def frame(self, name: str) -> NamedFrame:
        return next(frame for frame in self.frames if frame.name == name)


def frames(robot: RobotConfig) -> tuple[NamedFrame, ...]:
    X_RC = pose_X_RC(robot.camera, robot.chassis.base_height_m)
    line = robot.line_sensor
    return (
        NamedFrame(CAMERA, Placement.from_pose(X_RC @ np.array(X_CB))),
        NamedFrame(CAMERA_OPTICAL, Placement.from_pose(X_RC)),
        *tof_frames(robot),
        NamedFrame(LINE_SENSOR, Placement((line.x_m, 0.0, line.height_m))),
        *_further_frames(robot),
    )


def _further_frames(robot: RobotConfig) -> Iterator[NamedFrame]:
    """Yield the frame of each sensor of `robot.sensors` that has a place, and that of the pixels of a camera."""
    for name, settings in robot.sensors:
        if isinstance(settings, MountedSettings):
            X_RS = settings.X_RS()
            yield NamedFrame(sensor_frame(name), Placement.from_pose(X_RS))
            if settings.kind == KIND:
                yield NamedFrame(optical_frame(name), Placement.from_pose(X_RS @ np.linalg.inv(X_CB)))


def tof_frames(robot: RobotConfig) -> tuple[NamedFrame, ...]:
    """Return the frames of the front, left and right sensor, turned by the effects of the robot."""
    askew = applied(robot.effects.functions(Slot.RANGE_MOUNT), np.zeros(3))
    names = tuple(TofMounts.model_fields)
    mounts: list[TofMount] = [getattr(robot.tof.mounts, name) for name in names]
    return tuple(
        NamedFrame(
            f"tof_{name}",
            Placement(
                (mount.x_m, mount.y_m, mount.z_m),
                (0.0, -radians(mount.pitch_up_deg) + 0.0, radians(mount.yaw_deg) + extra_rad),
            ),
        )
        for name, mount, extra_rad in zip(names, mounts, askew.tolist(), strict=True)
    )


def _visuals(spec: RunSpec, links: tuple[RobotLink, ...]) -> dict[str, tuple[Visual, ...]]:
    colour = colours(spec)
    visuals: dict[str, list[Visual]] = {link.name: [] for link in links}
    for mesh in robot_body(spec.robot):
        link = _ROUND.get(mesh.name, BASE)
        center, size = bounding_box(mesh)
        if link == BASE:
            visual = Visual(mesh.name, BoxShape(size), center, colour[mesh.name])
        else:  # about its own axle, wherever the effects of the robot have put that
            visual = Visual(mesh.name, CylinderShape(0.5 * size[2], size[1]), (0.0, 0.0, 0.0), colour[mesh.name])
        visuals[link].append(visual)
    return {link: tuple(shapes) for link, shapes in visuals.items()}
