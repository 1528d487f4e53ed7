"""The real robot: its configuration with all of its effects, for each part of the signal chain.

The board on the robot does not know the effects: wheel loop, odometry and controller use the configuration alone.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from configs.effects.base import Effect, Slot
from configs.schema.robot import RobotConfig
from physics.drivetrain.motor import MotorModel, Motors
from physics.effects.motor_and_gearbox.gear_backlash import GearBacklash
from physics.robot.wheel_geometry import WheelGeometry
from symolo.core.errors import InputError

Value = TypeVar("Value")


def applied(functions: tuple[Callable[..., Any], ...], value: Value, *context: object) -> Value:
    """Return the value after applying the functions in turn, each with the same context."""
    for function in functions:
        value = function(value, *context)
    return value


@dataclass(frozen=True)
class RobotModel:
    """The parameters of a robot with its effects, as the simulation uses them."""

    config: RobotConfig
    motors: Motors
    geometry: WheelGeometry
    counts_per_revolution: float
    """True counts of the encoders per revolution of a wheel."""
    input_delay_s: float

    @classmethod
    def from_config(cls, config: RobotConfig) -> "RobotModel":
        in_slot = config.effects.functions
        motor = MotorModel.from_config(config.motor)
        return cls(
            config=config,
            motors=applied(in_slot(Slot.MOTORS), Motors(motor, motor)),
            geometry=applied(in_slot(Slot.GEOMETRY), WheelGeometry.from_config(config.drive)),
            counts_per_revolution=applied(in_slot(Slot.ENCODER), config.encoder.counts_per_revolution),
            input_delay_s=applied(in_slot(Slot.COMMAND_DELAY), 0.0),
        )

    def with_effect(self, effect: Effect) -> "RobotModel":
        """Return this robot with one more effect, for example `SupplySag(source_resistance_ohm=0.4)`."""
        return RobotModel.from_config(self.config.with_effect(effect))

    def functions(self, slot: Slot) -> tuple[Callable[..., Any], ...]:
        """Return the functions that the robot's effects apply in a slot, in their order."""
        return self.config.effects.functions(slot)

    @property
    def has_play(self) -> bool:
        """Whether motor side and load side of the gears can move against each other."""
        backlash = self.config.effects.get(GearBacklash)
        return backlash is not None and bool(np.any(backlash.gap_rad > 0.0))

    def require_rigid_gears(self, place: str) -> None:
        """Refuse play in the gears where a wheel is one mass, so that it is never ignored silently.

        Raises:
            InputError: The robot has `gear_backlash` with a gap.
        """
        if self.has_play:
            raise InputError(
                f"robot.effects.gear_backlash.gap_rad: no play in {place}, whose wheel is one mass",
                allowed="0",
                cure="remove the effect; it acts on the motor bench alone",
            )
