"""A robot whose motors have round numbers, for closed forms."""

import pytest


@pytest.fixture(scope="module")
def motor(robot):
    """R = 3 ohm, K = 0.3 N m/A, B = 0.002 N m s/rad, Tc = 0.02 N m and J = 0.002 kg m2."""
    numbers = {
        "winding_resistance_ohm": 3.0,
        "torque_constant_N_m_A": 0.3,
        "viscous_friction_N_m_s_rad": 0.002,
        "coulomb_friction_N_m": 0.02,
        "rotor_inertia_kg_m2": 2e-3,
    }
    return robot.with_section("motor", numbers)
