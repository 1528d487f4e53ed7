"""Play between the motor side of a gearbox and its load side."""

import numpy as np

from configs.schema.terms.motor import GearBacklash
from physics.terms.base import Slot, Term
from physics.two_mass import Load, TwoMass


def played(values: GearBacklash, state: TwoMass, motor: Load, load: Load, duration_s: float) -> TwoMass:
    """One short step (0.1 ms is fine). Sides move as one while they push each other; contact is inelastic."""
    half = 0.5 * values.gap_rad
    motor_rad_s, load_rad_s = motor.moved(state.motor_rad_s, duration_s), load.moved(state.load_rad_s, duration_s)
    slack_rad = state.slack_rad + duration_s * (motor_rad_s - load_rad_s)
    pushing = (np.abs(slack_rad) >= half) & ((motor_rad_s - load_rad_s) * np.sign(slack_rad) >= 0.0)
    both = motor + load
    momentum = motor.inertia_kg_m2 * state.motor_rad_s + load.inertia_kg_m2 * state.load_rad_s
    together = both.moved(momentum / both.inertia_kg_m2, duration_s)
    return TwoMass(
        np.where(pushing, together, motor_rad_s),
        np.where(pushing, together, load_rad_s),
        np.clip(slack_rad, -half, half),
    )


TERM = Term(
    GearBacklash,
    Slot.GEARBOX,
    cause="worn gears, loose couplings",
    excitation="reversals and braking",
    apply=played,
)
