"""A torque that changes as the shaft turns."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Angle, Parameter
from symolo.core.arrays import Array


class TorqueRipple(Effect):
    """A torque that depends on the angle of the wheel is added, such as the cogging torque of a motor."""

    slot = Slot.SHAFT_TORQUE
    cause = "magnets that hold the rotor at some angles, an eccentric gear, a bent shaft"
    excitation = "steps over several turns from the same wheel angle, with slow speeds"
    setups = (Setup.MOTOR_BENCH,)

    amplitude_N_m: Annotated[float, Parameter("N m", null=0.0, start=0.005, low=0.0, high=1.0)]
    """Friction + amplitude cos(cycles_per_turn * wheel angle + phase). The sign is that of a friction against forward
    motion, in both directions of motion."""
    cycles_per_turn: Annotated[float, Parameter("1", null=None, start=5.0, low=0.2, high=200.0, is_frequency=True)]
    """Cycles per turn of the wheel; behind a gear they need not be a whole number."""
    phase_rad: Angle
    """Phase at the wheel angle 0, at which every trial starts."""

    def apply(self, torque_N_m: Array, angle_rad: Array, turned_rad: Array) -> Array:
        """Return the torque on the shaft, with the mean of the ripple over the turn."""
        half = 0.5 * self.cycles_per_turn * turned_rad
        middle = self.cycles_per_turn * angle_rad + half + self.phase_rad
        return torque_N_m - self.amplitude_N_m * np.cos(middle) * np.sinc(half / np.pi)
