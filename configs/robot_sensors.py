"""The sensors of one robot beside those of the paper: the section `robot.sensors`.

Each has a name and a kind. `rear: {kind: lidar, ...}` is a lidar with the name `rear`. A sensor whose name is its kind
needs no `kind`: `lidar: {...}`.
"""

import importlib
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Annotated, Any, Literal, Union

import numpy as np
from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ValidationInfo,
    create_model,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from configs.schema.base import Fixed, Section, absent, disagreement
from configs.schema.code_file import CodeFile
from configs.validation.faults import ConfigFault
from symolo.core.arrays import Array
from symolo.core.geometry.poses import mounted
from symolo.dataset.tables.sensor_tables import SENSOR_NAME, TAKEN_NAMES

KNOWN_ONLY: Mapping[str, bool] = MappingProxyType({"known_sensors_only": True})
"""Context of a validation that refuses a sensor whose class is not loaded, as for the file of a scenario. Without
it, as for a release, the settings of such a sensor are read as they are."""


class SensorSettings(Section):
    """Settings that all sensors of `robot.sensors` have."""

    kind: Annotated[str, Fixed("the other settings depend on it")] = ""
    """Kind of the sensor. It may be left out if the name of the sensor is the kind."""
    period_s: float = Field(default=0.05, gt=0, le=1)
    """Time between two samples."""
    delay_s: float = Field(default=0.0, ge=0, le=1)
    """Time from a sample until it is delivered."""

    def faults(self) -> Iterator[ConfigFault]:
        """Yield the contradictions between the settings; paths start at the settings of the sensor."""
        yield from ()


class MountedSettings(SensorSettings):
    """Settings of a sensor that has a place on the robot; its frame S has x forward, y left and z up (REP 103)."""

    x_m: float = Field(default=0.0, ge=-1, le=1)
    """Place ahead of the axle [m]."""
    y_m: float = Field(default=0.0, ge=-1, le=1)
    """Place to the left of the robot's middle [m]."""
    z_m: float = Field(default=0.05, ge=0, le=2)
    """Height above the floor [m]."""
    yaw_deg: float = Field(default=0.0, ge=-180, le=180)
    """Direction of the x axis to the left of straight ahead."""
    pitch_up_deg: float = Field(default=0.0, ge=-90, le=90)
    """Direction of the x axis above the horizon."""
    roll_deg: float = Field(default=0.0, ge=-180, le=180)
    """Rotation about the x axis, clockwise as seen from behind the sensor."""

    def X_RS(self) -> Array:
        """Return the pose (4, 4) of the sensor's frame in R."""
        return mounted((self.x_m, self.y_m, self.z_m), *np.radians([self.yaw_deg, self.pitch_up_deg, self.roll_deg]))


IS_LOGGED = "logged"
"""Setting of a sensor whose samples are those of a log: nothing is known of it but the settings that its file has."""


class UnloadedSettings(BaseModel):
    """Settings of a sensor of a log, or of one whose class is not loaded, with the names and values of its file."""

    model_config = ConfigDict(extra="allow", frozen=True)

    kind: str = Field(default="", exclude_if=lambda kind: not kind)


def unloaded_settings(name: str, values: dict[str, Any], file: CodeFile) -> UnloadedSettings:
    """Return the settings of a sensor whose file is not loaded, or has changed since."""
    del name, file  # the robot has a record of the file
    return UnloadedSettings.model_validate(values)


Members = tuple[tuple[str, SensorSettings | UnloadedSettings], ...]


def sensors_section() -> type[Section]:
    """Return the schema of `robot.sensors`, with the kinds that there are now."""
    return _section(_kinds())


def _kinds() -> tuple[tuple[str, str, type[SensorSettings]], ...]:
    """Return name, name of the class and settings of each kind of sensor."""
    # Sensors are in a package above this one, so they are imported by name when they are first needed.
    return importlib.import_module("sensors.registry").settings_by_kind()


@cache
def _section(kinds: tuple[tuple[str, str, type[SensorSettings]], ...]) -> type[Section]:
    """Return the schema for kinds with their names, the names of their classes and their settings.

    A key that is a kind has the settings of this kind; any other key needs a field `kind`, which selects them.
    """
    models: dict[str, Any] = {}
    for kind, title, settings in kinds:
        kind_field: Any = (Literal[kind], Field(default=kind, description="Kind of the sensor."))
        models[kind] = create_model(title, __base__=settings, __doc__=settings.__doc__, kind=kind_field)
    any_settings = Union[tuple(models.values())]  # noqa: UP007 - the kinds are known only now
    if len(models) > 1:
        any_settings = Annotated[any_settings, Field(discriminator="kind")]
    by_name = {kind: model for kind, model in models.items() if kind not in TAKEN_NAMES}
    annotations: dict[str, Any] = {"__pydantic_extra__": dict[str, any_settings | None]}
    content: dict[str, Any] = {
        "__annotations__": annotations | {kind: model | None for kind, model in by_name.items()},
        "__doc__": "Sensors by name. If the name is one of the kinds below, it is a sensor of this kind; otherwise"
        " `kind` names the kind, as in `rear: {kind: imu}`. `null` removes a sensor of the robot that it extends.",
        "__module__": __name__,
        "model_config": ConfigDict(extra="allow", title="RobotSensors"),
        **{kind: Field(default_factory=absent) for kind in by_name},
    }
    return type("SensorsByName", (Section,), content)


@dataclass(frozen=True)
class RobotSensors:
    """Immutable collection of the settings of sensors by name, in the order of the names."""

    members: Members = ()

    def __iter__(self) -> Iterator[tuple[str, SensorSettings | UnloadedSettings]]:
        return iter(self.members)

    def __len__(self) -> int:
        return len(self.members)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the sensors."""
        return tuple(name for name, _ in self.members)

    @property
    def kinds(self) -> frozenset[str]:
        """Kinds of the sensors."""
        return frozenset(settings.kind or name for name, settings in self.members)

    def get(self, name: str) -> SensorSettings | UnloadedSettings | None:
        """Return the settings of a sensor, or None where the robot does not have it."""
        return dict(self.members).get(name)

    @classmethod
    def __get_pydantic_core_schema__(cls, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Validate against the sensors that there are at that time: a user may have loaded one more."""
        del source, handler

        def validated(value: object, info: ValidationInfo) -> RobotSensors:
            if isinstance(value, RobotSensors):
                return value
            if isinstance(value, dict) and not value:
                return cls()
            return cls(tuple(sorted(_members(value, known_only=info.context == KNOWN_ONLY))))

        def as_mapping(sensors: RobotSensors) -> dict[str, BaseModel]:
            return dict(sensors.members)

        serialization = core_schema.plain_serializer_function_ser_schema(as_mapping)
        return core_schema.with_info_plain_validator_function(validated, ref=cls.__name__, serialization=serialization)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        del schema
        return handler.resolve_ref_schema(handler(sensors_section().__pydantic_core_schema__))


def _is_known(settings: dict[str, Any], name: str, known: Collection[str]) -> bool:
    kind = settings.get("kind", name)
    return isinstance(kind, str) and kind in known  # a file may hold anything


def _members(value: object, *, known_only: bool) -> Iterator[tuple[str, SensorSettings | UnloadedSettings]]:
    section = sensors_section()
    if isinstance(value, dict):
        for name in value:
            if not re.fullmatch(SENSOR_NAME, str(name)) or name in TAKEN_NAMES:
                taken = ", ".join(sorted(TAKEN_NAMES))
                allowed = f"names of small letters, digits and '_' that begin with a letter, other than {taken}"
                raise disagreement(str(name), str(name), allowed)
        if not known_only:
            known = {kind for kind, _, _ in _kinds()}
            unloaded = {
                name: settings
                for name, settings in value.items()
                if isinstance(settings, UnloadedSettings)
                or (isinstance(settings, dict) and (settings.get(IS_LOGGED) or not _is_known(settings, name, known)))
            }
            yield from ((name, UnloadedSettings.model_validate(settings)) for name, settings in unloaded.items())
            value = {name: settings for name, settings in value.items() if name not in unloaded}
    yield from ((name, settings) for name, settings in section.model_validate(value) if settings is not None)
