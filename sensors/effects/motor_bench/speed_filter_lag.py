"""A measured speed that is low-pass filtered."""

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import LagTime
from physics.drivetrain.first_order import lag_of_linear_input
from symolo.core.arrays import Array


class SpeedFilterLag(Effect):
    """The measured speed is the true speed after a first-order low-pass filter."""

    slot = Slot.SPEED_FILTER
    cause = "smoothing of the encoder's quantised speed"
    excitation = "steps of voltage, after which the measured speed lags behind the one that follows from the current"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    time_constant_s: LagTime
    """Time constant of the first-order low-pass filter of the measured speed, which acts continuously. A program that
    filters every T seconds with y += (1 - exp(-T / tau)) (x - y) delays as much as a continuous filter whose time
    constant is T / (exp(T / tau) - 1)."""

    def apply(self, held_rad_s: Array, before_rad_s: Array, speed_rad_s: Array, duration_s: float) -> Array:
        return lag_of_linear_input(held_rad_s, before_rad_s, speed_rad_s, duration_s, self.time_constant_s)
