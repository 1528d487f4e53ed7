"""Play between the motor side of a gearbox and its load side."""

import numpy as np

from configs.schema.terms.motor import GearBacklash
from physics.terms.base import Slot, Term
from physics.two_mass import SideLoads, TwoMass, slowed


def played(values: GearBacklash, state: TwoMass, loads: SideLoads, duration_s: float) -> TwoMass:
    """One short step (0.1 ms is fine). Sides that touch move as one while they push each other; contact is inelastic."""
    half = 0.5 * values.gap_rad
    inertia = loads.motor_inertia_kg_m2 + loads.load_inertia_kg_m2
    motor = slowed(
        state.motor_rad_s,
        loads.drive_N_m,
        loads.motor_damping_N_m_s_rad,
        loads.motor_friction_N_m,
        loads.motor_inertia_kg_m2,
        duration_s,
    )
    load = slowed(
        state.load_rad_s,
        np.zeros_like(state.load_rad_s),
        loads.load_damping_N_m_s_rad,
        loads.load_friction_N_m,
        loads.load_inertia_kg_m2,
        duration_s,
    )
    slack = state.slack_rad + duration_s * (motor - load)
    end = np.clip(slack, -half, half)
    pushing = (np.abs(slack) >= half) & ((motor - load) * np.sign(slack) >= 0.0)
    before = state.motor_rad_s * loads.motor_inertia_kg_m2 + state.load_rad_s * loads.load_inertia_kg_m2
    together = slowed(
        before / inertia,
        loads.drive_N_m,
        loads.motor_damping_N_m_s_rad + loads.load_damping_N_m_s_rad,
        loads.motor_friction_N_m + loads.load_friction_N_m,
        inertia,
        duration_s,
    )
    return TwoMass(np.where(pushing, together, motor), np.where(pushing, together, load), end)


TERM = Term(
    GearBacklash,
    Slot.GEARBOX,
    cause="worn gears, loose couplings",
    excitation="reversals and braking",
    apply=played,
)
