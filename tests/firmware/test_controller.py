"""The controller in C beside the one in Python, which is the reference, on the same readings tick by tick."""

import math

import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from physics.control.base import State
from physics.control.paths import straight_path
from pipeline.stages.simulate import simulate

FLOAT = 2e-5
"""What single precision makes of a few operations on numbers up to 10."""
SPACING_M = 0.4e-3
"""No shipped path has its points further apart."""
MOST_OFF = 2
"""Points by which the nearest one may differ."""


def assert_alike(robot, reference, tried):
    """Same states and counters at every tick, and commands that differ by no more than the numbers' rounding.

    Off the paths a command is a few operations on floats of 24 bits. On a path the goal may be one of the points beside
    the reference's, and its coordinates are rounded to half of 2^-15 m each. The curvature 2 y / (x^2 + y^2) towards a
    goal (x, y) changes by 2 / (x^2 + y^2) per metre that the goal moves, in whatever direction.
    """
    expected, got = ({name: np.array(value) for name, value in vars(drive).items()} for drive in (reference, tried))
    same = got["state"] == expected["state"]
    assert_early_or_late_by_rounding(same, expected["nearest"], robot.controller.avoidance)
    assert np.abs(got["line_lost"] - expected["line_lost"]).max() <= np.sum(~same)
    np.testing.assert_allclose(got["odometry"], expected["odometry"], rtol=0, atol=5e-6)
    off = np.where(same, np.abs(got["nearest"] - expected["nearest"]), 0)
    assert off.max() <= MOST_OFF
    distance_m, bearing = expected["goal"].T
    moved_m = SPACING_M * off + math.sqrt(0.5) * 2.0**-15
    curvature = np.where(expected["nearest"] >= 0, 2.0 * moved_m / (distance_m - moved_m) ** 2, 0.0)
    clear = same & ~at_a_turn(robot, bearing)
    assert clear.mean() > 0.9
    v_m_s, w_rad_s = np.abs(expected["motion"]).T
    # On a curve path the speed is at most the highest yaw rate over the curvature.
    share = np.minimum(curvature * v_m_s / np.maximum(w_rad_s, 1e-9), 1.0 - 1e-9)
    slower = np.minimum(v_m_s * share / (1.0 - share), robot.controller.avoidance.speed_m_s)
    apart = np.abs(got["motion"] - expected["motion"])
    assert np.all(apart[clear, 0] <= 1.1 * slower[clear] + FLOAT)
    assert np.all(apart[clear, 1] <= 1.1 * (v_m_s * curvature)[clear] + FLOAT)


def assert_early_or_late_by_rounding(same, nearest, avoidance):
    """A state may change one tick apart only where the path's nearest point is at the limit of that change."""
    limits = (straight_path(avoidance, "left").back_begins, avoidance.points - 2)
    for tick in np.flatnonzero(~same):
        assert same[tick - 1]
        assert same[tick + 1]
        at_limit = [abs(nearest[tick - 1] - limit) <= MOST_OFF for limit in limits]
        assert any(at_limit), f"tick {tick}"


def at_a_turn(robot, bearing):
    """Where a curve path's goal lies on the limit between driving and turning, or straight behind the robot."""
    curves = robot.controller.avoidance.curves
    limits = (math.pi,) if curves is None else (math.pi, curves.turn_above_rad)
    return np.any([np.abs(np.abs(bearing) - limit) < 0.02 for limit in limits], axis=0)


def test_both_do_the_same_on_random_readings(robot, library, random_drive):
    rng = np.random.Generator(np.random.PCG64(7))
    seen = set()
    for _ in range(12):
        drive = random_drive(robot, 200, rng)
        assert_alike(robot, drive, library(robot).drive(drive))
        seen |= set(drive.state)
    assert seen == set(State)


def on_the_wire(readings, counts_before):
    counts = np.array(readings["encoders"])
    line, ranges_mm = np.rint(255 * readings["line"]), np.rint(1000 * readings["tof"][:, 0])
    return counts, ((counts - counts_before).tolist(), line.astype(int).tolist(), ranges_mm.astype(int).tolist())


@pytest.mark.firmware
@pytest.mark.parametrize(
    ("scenario", "route"),
    [("symolo", "CW"), ("symolo", "CCW"), ("classroom", "CW"), ("classroom", "CCW"), ("wall_gaps", "East")],
)
def test_both_do_the_same_on_the_readings_of_a_simulated_lap(library, reference, scenario, route):
    spec = draw_run(load_scenario(scenario), route, 1)
    recording = simulate(spec).recording
    controller, counts = reference(spec.robot), np.zeros(2, dtype=int)
    for tick in range(len(recording.trajectory.t_s)):
        names = {"line": "line", "encoders": "encoder_counts"}
        readings = {name: recording[series].values[tick] for name, series in names.items()}
        readings["tof"] = recording["tof_m"].values[tick][:, None]
        counts, told = on_the_wire(readings, counts)
        controller.step(*told)
    assert controller.drive.state == recording.trajectory.state.tolist()
    assert_alike(spec.robot, controller.drive, library(spec.robot).drive(controller.drive))
