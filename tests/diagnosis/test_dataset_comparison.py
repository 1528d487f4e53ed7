"""A dataset held against a measured drive: robots within and without the dataset's, and drives that leave it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from diagnosis.dataset_comparison import compare_with_dataset
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.report.dataset_comparison import in_json, verdict
from physics.effects.wheels_and_floor.wheel_radius_scale import WheelRadiusScale
from symolo.core.errors import InputError


@pytest.fixture(scope="module")
def robot():
    return draw_robot(load_section("robot", "nominal"), 0, "test")[0]


@pytest.fixture(scope="module")
def of_radius(robot):
    return lambda scale: robot.with_effect(WheelRadiusScale(scale=scale))


def residual(comparison, name):
    (of,) = (each for each in comparison.residuals if each.name == name)
    return of


def test_a_robot_among_those_of_the_dataset_is_covered(robot, of_radius, driven_log):
    dataset = driven_log(of_radius(0.93), of_radius(0.97), of_radius(1.02))
    comparison = compare_with_dataset(driven_log(of_radius(0.95)), dataset, robot)
    assert residual(comparison, "pose_dx_m").is_covered
    assert verdict(comparison) == ["The dataset made covers the measured drive: nothing of it lies outside its 3 runs."]


def test_a_robot_beyond_those_of_the_dataset_is_not_and_the_way_ahead_says_by_how_much(robot, of_radius, driven_log):
    """The median window lies in the steady drive: 0.5 s of w r (0.95 - 1), with w by Eq. 21 and 22 at 3 V."""
    dataset = driven_log(of_radius(0.99), of_radius(1.01), straight=True)
    comparison = compare_with_dataset(driven_log(of_radius(0.95), straight=True), dataset, robot)
    ahead = residual(comparison, "pose_dx_m")
    assert not ahead.is_covered
    motor = robot.motor
    R, K = motor.winding_resistance_ohm, motor.torque_constant_N_m_A
    speed = (K * 3.0 / R - motor.coulomb_friction_N_m) / (K**2 / R + motor.viscous_friction_N_m_s_rad)
    assert ahead.middle == pytest.approx(-0.05 * 0.5 * speed * 0.0325, rel=0.1)
    assert ahead.middles[0] < 0.0 < ahead.middles[1]
    assert any(
        line.startswith("The measured pose_dx_m differs from the nominal robot by -0.0") for line in verdict(comparison)
    )
    assert in_json(comparison)["left"]["pose_dx_m"]["covered"] is False


def test_voltages_that_no_run_had_are_outside_by_their_share(robot, driven_log):
    measured = driven_log(robot)
    (trial,) = measured.trials
    (name, at) = next((c.name, k) for k, c in enumerate(trial.channels) if c.name == "u_left_V")
    values = trial[name].values.copy()
    values[:15] = 9.0
    series = replace(trial[name].series, values=values)
    channels = (*trial.channels[:at], replace(trial[name], series=series), *trial.channels[at + 1 :])
    comparison = compare_with_dataset(
        replace(measured, trials=(replace(trial, channels=channels),)), driven_log(robot), robot
    )
    (of,) = (each for each in comparison.signals if each.name == name)
    assert of.outside == pytest.approx(15 / 60)
    assert of.apart == pytest.approx(15 / 60, abs=0.02)


def test_a_curve_against_itself_is_nothing_apart_and_one_beyond_is_all(robot, driven_log):
    comparison = compare_with_dataset(driven_log(robot), driven_log(robot), robot)
    assert {of.apart for of in comparison.signals} == {0.0}
    assert all(of.is_covered for of in (*comparison.signals, *comparison.residuals))


def test_a_bench_is_not_held_against_a_dataset(robot, driven_log):
    bench = read_measurement(Path("table-1"), IMPORTERS)
    with pytest.raises(InputError, match="CASE is data of kind motor_steady"):
        compare_with_dataset(bench, driven_log(robot), robot)
    with pytest.raises(InputError, match="--against is data of kind motor_steady"):
        compare_with_dataset(driven_log(robot), bench, robot)


def test_scatter_is_a_standard_deviation_that_wild_samples_do_not_move(robot, driven_log):
    values = np.random.default_rng(2).standard_normal(4000)
    values[:40] = 100.0
    of = replace(compare_with_dataset(driven_log(robot), driven_log(robot), robot).residuals[0], measured=values)
    assert of.scatter == pytest.approx(1.0, abs=0.06)
