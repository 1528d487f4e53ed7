"""The robot of the images: its cameras and its body may be new, while the readings are those of the run."""

from collections.abc import Sequence
from typing import Any

from configs.draw import draw_robot
from configs.effects.robot_effects import RobotEffects
from configs.loader import load_section, section_of
from configs.robot_sensors import RobotSensors
from configs.schema.robot import RobotConfig
from configs.schema.scenario import SceneSpec
from symolo.core.errors import InputError
from symolo.dataset.documents.camera_specification import KIND as CAMERA

NEW = ("name", "description", "chassis", "body", "camera")
"""Sections of the robot that may be new; of its sensors, the further cameras."""
_WITHOUT_CODE = {"effects": RobotEffects(), "effect_files": (), "sensor_files": ()}
"""Fields of a robot without the user's own code: images do not depend on it, so that its files need not be loaded."""
_ALLOWED = "fields of robot.chassis, robot.body, robot.camera, and cameras of robot.sensors"
_SIMULATE = "the readings of the run are those of its own robot; to change these, simulate again"
_LOGGED = "the readings of the run are those of its log"


def robot_of_images(
    spec: SceneSpec, name: str | None, overrides: Sequence[str], seed: int
) -> tuple[RobotConfig, dict[str, Any] | None]:
    """Return the robot of a run's images with its drawn values, which are None if it is that of the run.

    Args:
        spec: Specification of the run.
        name: Robot, shipped or a file, whose cameras and body are shown; None for that of the run.
        overrides: Settings such as `robot.camera.pitch_down_deg=20`.
        seed: Seed of random values.

    Raises:
        InputError: A setting is wrong, or readings of the run depend on it.
    """
    if name is None and not overrides:
        return spec.robot, None
    for text in overrides:
        _check_seen(spec, text)
    robot_of_run = spec.robot.model_copy(update={**_WITHOUT_CODE, "sensors": _cameras(spec.robot)})
    section = (
        section_of("robot", robot_of_run.model_dump(mode="json"), "robot of the run", overrides)
        if name is None
        else load_section("robot", name, overrides)
    )
    robot, new_drawn = draw_robot(section, seed, *spec.drawn_as)
    _check_are_cameras(robot, overrides)
    sensors = RobotSensors(tuple(sorted([*_others(spec), *_without_clash(spec, robot)], key=lambda member: member[0])))
    if spec.is_imported:
        code = {} if name else {field: getattr(spec.robot, field) for field in _WITHOUT_CODE}
        return robot.model_copy(update={**code, "sensors": sensors}), dict(new_drawn)
    cameras = set(_cameras(robot).names) | set(_cameras(spec.robot).names)
    unchanged = {
        path: value for path, value in spec.drawn.items() if path.startswith("robot.") and not _is_new(path, cameras)
    }
    shown = {path: value for path, value in new_drawn.items() if _is_new(path, cameras)}
    changes = {part: getattr(robot, part) for part in NEW}
    return spec.robot.model_copy(update={**changes, "sensors": sensors}), unchanged | shown


def _check_seen(spec: SceneSpec, text: str) -> None:
    """Refuse a setting on which readings of the run depend."""
    _, part, sensor, *_ = (*text.partition("=")[0].strip().split("."), "", "")
    if part == "sensors":
        if sensor in dict(_others(spec)):
            cure = _LOGGED if spec.is_imported else _SIMULATE
            raise InputError("--set", got=text, allowed=_ALLOWED, cure=cure)
    elif part and part not in NEW and not spec.is_imported:
        raise InputError("--set", got=text, allowed=_ALLOWED, cure=_SIMULATE)


def _check_are_cameras(robot: RobotConfig, overrides: Sequence[str]) -> None:
    """Refuse a setting of a new sensor of another kind, which has no readings in the dataset."""
    others = [member[0] for member in robot.sensors if not _is_camera(member)]
    for text in overrides:
        for name in others:
            if text.strip().startswith((f"robot.sensors.{name}.", f"robot.sensors.{name}=")):
                cure = "it has no readings in the dataset; to get them, simulate again"
                raise InputError("--set", got=text, allowed=_ALLOWED, cure=cure)


def _without_clash(spec: SceneSpec, robot: RobotConfig) -> RobotSensors:
    """Return the cameras of the new robot, whose names the other sensors of the run must not have."""
    cameras = _cameras(robot)
    for name in cameras.names:
        if name in dict(_others(spec)):
            what = f"robot.sensors.{name} is a camera of the new robot, and a sensor of another kind of {spec.key}"
            raise InputError(what, cure="give the camera another name")
    return cameras


def _cameras(robot: RobotConfig) -> RobotSensors:
    """Return the further cameras of a robot."""
    return RobotSensors(tuple(member for member in robot.sensors if _is_camera(member)))


def _others(spec: SceneSpec) -> list[tuple[str, Any]]:
    """Return the sensors of the run that are not cameras."""
    return [member for member in spec.robot.sensors if not _is_camera(member)]


def _is_camera(member: tuple[str, Any]) -> bool:
    name, settings = member
    return (settings.kind or name) == CAMERA


def _is_new(path: str, cameras: set[str]) -> bool:
    """Return whether a drawn value, by its path from `robot`, belongs to a part that may be new."""
    _, part, *rest = path.split(".")
    return rest[0] in cameras if part == "sensors" and rest else part in NEW
