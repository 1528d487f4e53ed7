"""A further line sensor: any number of reflectance channels in a row, or at places of their own."""

from collections.abc import Iterator
from typing import Annotated

import numpy as np
from pydantic import Field

from configs.effects.base import Slot
from configs.effects.robot_effects import RobotEffects
from configs.robot_sensors import MountedSettings, SensorSettings
from configs.schema.base import Fixed, FromList
from configs.validation.faults import ConfigFault
from sensors.base import Reading, Sensor, World
from sensors.line.line_sensor import LineOptics, ReflectanceChannels, channel_weights
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.dataset.tables.column import Column

COLUMNS = Fixed("it decides the columns of the table")
LINE_SLOTS = (Slot.LINE_HEIGHT, Slot.LINE_READING, Slot.LINE_LIMIT)
Offset = Annotated[float, Field(ge=-1, le=1)]
Place = Annotated[tuple[Offset, Offset], FromList, Field(description="x [m], y [m] from the place of the sensor")]


class LineArraySettings(MountedSettings):
    """Place, channels and errors of a row of reflectance sensors that look down."""

    period_s: float = Field(default=0.005, gt=0, le=1)
    """Time between two readings."""
    z_m: float = Field(default=0.003, gt=0, le=0.1)
    """Height above the floor [m]."""
    channels: Annotated[int, COLUMNS] = Field(default=8, ge=1, le=64)
    """Number of channels of the row, from right to left across the x axis."""
    pitch_m: float = Field(default=0.009525, gt=0, le=0.2)
    """Distance between neighbouring channels of the row [m]."""
    places: Annotated[tuple[Place, ...], FromList, COLUMNS] = Field(default=(), max_length=64)
    """Places of the channels in place of a row."""
    spot_diameter_at_floor_m: float = Field(default=0.002, ge=0, le=0.05)
    """Diameter of one channel's spot at zero height."""
    spot_growth: float = Field(default=1.0, ge=0, le=5)
    """Growth of the spot's diameter per metre of height [m/m]."""
    gain_sd: float = Field(default=0.03, ge=0, le=0.5)
    """Standard deviation of the channels' gains, drawn once per run."""
    offset_sd: float = Field(default=0.01, ge=0, le=0.5)
    """Standard deviation of the channels' offsets, drawn once per run; 1 is full scale."""
    noise_sd: float = Field(default=0.004, ge=0, le=0.5)
    """Standard deviation of the noise of each reading; 1 is full scale."""
    adc_bits: int = Field(default=10, ge=1, le=16)
    """Resolution of the converter [bit]; 1 for a comparator."""
    dropout_probability: float = Field(default=0.0, ge=0, le=1)
    """Probability that a reading fails, so that the previous one stands."""
    effects: RobotEffects = Field(default_factory=RobotEffects, json_schema_extra={"default": {}})
    """Effects of line sensors that act on this one alone."""

    @property
    def count(self) -> int:
        return len(self.places) or self.channels

    def places_R(self) -> Array:
        """Return the places (N, 2) of the channels in R: ahead of the axle and to the left."""
        row = np.column_stack([np.zeros(self.channels), channel_weights(self.channels) * self.pitch_m])
        places_S = np.array(self.places) if self.places else row
        yaw = np.radians(self.yaw_deg)
        turn = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
        return places_S @ turn + (self.x_m, self.y_m)

    def faults(self) -> Iterator[ConfigFault]:
        for effect in self.effects:
            if effect.slot not in LINE_SLOTS or effect.name in _EIGHT_CHANNEL_EFFECTS:
                allowed = "effects of all channels, such as line_ambient and line_height"
                yield ConfigFault(("effects", effect.name), "it does not act on this sensor", allowed=allowed)


_EIGHT_CHANNEL_EFFECTS = frozenset({"line_gain", "line_offset"})
"""Effects that name one of the eight channels of data.csv."""


class LineArray(Sensor):
    """Normalised reflectance of each channel, 1 white and 0 black; a row counts from right to left."""

    Settings = LineArraySettings
    settings: LineArraySettings

    def __init__(self, settings: SensorSettings, arena: Arena, physics_hz: int, rng: np.random.Generator) -> None:
        super().__init__(settings, arena, physics_hz, rng)
        config = self.settings
        places_R = config.places_R()
        growth_m = config.spot_growth * config.z_m
        optics = LineOptics.at_places(places_R[:, 1], config.spot_diameter_at_floor_m, growth_m, config.effects)
        self._channels = ReflectanceChannels(places_R, optics, config, arena, rng, config.effects)

    @classmethod
    def columns_of(cls, settings: SensorSettings) -> tuple[Column, ...]:
        count = settings.count if isinstance(settings, LineArraySettings) else 1
        return (Column("reflectance", "-", 5, "1 white, 0 black", count),)

    def sample(self, world: World) -> Reading:
        """Return the readings of the channels, (channels,)."""
        return self._channels.read(world)
