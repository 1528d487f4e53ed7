"""The files of each format of a model."""

from collections.abc import Callable, Mapping, Sequence

from configs.schema.scenario import RunSpec
from pipeline.models.robot import RobotParts
from pipeline.models.sdf import robot_model
from pipeline.models.sdf_elements import document
from pipeline.models.urdf import robot_model_urdf
from pipeline.models.world import arena_sdf, world_sdf
from symolo.core.errors import InputError, nearest


def _urdf(_spec: RunSpec, parts: RobotParts) -> dict[str, bytes]:
    return {"robot.urdf": robot_model_urdf(parts)}


def _sdf(spec: RunSpec, parts: RobotParts) -> dict[str, bytes]:
    return {
        "robot.sdf": document(robot_model(parts)),
        "arena.sdf": arena_sdf(spec),
        "world.sdf": world_sdf(spec, parts),
    }


FORMATS: Mapping[str, Callable[[RunSpec, RobotParts], dict[str, bytes]]] = {"urdf": _urdf, "sdf": _sdf}


def formats_of(names: Sequence[str], where: str) -> tuple[str, ...]:
    """Return these formats, each once, in the order of `names`.

    Raises:
        InputError: There is no format of a name.
    """
    for name in names:
        if name not in FORMATS:
            raise InputError(where, got=name, allowed=", ".join(FORMATS), nearest=nearest(name, FORMATS))
    return tuple(dict.fromkeys(names))


def model_files(spec: RunSpec, formats: tuple[str, ...]) -> dict[str, bytes]:
    """Return the content of each file of a run's robot and arena by its name; equal specifications give equal bytes."""
    parts = RobotParts.from_spec(spec)
    return {name: data for form in formats for name, data in FORMATS[form](spec, parts).items()}
