"""Drag that grows with the square of the speed."""

from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from physics.drivetrain.motion import ShaftMotion
from symolo.core.arrays import Array


class QuadraticDrag(Effect):
    """A drag that grows with the square of the speed w acts in addition to the other friction."""

    slot = Slot.FRICTION
    cause = "churning grease, a fan on the shaft"
    excitation = "current against speed, up to the highest speed"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    coefficient_N_m_s2_rad2: Annotated[float, Parameter("N m s2/rad2", null=0.0, start=1e-4, low=0.0, high=10.0)]
    """Friction + coefficient * w |w|."""

    def apply(self, friction_N_m: Array, motion: ShaftMotion) -> Array:
        return friction_N_m + self.coefficient_N_m_s2_rad2 * motion.speed_rad_s**2
