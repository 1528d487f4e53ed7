"""Friction and winding never create energy, whatever the voltages: from speed and angle of the exact steps alone.

Over a step at constant voltage u that turns the motor by a and takes T, the charge is q = (u T - K a) / R, so the
electrical work is u q. By Cauchy and Schwarz the winding takes at least R q^2 / T, and friction at least
Tq |a| + B a^2 / T.
"""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from physics.drivetrain.motor import MotorModel
from physics.drivetrain.motor_arrays import HeldDrive

ROUNDING_J = 1e-15
"""The angle of a short run to rest is a small difference of numbers the size of speed times time constant."""


def zero_or_real(limit):
    """Of a speed or a voltage far below any of a machine, products and quotients are no doubles any more."""
    return st.floats(-limit, -1e-9) | st.just(0.0) | st.floats(1e-9, limit)


SPEEDS = zero_or_real(40)
MOTORS = st.builds(
    MotorModel,
    resistance_ohm=st.floats(0.5, 20),
    torque_constant_N_m_A=st.floats(0.02, 2),
    viscous_N_m_s_rad=st.floats(0, 0.05),
    coulomb_N_m=st.just(0.0) | st.floats(1e-9, 0.1),
    inertia_kg_m2=st.floats(1e-5, 1e-1),
)
PROGRAMMES = st.lists(st.tuples(zero_or_real(12), st.floats(1e-4, 0.5)), min_size=1, max_size=12)
NOMINAL = MotorModel(2.85, 0.31, 0.0027, 0.0174, 1e-3)


def scalar_step(motor, voltage, speed, duration):
    return motor.step(voltage, speed, duration)


def array_step(motor, voltage, speed, duration):
    drive = HeldDrive(
        *(
            np.array([value])
            for value in (
                motor.stall_torque_N_m(voltage),
                motor.damping_N_m_s_rad,
                motor.coulomb_N_m,
                motor.inertia_kg_m2,
            )
        )
    )
    after, angle = drive.step(np.array([speed]), duration)
    return float(after[0]), float(angle[0])


@pytest.mark.parametrize("step", [scalar_step, array_step])
@given(motor=MOTORS, start=SPEEDS, programme=PROGRAMMES)
@example(motor=MotorModel(4.0, 1.0, 0.0, 0.0625, 0.0625), start=1.0000000000000003e-09, programme=[(0.0, 0.5)])
@example(motor=NOMINAL, start=0.0, programme=[(6.0, 0.2), (-6.0, 0.2), (0.1, 0.5), (-0.1, 0.5)])
def test_friction_and_winding_never_create_energy(step, motor, start, programme):
    speed, kinetic_J = start, 0.5 * motor.inertia_kg_m2 * start**2
    for voltage, duration in programme:
        speed, angle = step(motor, voltage, speed, duration)
        charge_C = (voltage * duration - motor.torque_constant_N_m_A * angle) / motor.resistance_ohm
        min_heat_J = (
            motor.resistance_ohm * charge_C**2 / duration
            + motor.coulomb_N_m * abs(angle)
            + motor.viscous_N_m_s_rad * angle**2 / duration
        )
        before_J, kinetic_J = kinetic_J, 0.5 * motor.inertia_kg_m2 * speed**2
        scale_J = before_J + kinetic_J + min_heat_J + abs(voltage * charge_C)
        assert kinetic_J - before_J + min_heat_J <= voltage * charge_C + 1e-9 * scale_J + ROUNDING_J


@pytest.mark.parametrize("step", [scalar_step, array_step])
@given(motor=MOTORS, start=SPEEDS, durations=st.lists(st.floats(1e-4, 0.5), min_size=1, max_size=8))
def test_a_motor_without_voltage_only_slows_down_and_never_turns_round(step, motor, start, durations):
    speed = start
    for duration in durations:
        after, _ = step(motor, 0.0, speed, duration)
        assert abs(after) <= abs(speed)
        assert after * speed >= 0.0
        speed = after
