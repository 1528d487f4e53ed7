"""The robot as it is: its configuration with all of its terms, part by part of the signal chain.

The board on the robot knows nothing of the terms: wheel loop, odometry and controller go by the configuration.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from configs.schema.base import Section
from configs.schema.robot import RobotConfig
from physics.drivetrain.motor import MotorModel, Motors
from physics.effects import PHYSICS_TERMS
from physics.effects.base import Slot, effects
from physics.robot.wheel_geometry import WheelGeometry
from symolo.core.errors import InputError

Value = TypeVar("Value")


def through(functions: tuple[Callable[..., Any], ...], value: Value, *context: object) -> Value:
    """The value after one function after the other, each with the same context."""
    for function in functions:
        value = function(value, *context)
    return value


@dataclass(frozen=True)
class RobotModel:
    config: RobotConfig
    motors: Motors
    geometry: WheelGeometry
    counts_per_revolution: float
    """That the encoders truly give."""
    input_delay_s: float

    @classmethod
    def from_config(cls, config: RobotConfig) -> "RobotModel":
        def in_slot(slot: Slot) -> tuple[Callable[..., Any], ...]:
            return effects(PHYSICS_TERMS, config.terms, slot)

        motor = MotorModel.from_config(config.motor)
        return cls(
            config=config,
            motors=through(in_slot(Slot.MOTORS), Motors(motor, motor)),
            geometry=through(in_slot(Slot.GEOMETRY), WheelGeometry.from_config(config.drive)),
            counts_per_revolution=through(in_slot(Slot.ENCODER), config.encoder.counts_per_revolution),
            input_delay_s=through(in_slot(Slot.COMMAND_DELAY), 0.0),
        )

    def with_term(self, values: Section) -> "RobotModel":
        """This robot with one more effect, for example `SupplySag(source_resistance_ohm=0.4)`."""
        return RobotModel.from_config(self.config.with_term(values))

    def effects(self, slot: Slot) -> tuple[Callable[..., Any], ...]:
        """What the robot's terms do in a slot, in order."""
        return effects(PHYSICS_TERMS, self.config.terms, slot)

    @property
    def has_play(self) -> bool:
        """Whether motor side and load side of the gears can move against each other."""
        backlash = self.config.terms.gear_backlash
        return backlash is not None and bool(np.any(backlash.gap_rad > 0.0))

    def require_rigid_gears(self, place: str) -> None:
        """Refuse play in the gears where a wheel is one mass, so that it is never left out in silence.

        Raises:
            InputError: The robot has `gear_backlash` with a gap.
        """
        if self.has_play:
            raise InputError(
                f"robot.terms.gear_backlash.gap_rad: no play in {place}, whose wheel is one mass",
                allowed="0",
                cure="leave the term out; it acts on the motor bench alone",
            )
