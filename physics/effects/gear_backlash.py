"""Play between the motor side of a gearbox and its load side."""

import numpy as np

from configs.schema.effects.motor import GearBacklash
from physics.drivetrain.two_mass import Load, TwoMass
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array


def played(values: GearBacklash, state: TwoMass, motor: Load, load: Load, duration_s: float | Array) -> TwoMass:
    """One step in which the sides meet at most once: apart, then, with the momentum of both, as one.

    The moment at which they meet is that of relative motion at its mean speed over the step; contact is inelastic.
    """
    half = 0.5 * values.gap_rad
    motor_rad_s, motor_rad = motor.moved(state.motor_rad_s, duration_s)
    load_rad_s, load_rad = load.moved(state.load_rad_s, duration_s)
    gained_rad = motor_rad - load_rad
    slack_rad = state.slack_rad + gained_rad
    pushing = np.abs(slack_rad) >= half
    if not np.count_nonzero(pushing):
        return TwoMass(motor_rad_s, load_rad_s, slack_rad)
    nearer = np.where(gained_rad == 0.0, 1.0, gained_rad)
    apart = np.minimum(np.maximum((half * np.sign(slack_rad) - state.slack_rad) / nearer, 0.0), 1.0)
    at_contact = (
        motor.inertia_kg_m2 * (state.motor_rad_s + apart * (motor_rad_s - state.motor_rad_s))
        + load.inertia_kg_m2 * (state.load_rad_s + apart * (load_rad_s - state.load_rad_s))
    ) / (motor.inertia_kg_m2 + load.inertia_kg_m2)
    together, _ = (motor + load).moved(at_contact, (1.0 - apart) * duration_s)
    return TwoMass(
        np.where(pushing, together, motor_rad_s),
        np.where(pushing, together, load_rad_s),
        np.minimum(np.maximum(slack_rad, -half), half),
    )


TERM = Term(
    GearBacklash,
    Slot.GEARBOX,
    cause="worn gears, loose couplings",
    excitation="reversals and braking",
    apply=played,
)
