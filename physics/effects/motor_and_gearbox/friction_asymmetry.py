"""Friction that is not the same forward and in reverse."""

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Asymmetry
from physics.drivetrain.motion import ShaftMotion
from symolo.core.arrays import Array


class FrictionAsymmetry(Effect):
    """The Coulomb friction Tc is larger in one direction of rotation than in the other."""

    slot = Slot.FRICTION
    cause = "axial load on worm or helical gears, brushes set at an angle"
    excitation = "both directions of rotation"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    asymmetry: Asymmetry
    """Tc (1 - asymmetry) forward, Tc (1 + asymmetry) in reverse."""

    def apply(self, friction_N_m: Array, motion: ShaftMotion) -> Array:
        return friction_N_m * (1.0 - self.asymmetry * motion.direction)
