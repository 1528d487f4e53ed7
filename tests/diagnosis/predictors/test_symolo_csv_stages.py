"""Ranges and pose increments of a bare data.csv against closed forms of a wall and of arcs."""

import math

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from configs.schema.arena import ArenaConfig
from diagnosis.measured.case_files.nominal import LogNoise, NominalLog
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.predictors import STAGES
from physics.effects.wheels_and_floor.floor_slope import FloorSlope
from physics.effects.wheels_and_floor.turn_slip import TurnSlip
from physics.effects.wheels_and_floor.wheel_radius_asymmetry import WheelRadiusAsymmetry
from physics.effects.wheels_and_floor.wheel_radius_scale import WheelRadiusScale
from physics.effects.wheels_and_floor.wheelbase_scale import WheelbaseScale
from sensors.effects.pose_log.marker_offset import MarkerOffset
from sensors.effects.pose_log.pose_time_offset import PoseTimeOffset
from sensors.effects.range_sensor.incidence_bias import IncidenceBias
from sensors.effects.range_sensor.range_gathering_time import RangeGatheringTime
from sensors.effects.range_sensor.range_signal_weighting import RangeSignalWeighting
from sensors.effects.range_sensor.tilt_asymmetry import TiltAsymmetry
from sensors.effects.range_sensor.tof_mount_yaw import TofMountYaw
from sensors.effects.range_sensor.tof_range_offset import TofRangeOffset
from sensors.effects.range_sensor.tof_time_offset import TofTimeOffset
from symolo.core.tables.time_series import TimeSeries

ROW_S, ROWS = 0.05, 41
WALL_X = 1.0
"""Place of the wall's face, which reaches from y = -5 m to y = 5 m."""
BOARD_M = 0.25e-3
"""White board reads 100.25 mm at 100 mm (Table 3 of the paper)."""
NOISE = LogNoise(d_m=0.002, line=0.01, pose_xy_m=0.001, pose_theta_rad=0.003, v_m_s=0.001, w_rad_s=0.01)
SPEED = 0.1


@pytest.fixture(scope="module")
def robot():
    """A robot whose front sensor is a single ray from the middle of the axle, without the error of Eq. 24."""
    nominal = draw_robot(load_section("robot", "nominal"), 1, "test")[0]
    mounts = nominal.tof.mounts
    front = mounts.front.model_copy(update={"x_m": 0.0, "y_m": 0.0, "yaw_deg": 0.0})
    ray = {"rays": 1, "field_of_view_deg": 1e-3, "error_scale": 0.0, "noise_scale": 0.0, "quantisation_m": 0.0}
    ray |= {"mounts": mounts.model_copy(update={"front": front}), "period_s": 1e-6}
    return nominal.with_section("tof", ray)


def arena(*obstacles):
    wall = {"name": "W", "start": (WALL_X, -5.0), "end": (WALL_X, 5.0), "thickness_m": 0.02}
    line = {"pieces": []}
    return ArenaConfig.model_validate({"name": "test", "line": line, "walls": [wall], "obstacles": obstacles})


def drive(speed=SPEED, turn_rate=0.0, **start):
    """Poses of a drive at constant speed, on a straight or an arc."""
    t_s = ROW_S * np.arange(ROWS)
    theta = start.get("theta", 0.0) + turn_rate * t_s
    if turn_rate:
        x, y = (speed / turn_rate * (f(theta) - f(theta[:1])) for f in (np.sin, lambda a: -np.cos(a)))
    else:
        x, y = (speed * t_s * f(theta) for f in (np.cos, np.sin))
    return np.column_stack([start.get("x", 0.0) + x, start.get("y", 0.0) + y, theta])


def run(name, pose, v, w, begins_s=0.0):
    """One run with the speeds (n,) of its rows."""
    t_s = ROW_S * np.arange(len(pose))
    columns = dict(zip(("x_m", "y_m", "theta_rad"), pose.T, strict=True)) | {"v_m_s": v, "w_rad_s": w}
    columns |= dict.fromkeys(("tof_front_m", "tof_left_m", "tof_right_m"), np.full(len(pose), 0.5))
    channels = [Channel.logged(TimeSeries(k, "", t_s, np.array(v)), Role.READING) for k, v in columns.items()]
    return Trial(name, t_s, np.zeros(len(t_s), dtype=bool), tuple(channels), begins_s=begins_s)


def stages_of(robot, runs, *, twist="odometry", where=None):
    case = NominalLog(kind="symolo_csv", arena=where or arena(), robot=robot, noise=NOISE, twist=twist)
    measurement = Measurement("m", CaseKind.SYMOLO_CSV, MeasurementSource("here", ()), tuple(runs), case)
    return {stage.name: stage for stage in STAGES[CaseKind.SYMOLO_CSV](measurement, robot)}


def stages(robot, pose, *, speeds=(SPEED, 0.0), twist="odometry", where=None, begins_s=0.0):
    v, w = (np.full(len(pose), speed) for speed in speeds)
    return stages_of(robot, [run("1", pose, v, w, begins_s)], twist=twist, where=where)


def front(stage, robot, *effects):
    for effect in effects:
        robot = robot.with_effect(effect)
    observed, predicted = stage.observed[0], stage.predict([robot])[0]
    return predicted.mean[0][observed.usable], np.broadcast_to(predicted.sd, predicted.mean.shape)[0][observed.usable]


class TestRanges:
    def test_a_ray_ends_at_the_wall_and_its_noise_is_that_of_sensor_and_pose(self, robot):
        pose = drive(x=0.2)
        mean, sd = front(stages(robot, pose)["tof"], robot)
        np.testing.assert_allclose(mean, WALL_X - pose[:, 0] + BOARD_M, atol=1e-6)
        np.testing.assert_allclose(sd, math.hypot(NOISE.d_m, NOISE.pose_xy_m), rtol=0.01)

    def test_an_oblique_ray_is_as_long_as_trigonometry_says_and_turns_with_the_noise_of_the_heading(self, robot):
        tilt = 0.4
        pose = drive(x=0.3, theta=tilt)
        mean, sd = front(stages(robot, pose)["tof"], robot)
        length = (WALL_X - pose[:, 0]) / math.cos(tilt)
        np.testing.assert_allclose(mean, length + BOARD_M, atol=1e-6)
        by_place, by_turn = NOISE.pose_xy_m / math.cos(tilt), NOISE.pose_theta_rad * length * math.tan(tilt)
        np.testing.assert_allclose(sd, np.sqrt(NOISE.d_m**2 + by_place**2 + by_turn**2), rtol=0.01)

    def test_an_obstacle_hides_the_wall(self, robot):
        box = {"name": "O", "center": (0.8, 0.0), "size": (0.1, 0.4, 0.2), "surface": "white_board"}
        mean, _ = front(stages(robot, drive(x=0.2), where=arena(box))["tof"], robot)
        np.testing.assert_allclose(mean, 0.75 - drive(x=0.2)[:, 0] + BOARD_M, atol=1e-6)

    def test_an_obstacle_that_moves_is_where_it_is_at_the_time_of_the_row(self, robot):
        motion = {"waypoints": [{"t_s": 2.0, "offset": (0.1, 0.0)}]}
        box = {"name": "O", "center": (0.7, 0.0), "size": (0.1, 1.0, 0.2), "surface": "white_board", "motion": motion}
        pose = drive(speed=0.0, x=0.2)
        mean, _ = front(stages(robot, pose, where=arena(box))["tof"], robot)
        np.testing.assert_allclose(mean, 0.45 + 0.05 * ROW_S * np.arange(ROWS) + BOARD_M, atol=1e-6)
        # The obstacle waits at its last place, which it reached before this log began.
        mean, _ = front(stages(robot, pose, where=arena(box), begins_s=3.0)["tof"], robot)
        np.testing.assert_allclose(mean, 0.55 + BOARD_M, atol=1e-6)

    def test_rows_beside_an_edge_and_beyond_the_range_are_left_out(self, robot):
        box = {"name": "O", "center": (0.8, 0.0), "size": (0.1, 0.4, 0.2), "surface": "white_board"}
        beside = np.column_stack([np.full(ROWS, 0.2), np.linspace(-0.4, 0.4, ROWS), np.zeros(ROWS)])
        clear = stages(robot, beside, where=arena(box))["tof"].observed[0].usable
        near_edge = np.abs(np.abs(beside[:, 1]) - 0.2) < 0.015
        assert near_edge.any()
        assert not clear[near_edge].any()
        assert clear[np.abs(np.abs(beside[:, 1]) - 0.2) > 0.05].all()
        far = stages(robot, drive(x=-0.1825))["tof"].observed[0]
        distance = WALL_X - drive(x=-0.1825)[:, 0]
        np.testing.assert_array_equal(far.usable, distance <= robot.tof.max_range_m - 0.03)

    @pytest.mark.parametrize(
        ("effect", "longer_m"),
        [
            (TofRangeOffset(sensor="front", offset_m=0.01), 0.01),
            (TofTimeOffset(delay_s=0.08), 0.08 * SPEED),
            (RangeGatheringTime(duration_s=0.16), 0.08 * SPEED),
            (PoseTimeOffset(delay_s=0.08), -0.08 * SPEED),
            (MarkerOffset(offset_m=0.02), 0.02),
        ],
        ids=lambda value: getattr(value, "name", ""),
    )
    def test_an_effect_moves_the_ranges_by_as_much_as_it_says(self, robot, effect, longer_m):
        pose = drive(x=0.2)
        stage = stages(robot, pose)["tof"]
        bare, moved = front(stage, robot)[0], front(stage, robot, effect)[0]
        inner = slice(3, -3)  # a pose before the first row or after the last is not in the log
        np.testing.assert_allclose((moved - bare)[inner], longer_m, atol=1e-6)

    def test_runs_of_one_log_do_not_see_each_other_and_may_have_a_single_row(self, robot):
        """A slow sensor is uncertain about its place by its speed times its period over the root of twelve."""
        period_s = 0.05
        slow = robot.with_section("tof", {"period_s": period_s})
        speeds = (0.2, 0.3, 0.0)
        poses = [drive(speed=0.2, x=0.2), drive(speed=0.3, x=0.1), drive(x=0.4)[:1]]
        still = [np.zeros(len(pose)) for pose in poses]
        stage = stages_of(slow, [run(str(k), pose, v, v) for k, (pose, v) in enumerate(zip(poses, still, strict=True))])
        sd = stage["tof"].predict([slow])[0].sd[0]
        for k, speed in enumerate(speeds):
            expected = math.hypot(NOISE.d_m, NOISE.pose_xy_m, speed * period_s / math.sqrt(12.0))
            # The first reading of a run is of a time before its first pose, for which this is taken. So the robot
            # seems to be slower until the second row.
            inside = sd[stage["tof"].observed[0].trial == k][2 if len(poses[k]) > 1 else 0 :]
            np.testing.assert_allclose(inside, expected, rtol=1e-3)

    def test_a_log_of_a_single_row_is_predicted(self, robot):
        pose = drive(x=0.2)[:1]
        mean, _ = front(stages(robot, pose)["tof"], robot)
        np.testing.assert_allclose(mean, WALL_X - 0.2 + BOARD_M, atol=1e-6)

    @pytest.mark.parametrize("angle", [0.1, 0.137, -0.203])
    def test_a_turned_sensor_sees_the_wall_at_a_slant(self, robot, angle):
        pose = drive(x=0.2)
        mean, _ = front(stages(robot, pose)["tof"], robot, TofMountYaw(sensor="front", angle_rad=angle))
        # Between two points of its grid, 0.01 rad apart, a length is off by at most its curvature times 0.01^2 / 8.
        np.testing.assert_allclose(mean, (WALL_X - pose[:, 0]) / math.cos(angle) + BOARD_M, atol=2e-5)

    def with_beam(self, robot, **front_mount):
        """A robot whose front sensor has the whole cone of the device."""
        mounts = robot.tof.mounts
        mounts = mounts.model_copy(update={"front": mounts.front.model_copy(update=front_mount)})
        beam = {"rays": 400, "field_of_view_deg": 25.0, "beam_sigma_deg": 7.0, "mounts": mounts}
        return robot.with_section("tof", beam)

    def test_a_sensor_that_looks_up_has_its_tilt_forward_and_one_that_looks_left_sideways(self, robot):
        pose = drive(speed=0.0, x=0.6)
        for mount, axis, other in (({"pitch_up_deg": 8.0}, "forward", "sideways"), ({"yaw_deg": -8.0}, "sideways", "")):
            looks = self.with_beam(robot, z_m=0.05, **mount).with_section("tof", {"rays": 1, "field_of_view_deg": 1e-3})
            stage = stages(looks, pose)["tof"]
            bare = front(stage, looks)[0]
            tilted = front(stage, looks, TiltAsymmetry(axis=axis, coefficient_m_per_rad=0.1))[0]
            sign = 1.0 if axis == "forward" else -1.0
            np.testing.assert_allclose(tilted - bare, sign * 0.1 * math.radians(8.0), atol=1e-6)
            if other:
                level = front(stage, looks, TiltAsymmetry(axis=other, coefficient_m_per_rad=0.1))[0]
                np.testing.assert_allclose(level, bare, atol=1e-6)

    def test_a_sensor_that_looks_into_a_corner_is_not_tilted(self, robot):
        """The mean of the normals of both sides points at the sensor, though each ray hits its side at 45 degrees."""
        sides = [
            {"name": name, "center": (0.5, y), "size": (0.8, 0.1, 0.4), "yaw_deg": turn, "surface": "white_board"}
            for name, y, turn in (("L", 0.2, -45.0), ("R", -0.2, 45.0))
        ]
        robot = self.with_beam(robot)
        stage = stages(robot, drive(speed=0.0, x=0.3), where=arena(*sides))["tof"]
        bare, biased = front(stage, robot)[0], front(stage, robot, IncidenceBias(coefficient=1.0))[0]
        assert len(bare) == ROWS
        np.testing.assert_allclose(biased, bare, rtol=0.01)

    @pytest.mark.parametrize("exponent", [0.0, 2.0])
    def test_near_parts_of_a_slanted_wall_count_by_their_distance(self, robot, exponent):
        """An integral over the cone in polar coordinates; the device is calibrated head-on. The wall is 2 m high."""
        slant, sigma = 0.8, math.radians(7.0)
        robot = self.with_beam(robot, z_m=1.0)
        tall = {"name": "T", "center": (WALL_X + 0.05, 0.0), "size": (0.1, 5.0, 2.0), "surface": "white_board"}
        sees = robot.with_effect(RangeSignalWeighting(exponent=exponent))
        pose = drive(speed=0.0, x=0.6, theta=slant)
        mean, _ = front(stages(sees, pose, where=arena(tall))["tof"], sees)
        assert len(mean) == ROWS
        a, roll = np.meshgrid(
            math.radians(12.5) * np.sqrt((np.arange(400) + 0.5) / 400),
            math.tau * (np.arange(360) + 0.5) / 360,
            indexing="ij",
        )
        ahead, aside = np.cos(a), np.sin(a) * np.cos(roll)

        def mean_of(turn):
            facing = ahead * math.cos(turn) - aside * math.sin(turn)
            distance = (WALL_X - 0.6) / facing
            weight = np.exp(-0.5 * (a / sigma) ** 2) * facing / distance**exponent
            return np.sum(weight * distance) / np.sum(weight)

        expected = mean_of(slant) * (WALL_X - 0.6) / mean_of(0.0)
        np.testing.assert_allclose(mean, expected + BOARD_M, atol=1e-3)

    def test_many_robots_at_once_are_each_of_them_alone(self, robot):
        stage = stages(robot, drive(x=0.2))["tof"]
        several = [
            robot,
            robot.with_effect(TofTimeOffset(delay_s=0.05)),
            robot.with_effect(MarkerOffset(offset_m=0.01)),
        ]
        together = stage.predict(several)
        for m, one in enumerate(several):
            for whole, alone in zip(together, stage.predict([one]), strict=True):
                np.testing.assert_array_equal(whole.mean[m], alone.mean[0])


class TestIncrements:
    V, W = 0.12, 0.6
    LASTS_S = 0.5

    def increments(self, robot, *effects, twist="odometry"):
        pose = drive(self.V, self.W)
        stage = stages(robot, pose, speeds=(self.V, self.W), twist=twist)["pose"]
        for effect in effects:
            robot = robot.with_effect(effect)
        return np.stack([p.mean[0] for p in stage.predict([robot])], axis=-1), stage

    def arc(self, v, w):
        turn = w * self.LASTS_S
        return [v / w * math.sin(turn), v / w * (1.0 - math.cos(turn)), turn]

    def test_speeds_give_the_arc_that_they_describe_and_its_columns_are_named(self, robot):
        got, stage = self.increments(robot)
        np.testing.assert_allclose(got, np.broadcast_to(self.arc(self.V, self.W), got.shape), rtol=1e-3)
        assert [observed.channel for observed in stage.observed] == ["v", "w", "w"]
        for observed in stage.observed:
            np.testing.assert_allclose(observed.values, got[:, stage.observed.index(observed)], rtol=1e-3)

    @pytest.mark.parametrize(
        ("effect", "v", "w"),
        [
            (WheelRadiusScale(scale=1.05), 1.05 * V, 1.05 * W),
            (WheelbaseScale(scale=1.06), V, W / 1.06),
            # r_right = r (1 - a/2), r_left = r (1 + a/2), with the rims at v +- w b/2.
            (WheelRadiusAsymmetry(asymmetry=0.04), V - 0.02 * W * 0.07, W - 0.04 * V / 0.14),
            (TurnSlip(coefficient_s2_m=1.0), V, W / (1.0 + V * W)),
        ],
        ids=lambda value: getattr(value, "name", ""),
    )
    def test_speeds_of_the_encoders_show_the_wheels(self, robot, effect, v, w):
        got, _ = self.increments(robot, effect)
        np.testing.assert_allclose(got, np.broadcast_to(self.arc(v, w), got.shape), rtol=1e-3)

    @pytest.mark.parametrize(
        "effect", [WheelRadiusScale(scale=1.05), WheelbaseScale(scale=1.06), TurnSlip(coefficient_s2_m=1.0)]
    )
    def test_speeds_of_the_body_say_nothing_of_the_wheels(self, robot, effect):
        bare, _ = self.increments(robot, twist="truth")
        got, _ = self.increments(robot, effect, twist="truth")
        np.testing.assert_array_equal(got, bare)
        np.testing.assert_allclose(bare, np.broadcast_to(self.arc(self.V, self.W), bare.shape), rtol=1e-3)

    @pytest.mark.parametrize("twist", ["odometry", "truth"])
    def test_a_prediction_does_not_depend_on_the_robots_beside_it(self, robot, twist):
        stage = stages(robot, drive(self.V, self.W), speeds=(self.V, self.W), twist=twist)["pose"]
        several = [robot, robot.with_effect(FloorSlope(gradient=0.1, direction_rad=0.0))]
        alone = [[p.mean[0] for p in stage.predict([each])] for each in several]
        for order in ([0, 1], [1, 0]):
            together = stage.predict([several[k] for k in order])
            for place, k in enumerate(order):
                for whole, single in zip(together, alone[k], strict=True):
                    np.testing.assert_allclose(whole.mean[place], single, atol=1e-12)
        changes = np.abs(np.array(alone[1]) - np.array(alone[0])).max()
        assert (changes > 1e-3) == (twist == "odometry")


class TestSpeedsThatChange:
    """v = a + b sin(c t) along a line of constant curvature, so that place and heading are known at every time."""

    MEAN, SWING, RATE = 0.1, 0.08, 5.0
    CURVATURE = 3.0

    def travel_m(self, t_s):
        return self.MEAN * t_s + self.SWING / self.RATE * (1.0 - np.cos(self.RATE * t_s))

    def pose(self, curvature=0.0):
        s = self.travel_m(ROW_S * np.arange(ROWS))
        yaw = curvature * s
        if not curvature:
            return np.column_stack([s, 0.0 * s, yaw])
        return np.column_stack([np.sin(yaw) / curvature, (1.0 - np.cos(yaw)) / curvature, yaw])

    def counted(self, curvature=0.0):
        """Speeds as encoders give them: the travel since the row before, over its time."""
        v = np.diff(self.travel_m(ROW_S * np.arange(-1, ROWS))) / ROW_S
        return v, curvature * v

    def errors(self, robot, runs, twist):
        stage = stages_of(robot, runs, twist=twist)["pose"]
        return [
            np.abs(predicted.mean[0] - observed.values)
            for observed, predicted in zip(stage.observed, stage.predict([robot]), strict=True)
        ]

    def cut_m(self, curvature):
        """The mid-point rule takes arcs for chords, which are shorter by the square of their angle over 24."""
        step_m = (self.MEAN + self.SWING) * ROW_S
        return 10.0 * step_m * (curvature * step_m) ** 2 / 24.0

    @pytest.mark.parametrize("curvature", [0.0, CURVATURE])
    def test_speeds_of_encoders_are_means_since_the_row_before(self, robot, curvature):
        *place, turn = self.errors(robot, [run("1", self.pose(curvature), *self.counted(curvature))], "odometry")
        assert max(error.max() for error in place) < 1e-9 + self.cut_m(curvature)
        assert turn.max() < 1e-9

    def test_speeds_of_the_body_are_those_at_the_times_of_the_rows(self, robot):
        """The trapezoidal rule errs by at most T h^2 / 12 times the greatest second derivative of the speed."""
        v = self.MEAN + self.SWING * np.sin(self.RATE * ROW_S * np.arange(ROWS))
        along, _, _ = self.errors(robot, [run("1", self.pose(), v, 0.0 * v)], "truth")
        assert along.max() < 0.5 * ROW_S**2 / 12.0 * self.SWING * self.RATE**2

    def test_speeds_of_the_body_may_be_late_by_the_same_time_in_all_rows(self, robot):
        """An encoder that is late says nothing of them; what is fitted is by how much later a hypothesis has them."""
        late_s, nominal = 0.02, robot.with_section("encoder", {"delay_s": 0.01})
        v = self.MEAN + self.SWING * np.sin(self.RATE * ROW_S * np.arange(ROWS))
        stage = stages_of(nominal, [run("1", self.pose(), v, 0.0 * v)], twist="truth")["pose"]
        later = nominal.with_section("encoder", {"delay_s": 0.01 + late_s})
        t_s = ROW_S * np.arange(0, ROWS - 10, 5)[:-1]
        for hypothesis, age_s in ((nominal, 0.0), (later, late_s)):
            travel = self.travel_m(t_s + 0.5 + age_s) - self.travel_m(t_s + age_s)
            # Errors of the trapezoidal rule, and of straight lines between the rows at both ends.
            bound_m = ROW_S**2 * self.SWING * self.RATE * (0.5 / 12.0 * self.RATE + 2.0 / 8.0)
            np.testing.assert_allclose(stage.predict([hypothesis])[0].mean[0][:-1], travel, atol=bound_m)

    def test_runs_of_one_log_are_integrated_one_by_one(self, robot):
        first = self.pose(self.CURVATURE)
        c, s = math.cos(2.0), math.sin(2.0)
        elsewhere = np.column_stack([first[:, :2] @ [[c, s], [-s, c]] + [5.0, -3.0], first[:, 2] + 2.0])
        v, w = self.counted(self.CURVATURE)
        runs = [run("a", first, v, w), run("b", first[:1], v[:1], w[:1]), run("c", elsewhere, v, w)]
        for errors in self.errors(robot, runs, "odometry"):
            assert len(errors) == 2 * len(range(0, ROWS - 10, 5))
            assert errors.max() < 1e-9 + self.cut_m(self.CURVATURE)
