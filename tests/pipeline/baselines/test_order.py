"""On real drives: who is better than whom, who knows it, and that nobody has looked at the truth."""

from dataclasses import replace

import numpy as np
import pytest

from configs.effects.robot_effects import RobotEffects
from pipeline.baselines import ekf, odometry, particles
from symolo.core.random_streams import stream
from symolo.dataset.tables.rows import Rows
from symolo.dataset.tables.side_tables import WHEELS
from symolo.evaluation.errors import errors_of

EXACT = np.array([0.001, 0.001, 0.002])
HALF_LOST = np.array([0.05, 0.05, np.radians(5)])


def errors(run, method, start_sd):
    given = run.knowledge(start_sd, stream(1, run.name, "start"))
    estimate = method.METHOD.estimate(given, (), stream(1, run.name, method.METHOD.name))
    return errors_of(estimate, given.t_s, run.truth)


@pytest.mark.parametrize("start_sd", [EXACT, HALF_LOST], ids=["worn", "nominal, half lost"])
def test_filters_beat_odometry(driven, start_sd):
    run = driven("worn" if start_sd is EXACT else "nominal")
    alone = errors(run, odometry, start_sd)
    assert alone.ate_m > 0.03
    for method in (ekf, particles):
        run_errors = errors(run, method, start_sd)
        assert run_errors.ate_m < 0.8 * alone.ate_m
        assert run_errors.end_m < 0.5 * alone.end_m


@pytest.mark.parametrize(("robot", "at_most"), [("nominal", 2.0), ("worn", 5.0)])
def test_the_kalman_filter_knows_its_error(driven, robot, at_most):
    """The wheels of the worn robot alone are 2.5, 2 and 1.5 of the assumed standard deviations off; the mean of the
    squares is 4.2. A filter for which most errors of the ranges were new after each second had 23 in this drive.
    """
    assert errors(driven(robot), ekf, EXACT).nees < at_most


def test_the_wheels_of_a_perfect_robot_show_all_but_the_start(driven):
    run_errors = errors(driven("nominal"), odometry, EXACT)
    assert run_errors.ate_m < 0.006
    assert run_errors.rpe_per_m_m < 0.002
    assert run_errors.within == 1.0


def test_methods_know_neither_the_truth_nor_what_is_hidden_in_the_robot(driven):
    run = driven("worn")
    table = run.rows.table()
    table[1:, 1:4] += 3.0  # x, y, theta
    table[1:, 5:7] = -7.0  # v, w
    wheels = run.wheels.copy()
    shown = [WHEELS.header.index(name) for name in ("t", "counts_r", "counts_l")]
    wheels[:, [i for i in range(wheels.shape[1]) if i not in shown]] = 0.5
    robot = run.spec.robot
    sensors = {
        "tof": robot.tof.model_copy(update={"error_scale": -1.0, "noise_scale": 5.0, "signal_threshold": 0.9}),
        "line_sensor": robot.line_sensor.model_copy(update={"gain_sd": 0.5, "noise_sd": 0.5}),
    }
    robot = robot.model_copy(update={"effects": RobotEffects(), **sensors})
    floor = run.spec.arena.floor.model_copy(update={"reflectance": 0.5})
    walls = tuple(wall.model_copy(update={"surface": "metal"}) for wall in run.spec.arena.walls)
    arena = run.spec.arena.model_copy(update={"floor": floor, "walls": walls})
    spec = run.spec.model_copy(update={"robot": robot, "arena": arena, "seed": 99})
    other = replace(run, rows=Rows.from_table(table), wheels=wheels, spec=spec)
    for method in (odometry, ekf, particles):
        first, second = (
            method.METHOD.estimate(_short(one.knowledge(EXACT, stream(2))), (), stream(3)) for one in (run, other)
        )
        assert first.pose.tobytes() == second.pose.tobytes()
        assert first.covariance.tobytes() == second.covariance.tobytes()


def _short(given):
    rows = slice(0, 60)
    parts = {name: getattr(given, name)[rows] for name in ("t_s", "counts", "ranges_m", "fresh", "on_line")}
    return replace(given, **parts)
