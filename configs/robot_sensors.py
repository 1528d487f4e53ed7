"""The additional sensors of one robot: the section `robot.sensors`."""

import importlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from pydantic import BaseModel, ConfigDict, Field, GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from configs.families import optional_sections
from configs.schema.base import Section

KNOWN_ONLY: Mapping[str, bool] = MappingProxyType({"known_sensors_only": True})
"""Context of a validation that refuses a sensor whose class is not loaded, as for the file of a scenario. Without
it, as for a release, the settings of such a sensor are read as they are."""


class SensorSettings(Section):
    """Settings that all sensors of `robot.sensors` have."""

    period_s: float = Field(default=0.05, gt=0, le=1)
    """Time between two samples."""
    delay_s: float = Field(default=0.0, ge=0, le=1)
    """Time from a sample until it is delivered."""


class UnloadedSettings(BaseModel):
    """Settings of a sensor whose class is not loaded, with the names and values of its file."""

    model_config = ConfigDict(extra="allow", frozen=True)


def sensors_section() -> type[Section]:
    """Return the schema of `robot.sensors`: at most one sensor of each name, and no key means no sensor."""
    # Sensors are in a package above this one, so they are imported by name when they are first needed.
    return optional_sections("RobotSensors", importlib.import_module("sensors.registry").settings_by_name())


@dataclass(frozen=True)
class RobotSensors:
    """Immutable collection of the settings of sensors by name, in the order of the names."""

    members: tuple[tuple[str, SensorSettings | UnloadedSettings], ...] = ()

    def __iter__(self) -> Iterator[tuple[str, SensorSettings | UnloadedSettings]]:
        return iter(self.members)

    def __len__(self) -> int:
        return len(self.members)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the sensors."""
        return tuple(name for name, _ in self.members)

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
            section, unloaded = sensors_section(), {}
            if isinstance(value, dict) and info.context != KNOWN_ONLY:
                unloaded = {
                    key: UnloadedSettings.model_validate(settings)
                    for key, settings in value.items()
                    if key not in section.model_fields and isinstance(settings, dict)
                }
                value = {key: settings for key, settings in value.items() if key not in unloaded}
            loaded = {name: settings for name, settings in section.model_validate(value) if settings is not None}
            return cls(tuple(sorted((loaded | unloaded).items())))

        def as_mapping(sensors: RobotSensors) -> dict[str, BaseModel]:
            return dict(sensors.members)

        serialization = core_schema.plain_serializer_function_ser_schema(as_mapping)
        return core_schema.with_info_plain_validator_function(validated, ref=cls.__name__, serialization=serialization)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        del schema
        return handler(sensors_section().__pydantic_core_schema__)
