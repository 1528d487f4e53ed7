"""Ranges of runs whose poses are exact and whose arenas are known, against closed forms of a wall."""

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from configs.schema.arena import ArenaConfig
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.predictors import STAGES
from physics.arena.surfaces import SURFACES
from sensors.effects.range_sensor.tof_time_offset import TofTimeOffset
from symolo.core.tables.time_series import TimeSeries

ROW_S, ROWS = 0.05, 41
SPEED = 0.2
START_X = 0.2
T_S = ROW_S * np.arange(ROWS)
NAMES = ("x_m", "y_m", "theta_rad", "tof_front_m", "tof_left_m", "tof_right_m")


@pytest.fixture(scope="module")
def robot():
    """A robot whose front sensor is a single ray from the middle of the axle, without the error of Eq. 24."""
    nominal = draw_robot(load_section("robot", "nominal"), 1, "test")[0]
    mounts = nominal.tof.mounts
    front = mounts.front.model_copy(update={"x_m": 0.0, "y_m": 0.0, "yaw_deg": 0.0})
    ray = {"rays": 1, "field_of_view_deg": 1e-3, "error_scale": 0.0, "quantisation_m": 0.0}
    return nominal.with_section("tof", {**ray, "mounts": mounts.model_copy(update={"front": front})})


def arena(wall_x, surface="white_board", **motion):
    """A wall across the path, of a box with its face at this place."""
    box = {"name": "B", "center": (wall_x + 0.05, 0.0), "size": (0.1, 6.0, 0.3), "surface": surface, **motion}
    return ArenaConfig.model_validate({"name": "test", "line": {"pieces": []}, "walls": [], "obstacles": [box]})


def run(name, where, x_m=START_X + SPEED * T_S):
    """One run straight ahead along x."""
    values = dict(zip(NAMES, (x_m, 0 * x_m, 0 * x_m, *np.full((3, ROWS), 0.5)), strict=True))
    channels = [Channel.logged(TimeSeries(name, "", T_S, v), Role.READING) for name, v in values.items()]
    return Trial(name, T_S, np.zeros(ROWS, dtype=bool), tuple(channels), arena=where)


def front(robot, runs, *effects):
    """Mean (n,) and standard deviation (n,) of the readings of the front sensor."""
    measurement = Measurement("m", CaseKind.DRIVE_LOG, MeasurementSource("here", ()), tuple(runs))
    (stage,) = STAGES[CaseKind.DRIVE_LOG](measurement, robot)
    for effect in effects:
        robot = robot.with_effect(effect)
    predicted = stage.predict([robot])[0]
    return predicted.mean[0], np.broadcast_to(predicted.sd, predicted.mean.shape)[0]


def test_a_reading_is_that_of_the_last_sample_and_has_the_noise_of_the_surface(robot):
    """Samples are taken every 33 ms from the start on; wood reads 99.88 mm at 100 mm, with 1.42 mm (Table 3)."""
    mean, sd = front(robot, [run("1", arena(1.0, "wood"))])
    seen_s = robot.tof.period_s * np.floor(T_S / robot.tof.period_s + 1e-9)
    distance = 1.0 - START_X - SPEED * seen_s
    np.testing.assert_allclose(mean, distance - 0.12e-3, atol=1e-6)
    d = distance - 0.18
    growth_mm = np.maximum(((1.15 * d + 2.51) * d + 4.88) * d + 1.40, 1.41)  # Eq. 23
    np.testing.assert_allclose(sd, 1e-3 * np.sqrt(1.42**2 + growth_mm**2 - 1.41**2), rtol=1e-6)


def test_a_late_sensor_reports_an_earlier_sample(robot):
    delay_s = 0.08
    mean, _ = front(robot, [run("1", arena(1.0))], TofTimeOffset(delay_s=delay_s))
    seen_s = robot.tof.period_s * np.maximum(np.floor((T_S - delay_s) / robot.tof.period_s + 1e-9), 0.0)
    np.testing.assert_allclose(mean, 1.0 - START_X - SPEED * seen_s + 0.25e-3, atol=1e-6)


def test_each_run_is_seen_in_its_own_arena(robot):
    means, sds = front(robot, [run("1", arena(1.0)), run("2", arena(0.9, "metal"))])
    for part, where, surface in ((slice(0, ROWS), 1.0, "white_board"), (slice(ROWS, None), 0.9, "metal")):
        alone = front(robot, [run("1", arena(where, surface))])
        np.testing.assert_array_equal(means[part], alone[0])
        np.testing.assert_array_equal(sds[part], alone[1])
    # The wall is 0.1 m nearer, and metal reads another offset.
    change = -0.1 + SURFACES["metal"].offset_m - SURFACES["white_board"].offset_m
    np.testing.assert_allclose(means[ROWS:] - means[:ROWS], change, atol=1e-6)


def test_an_obstacle_that_moves_is_where_it_was_when_the_sensor_saw_it(robot):
    motion = {"motion": {"waypoints": [{"t_s": 2.0, "offset": (0.1, 0.0)}]}}
    mean, _ = front(robot, [run("1", arena(0.7, **motion), x_m=np.full(ROWS, START_X))])
    seen_s = robot.tof.period_s * np.floor(T_S / robot.tof.period_s + 1e-9)
    np.testing.assert_allclose(mean, 0.5 + 0.05 * seen_s + 0.25e-3, atol=1e-6)


def test_a_wheel_that_starts_between_two_rows_makes_the_place_of_the_sensor_uncertain(robot):
    """The true place is off the line between the rows by at most a quarter of the change of the step."""
    x_m = START_X + SPEED * np.maximum(T_S - T_S[20], 0.0)
    _, sd = front(robot, [run("1", arena(1.0), x_m=x_m)])
    _, still = front(robot, [run("1", arena(1.0), x_m=np.full(ROWS, START_X))])
    np.testing.assert_allclose(np.sqrt(sd[20:22] ** 2 - still[20:22] ** 2), 0.25 * SPEED * ROW_S, rtol=0.05)
    np.testing.assert_allclose(sd[2:19], still[2:19], rtol=1e-9)


def test_without_an_arena_no_range_is_predicted(robot):
    measurement = Measurement("m", CaseKind.DRIVE_LOG, MeasurementSource("here", ()), (run("1", None),))
    assert STAGES[CaseKind.DRIVE_LOG](measurement, robot) == ()
