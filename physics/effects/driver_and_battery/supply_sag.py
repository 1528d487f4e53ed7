"""A supply whose voltage falls under load."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter, Plausible
from physics.drivetrain.bridge import Bridge
from symolo.core.arrays import Array

NEWTON_STEPS = 5
"""Number of steps that is enough for two motors. The loss is convex and piecewise linear, with two kinks per motor,
where its current starts, stops or reverses. Newton's method from zero loss passes each kink at most once and is exact
between them."""
MIN_SLOPE = 1e-9


class SupplySag(Effect):
    """The supply has an internal resistance, so that its voltage falls with the current of all motors together."""

    slot = Slot.SUPPLY
    cause = "internal resistance of the cells, thin leads"
    excitation = "full duty compared with partial duty, one wheel stalled while the other runs"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    source_resistance_ohm: Annotated[
        float,
        Parameter("ohm", null=0.0, start=0.5, low=0.0, high=20.0),
        Plausible(
            0.0, 1.0, "two lithium cells with protection and leads have 0.1 to 0.5 ohm, four worn alkaline cells 1 ohm"
        ),
    ]
    """Resistance in series with the supply, which delivers |duty| |I| to each motor; u falls in proportion to the
    supply's voltage. With one motor alone, I = e / (R + source_resistance duty^2)."""

    def apply(self, emf_V: Array, bridge: Bridge) -> Array:
        """Return the current of each motor [A], the motors of one supply along the last axis.

        The voltage of the supply falls by r (sum of |duty| |I|), at most to zero, and that of each motor by its duty
        times this. With one motor alone, the current is I = e / (R + r duty^2), also while the motor feeds back.
        """
        source, duty, resistance_ohm = self.source_resistance_ohm, bridge.duty, bridge.resistance_ohm
        if emf_V.shape[-1] == 1:
            return bridge.driving_V(emf_V) / (resistance_ohm + source * duty**2)
        draws_V = source * np.abs(duty)
        eases = draws_V * duty / resistance_ohm
        lost_V = np.zeros((*emf_V.shape[:-1], 1))
        sign = np.full(emf_V.shape, np.nan)
        for _ in range(NEWTON_STEPS):
            current = bridge.current_A(emf_V - duty * lost_V)
            before, sign = sign, np.sign(current)
            if np.array_equal(sign, before):
                return current
            off_V = (draws_V * np.abs(current)).sum(axis=-1, keepdims=True) - lost_V
            slope = 1.0 + (eases * sign).sum(axis=-1, keepdims=True)
            lost_V = np.minimum(lost_V + off_V / np.maximum(slope, MIN_SLOPE), bridge.supply_V)
        return bridge.current_A(emf_V - duty * lost_V)
