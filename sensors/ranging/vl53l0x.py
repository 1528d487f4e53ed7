"""A further VL53L0X at any place, in any of its four ranging modes, with the physics that the nominal ones leave out.

The nominal sensors of data.csv follow the equations of the paper. This one shares their rays, surfaces, error and
noise, and adds what recordings of real devices show: near parts of the scene outweigh far ones, light is gathered over
the timing budget, emitter and receiver sit side by side, the error drifts at random, and outside of its working range
readings are disturbed and become rare before they are absent.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import erf, log, sqrt
from types import MappingProxyType
from typing import Any, Literal

import numpy as np
from pydantic import Field, model_validator

from configs.effects.base import Slot
from configs.effects.robot_effects import RobotEffects
from configs.robot_sensors import MountedSettings, SensorSettings
from configs.schema.robot import RangeBeam, TofMount
from configs.validation.faults import ConfigFault
from physics.arena.surfaces import SURFACES
from sensors.base import Reading, Sensor, World
from sensors.effects.range_sensor.near_field_error import NearFieldError
from sensors.effects.range_sensor.range_gathering_time import RangeGatheringTime
from sensors.effects.range_sensor.range_signal_weighting import RangeSignalWeighting
from sensors.effects.range_sensor.range_wander import RangeWander
from sensors.effects.range_sensor.tilt_asymmetry import TiltAsymmetry
from sensors.ranging.tof import NO_TARGET, VALID, Light, RangeDevices
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.dataset.tables.column import Column
from symolo.dataset.tables.side_tables import STATUSES

RangingMode = Literal["default", "high_speed", "high_accuracy", "long_range"]
RANGE_SLOTS = (
    Slot.RAY_WEIGHT,
    Slot.RANGE_GATHERING,
    Slot.RANGE,
    Slot.RANGE_WANDER,
    Slot.RANGE_NOISE,
    Slot.RANGE_LIMIT,
    Slot.RANGE_DELAY,
)
USUAL_PERIOD_S = 0.033
WHITE = 0.88
"""Reflectance of the white target of the data sheet."""
NEAR_M = 0.04
"""Shortest distance at which every measurement of a target gives a reading (paper, section 5.2)."""
FADING = 0.25
"""Spread of the natural logarithm of the returned light about its threshold."""


@dataclass(frozen=True)
class ModeSettings:
    """A preset of the device (VL53L0X data sheet DS11555, table of ranging profiles)."""

    budget_s: float
    """Time over which light is gathered."""
    reach_m: float
    """Distance at which a white target indoors returns half of its readings."""

    @property
    def noise(self) -> float:
        """Standard deviation over that of the default mode: a mean over more pulses has less noise."""
        return sqrt(MODES["default"].budget_s / self.budget_s)


MODES = MappingProxyType(
    {
        "default": ModeSettings(0.03, 1.5),
        "high_speed": ModeSettings(0.02, 1.5),
        "high_accuracy": ModeSettings(0.2, 1.5),
        "long_range": ModeSettings(0.033, 2.5),
    }
)


class Vl53l0xSettings(MountedSettings):
    """Place, mode, beam and errors of a VL53L0X."""

    mode: RangingMode = "default"
    """Ranging mode: presets of timing budget, noise and reach. Default has 30 ms, `high_speed` 20 ms, `high_accuracy`
    200 ms, `long_range` 33 ms and sees farther."""
    # Files are filled with defaults, but not with those that a factory makes.
    period_s: float = Field(default_factory=lambda: USUAL_PERIOD_S, gt=0, le=1)
    """Time between two readings; without it 33 ms, or the timing budget of the mode if that is longer."""
    rays: int = Field(default=90, ge=1, le=1000)
    """Number of rays in the cone."""
    field_of_view_deg: float = Field(default=25.0, gt=0, le=90)
    """Full angle of the cone."""
    beam_sigma_deg: float = Field(default=7.0, gt=0, le=90)
    """Standard deviation of the Gaussian beam profile."""
    signal_threshold: float = Field(default=0.15, ge=0, le=1)
    """Share of the beam that must meet something, whatever its distance and reflectance."""
    signal_exponent: float = Field(default=2.0, ge=0, le=6)
    """Weight of a ray over distance to this power: near parts outweigh far ones."""
    tilt_sd_m_rad: float = Field(default=0.01, ge=0, le=0.5)
    """Standard deviation, from unit to unit, of the change of a reading with the tilt of the axis upwards [m/rad]."""
    wander_sd_m: float = Field(default=0.001, ge=0, le=0.1)
    """Standard deviation of the slow error."""
    wander_s: float = Field(default=60.0, gt=0, le=10_000)
    """Time constant of the slow error."""
    near_error_m: float = Field(default=0.01, ge=-0.2, le=0.2)
    """Error at no distance, which falls off with a decay length of 20 mm."""
    error_scale: float = Field(default=0.3, ge=-2, le=2)
    """Factor on Eq. 24 of the paper; 0.3 is about 31 mm at 1 m."""
    noise_scale: float = Field(default=1.0, ge=0, le=10)
    """Factor on the standard deviation of the noise, beside that of the mode."""
    quantisation_m: float = Field(default=0.001, ge=0, le=0.1)
    """Step of the readings [m]; 0 for none."""
    temperature_C: float = Field(default=25.0, ge=-40, le=125)
    """Temperature of the device; used only with the effect `temperature_drift`."""
    reference_temperature_C: float = Field(default=25.0, ge=-40, le=125)
    """Temperature at which the device was calibrated."""
    ambient_lux: float = Field(default=500.0, ge=0, le=200_000)
    """Illuminance at the device; used only with the effect `ambient_noise`."""
    dropout_probability: float = Field(default=0.0, ge=0, le=1)
    """Probability that a reading fails, so that the previous one stands."""
    effects: RobotEffects = Field(default_factory=RobotEffects, json_schema_extra={"default": {}})
    """Effects of range sensors that act on this one alone."""

    @model_validator(mode="before")
    @classmethod
    def _period_of_mode(cls, value: Any) -> Any:  # noqa: ANN401 - whatever is to be validated
        if isinstance(value, dict) and value.get("period_s") is None:
            mode = MODES.get(str(value.get("mode", "default")), MODES["default"])
            return {**value, "period_s": max(USUAL_PERIOD_S, mode.budget_s)}
        return value

    def faults(self) -> Iterator[ConfigFault]:
        budget_s = MODES[self.mode].budget_s
        if self.period_s < budget_s:
            allowed = f"at least {budget_s}, the timing budget of the mode {self.mode}"
            yield ConfigFault(("period_s",), got=self.period_s, allowed=allowed, against=("mode",))
        for effect in self.effects:
            if effect.slot not in RANGE_SLOTS or effect.name == "tof_range_offset":
                allowed = "effects of a single range sensor, such as range_offset, material_bias and range_scale"
                yield ConfigFault(("effects", effect.name), "it does not act on this sensor", allowed=allowed)

    def beam(self) -> RangeBeam:
        """Return the settings in the form of the nominal sensors; limits are left to the returned light."""
        names = RangeBeam.model_fields.keys() & type(self).model_fields.keys()
        mode = MODES[self.mode]
        values = {name: getattr(self, name) for name in names}
        values |= {"noise_scale": self.noise_scale * mode.noise}
        values |= {"min_range_m": 0.0, "max_range_m": 1.5 * mode.reach_m, "no_target_m": 0.0}
        return RangeBeam.model_construct(**values)


class Vl53l0x(Sensor):
    """Range of a time-of-flight sensor, with the status of the reading."""

    name = "vl53l0x"
    Settings = Vl53l0xSettings
    columns = (
        Column("range", "m", 4, "range, 0 without a target"),
        Column("status", "-", 0, STATUSES),
    )
    settings: Vl53l0xSettings

    def __init__(self, settings: SensorSettings, arena: Arena, physics_hz: int, rng: np.random.Generator) -> None:
        super().__init__(settings, arena, physics_hz, rng)
        config = self.settings
        (unit_rng,) = rng.spawn(1)
        tilt_m_rad = config.tilt_sd_m_rad * float(unit_rng.standard_normal())
        physics = (
            RangeSignalWeighting(exponent=config.signal_exponent),
            RangeGatheringTime(duration_s=MODES[config.mode].budget_s),
            TiltAsymmetry(axis="forward", coefficient_m_per_rad=tilt_m_rad),
            NearFieldError(amplitude_m=config.near_error_m, decay_length_m=0.02),
            RangeWander(sd_m=config.wander_sd_m, time_constant_s=config.wander_s),
        )
        # An effect that the user names replaces the one of its class.
        named = {effect.name for effect in config.effects}
        effects = RobotEffects((*config.effects, *(effect for effect in physics if effect.name not in named)))
        self._device = _Device(config, arena, physics_hz, rng, effects)
        self.sampling = self._device.sampling

    def subsample(self, world: World) -> None:
        self._device.subsample(world)

    def sample(self, world: World) -> Reading:
        """Return range [m] and `TofStatus`, (2,)."""
        return self._device.sample(world)[0]


class _Device(RangeDevices):
    """One device, whose readings become rare where little light returns."""

    def __init__(
        self,
        settings: Vl53l0xSettings,
        arena: Arena,
        physics_hz: int,
        rng: np.random.Generator,
        effects: RobotEffects,
    ) -> None:
        mount = TofMount.model_construct(**{name: getattr(settings, name) for name in TofMount.model_fields})
        super().__init__(settings.beam(), [mount], arena, physics_hz, rng, effects, np.radians(settings.roll_deg))
        self._reach_m = MODES[settings.mode].reach_m
        self._threshold = settings.signal_threshold
        surfaces = [SURFACES[box.surface].reflectance for box in arena.boxes]
        self._bright = np.array([arena.floor_reflectance, *surfaces])

    def _all_judged(self, light: Light, true_m: Array, reading_m: Array) -> list[tuple[float, float]]:
        reflectance = (light.share * self._bright[light.surface]).sum(axis=1)
        chances = self._rng.random(len(reading_m))
        values = zip(light.signal, reflectance, true_m, reading_m, chances, strict=True)
        return [
            (max(float(read_m), 0.0), VALID) if chance < self._share(*returned) else (0.0, NO_TARGET)
            for *returned, read_m, chance in values
        ]

    def _share(self, signal: float, reflectance: float, distance_m: float) -> float:
        """Return the share of readings that come: the probability that the returned light exceeds its threshold."""
        if signal < self._threshold or distance_m <= 0.0:
            return 0.0
        light = reflectance / WHITE * (self._reach_m / distance_m) ** 2
        near = min(distance_m / NEAR_M, 1.0)
        return near * 0.5 * (1.0 + erf(log(max(light, 1e-12)) / FADING / sqrt(2.0)))
