"""Torque ripple against an integrator of its own, in small steps, and against what follows from its potential."""

import math

import numpy as np
import pytest

from physics.bullet.open_loop import open_loop
from physics.drivetrain.motor_bench import step_responses
from physics.drivetrain.wheel_turns import counted_turns
from physics.effects.motor_and_gearbox.gear_backlash import GearBacklash
from physics.effects.motor_and_gearbox.torque_ripple import TorqueRipple
from physics.robot.model import RobotModel
from physics.twin import KinematicTwin

R, K, B, TC, J = 3.0, 0.3, 0.002, 0.02, 2e-3
ROW_S = 0.005
LEVELS = ((4.0, 40), (0.7, 70), (-3.0, 50), (0.0, 20), (1.0, 40))
"""Voltages, and the numbers of rows for which they are held: fast and slow, with a reversal and a brake."""
VOLTAGE_V = np.concatenate([np.full(rows, volts) for volts, rows in LEVELS])
RIPPLES = [(0.01, 5.0, 1.0), (0.015, 12.3, -2.0), (0.005, 25.0, 0.3), (0.03, 1.0, 0.5)]
"""Amplitude, cycles per turn and phase; the last one is stronger than the dry friction."""


def with_ripple(motor, ripple):
    amplitude, cycles, phase = ripple
    return motor.with_effect(TorqueRipple(amplitude_N_m=amplitude, cycles_per_turn=cycles, phase_rad=phase))


def integrated(voltage_V, ripple, step_s=2e-5):
    """Speed and angle at the end of each row, by the midpoint rule."""
    amplitude, cycles, phase = ripple
    speed = angle = 0.0
    rows = []

    def acceleration(volts, w, at):
        driving = K * (volts - K * w) / R - amplitude * math.cos(cycles * at + phase)
        if w == 0.0:
            return 0.0 if abs(driving) <= TC else (driving - math.copysign(TC, driving)) / J
        return (driving - B * w - math.copysign(TC, w)) / J

    for volts in voltage_V.tolist():
        for _ in range(round(ROW_S / step_s)):
            first = acceleration(volts, speed, angle)
            half = speed + 0.5 * step_s * first
            half = 0.0 if speed * half < 0.0 else half
            there = acceleration(volts, half, angle + 0.5 * step_s * speed) if half else first
            after = speed + step_s * there
            after = 0.0 if speed * after < 0.0 else after
            angle += 0.5 * step_s * (speed + after)
            speed = after
        rows.append((speed, angle))
    return np.array(rows).T


@pytest.fixture(scope="module", params=RIPPLES, ids=lambda ripple: f"{ripple[1]:g} cycles")
def case(request, motor):
    """A motor with ripple, what it does, and what the same motor does without."""
    return with_ripple(motor, request.param), integrated(VOLTAGE_V, request.param), integrated(VOLTAGE_V, (0, 1, 0))


def test_the_bench_follows_the_definition(case):
    rippled, (speed, _), (bare, _) = case
    current, found = (x[:, 0] for x in step_responses(RobotModel.from_config(rippled), VOLTAGE_V[:, None], ROW_S))
    assert np.abs(speed - bare).max() > 0.05
    np.testing.assert_allclose(found, speed, atol=3e-3)
    np.testing.assert_allclose(current, (VOLTAGE_V - K * speed) / R, atol=3e-4)


def test_each_trial_begins_at_the_angle_0(motor):
    twice = np.stack([VOLTAGE_V, VOLTAGE_V], axis=1)
    _, speed = step_responses(
        RobotModel.from_config(with_ripple(motor, RIPPLES[0])), twice, ROW_S, np.array([0.0, 9.0])
    )
    np.testing.assert_array_equal(speed[:, 0], speed[:, 1])


def test_wheels_of_a_log_follow_the_definition(case):
    rippled, (_, angle), _ = case
    voltage = np.stack([VOLTAGE_V, 0.0 * VOLTAGE_V], axis=-1)[:, None]
    turned = counted_turns(RobotModel.from_config(rippled), voltage, ROW_S, np.zeros(1))
    np.testing.assert_allclose(np.cumsum(turned[:, 0, 0]), angle, atol=2e-3)


def test_a_lifted_robot_in_the_engine_follows_the_definition(case, robot):
    """The wheel is a part of the inertia there. The engine's own steps are of first order, with or without ripple."""
    rippled, (speed, _), (bare, _) = case
    drive = rippled.drive
    wheel = 0.5 * drive.wheel_mass_kg * (0.5 * drive.wheel_diameter_m) ** 2
    without_wheel = rippled.with_section("motor", {"rotor_inertia_kg_m2": J - wheel})
    both = np.stack([VOLTAGE_V, np.zeros(len(VOLTAGE_V))], axis=1)
    motion, found_bare = (
        open_loop(each, both, ROW_S, lifted=True).wheel_speed_rad_s[1:, 0]
        for each in (without_wheel, without_wheel.model_copy(update={"effects": robot.effects}))
    )
    by_ripple = speed - bare
    assert np.sqrt(np.mean((motion - found_bare - by_ripple) ** 2)) < 0.1 * np.sqrt(np.mean(by_ripple**2))


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("phase", [0.0, 2.0, math.pi])
def test_a_motor_breaks_away_where_its_torque_exceeds_friction_and_ripple(motor, direction, phase):
    """At the angle 0 the ripple is amplitude cos(phase) against forward motion, and with a motion in reverse."""
    model = RobotModel.from_config(with_ripple(motor, (0.012, 7.0, phase)))
    breakaway = R / K * (TC + direction * 0.012 * math.cos(phase))
    for share, moves in ((0.99, False), (1.01, True)):
        _, speed = step_responses(model, np.full((4, 1), share * direction * breakaway), ROW_S)
        assert bool(np.any(speed != 0.0)) == moves
        assert np.all(direction * speed >= 0.0)


def test_a_ripple_stronger_than_friction_turns_a_motor_that_has_no_voltage(motor):
    """From the angle 0 with phase 0, backwards, since the torque is that of a friction against forward motion; it
    creeps into the valley of the potential amplitude / cycles * sin(cycles * angle), as far as friction allows."""
    loose = motor.model_copy(update={"motor": motor.motor.model_copy(update={"coulomb_friction_N_m": 0.001})})
    model = RobotModel.from_config(with_ripple(loose, (0.02, 2.0, 0.0)))
    _, speed = step_responses(model, np.zeros((1200, 1)), ROW_S)
    angle = ROW_S * speed.sum()
    assert speed[0, 0] < 0.0
    assert speed[-1, 0] == pytest.approx(0.0, abs=1e-3)
    assert 0.02 * math.cos(2.0 * angle) == pytest.approx(0.001, abs=1e-4)
    assert -math.pi / 4.0 < angle < 0.0


def test_ripple_acts_beside_play_in_the_gear(motor):
    """A tiny gap is none."""
    rippled = with_ripple(motor, RIPPLES[0])
    rigid, loose = (
        step_responses(RobotModel.from_config(each), VOLTAGE_V[:, None], ROW_S)[1][:, 0]
        for each in (rippled, rippled.with_effect(GearBacklash(gap_rad=1e-9)))
    )
    bare = step_responses(RobotModel.from_config(motor), VOLTAGE_V[:, None], ROW_S)[1][:, 0]
    assert np.sqrt(np.mean((loose - rigid) ** 2)) < 0.15 * np.sqrt(np.mean((rigid - bare) ** 2))


def test_the_twin_drives_with_ripple_as_the_engine_does(robot):
    rippled = robot.with_effect(TorqueRipple(amplitude_N_m=0.02, cycles_per_turn=3.0, phase_rad=0.4))
    voltage = np.full((200, 2), 1.2)
    speeds = {}
    for name, each in (("bare", robot), ("ripple", rippled)):
        twin = KinematicTwin(RobotModel.from_config(each)).drive(voltage[:, None], np.zeros((1, 3)))
        engine = open_loop(each, voltage, ROW_S)
        speeds[name] = twin.wheel_speed_rad_s[:, 0, 0], engine.wheel_speed_rad_s[:, 0]
    by_twin, by_engine = (speeds["ripple"][k] - speeds["bare"][k] for k in (0, 1))
    assert np.abs(by_engine).max() > 0.3
    assert np.sqrt(np.mean((by_twin - by_engine) ** 2)) < 0.1 * np.sqrt(np.mean(by_engine**2))
