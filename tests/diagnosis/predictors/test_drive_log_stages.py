"""Wheels, pose increments and ranges of a drive against closed forms, and which of them an effect shows in."""

import math
from dataclasses import replace

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.effects.registry import EFFECTS
from configs.loader import load_section
from diagnosis.measured.case_files.nominal import NominalDrive
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.nominal_robot import nominal_robot
from diagnosis.predictors import STAGES
from diagnosis.predictors.wheels.speeds import DEAD_ZONES
from physics.effects.driver_and_battery.battery_decline import BatteryDecline
from physics.effects.driver_and_battery.bridge_voltage_drop import BridgeVoltageDrop
from physics.effects.driver_and_battery.input_delay import InputDelay
from physics.effects.driver_and_battery.supply_sag import SupplySag
from physics.effects.encoders.encoder_missed_ticks import EncoderMissedTicks
from physics.effects.encoders.encoder_ticks_scale import EncoderTicksScale
from physics.effects.motor_and_gearbox.coulomb_friction_scale import CoulombFrictionScale
from physics.effects.motor_and_gearbox.rotor_inertia_scale import RotorInertiaScale
from physics.effects.motor_and_gearbox.torque_constant_mismatch import TorqueConstantMismatch
from physics.effects.motor_and_gearbox.torque_constant_scale import TorqueConstantScale
from physics.effects.motor_and_gearbox.viscous_friction_scale import ViscousFrictionScale
from physics.effects.motor_and_gearbox.winding_resistance_scale import WindingResistanceScale
from physics.effects.wheels_and_floor.floor_slope import FloorSlope
from physics.effects.wheels_and_floor.turn_slip import TurnSlip
from physics.effects.wheels_and_floor.wheel_eccentricity import WheelEccentricity
from physics.effects.wheels_and_floor.wheel_radius_asymmetry import WheelRadiusAsymmetry
from physics.effects.wheels_and_floor.wheel_radius_scale import WheelRadiusScale
from physics.effects.wheels_and_floor.wheelbase_scale import WheelbaseScale
from sensors.effects.pose_log.marker_offset import MarkerOffset
from sensors.effects.pose_log.marker_yaw import MarkerYaw
from sensors.effects.pose_log.pose_clock_drift import PoseClockDrift
from sensors.effects.pose_log.pose_time_offset import PoseTimeOffset
from sensors.effects.range_sensor.range_gathering_time import RangeGatheringTime
from sensors.effects.range_sensor.range_offset import RangeOffset
from sensors.effects.range_sensor.tof_mount_yaw import TofMountYaw
from sensors.effects.range_sensor.tof_range_offset import TofRangeOffset
from sensors.effects.range_sensor.tof_range_scale import TofRangeScale
from sensors.effects.range_sensor.tof_time_offset import TofTimeOffset
from symolo.core.tables.time_series import TimeSeries

R, K, B, TC, J = 3.0, 0.3, 0.002, 0.02, 0.003
DAMPING = K * K / R + B
TAU_S = J / DAMPING
RADIUS, BASE, TICKS = 0.03, 0.16, 2000
ROOM = (2.0, 1.6)
ROW_S = 0.05
MOUNTS = {"front": (0.06, 0.0, 0.0), "left": (0.045, 0.05, math.pi / 4), "right": (0.045, -0.05, -math.pi / 4)}


def spread(value, share=0.01):
    return {"value": value, "tolerance": share * value if value else 0.0005}


NOMINAL = NominalDrive.model_validate(
    {
        "kind": "drive_log",
        "motor": {
            "winding_resistance_ohm": spread(R),
            "torque_constant_N_m_A": spread(K),
            "viscous_friction_N_m_s_rad": spread(B),
            "coulomb_friction_N_m": spread(TC),
            "rotor_inertia_kg_m2": spread(J),
            "supply_voltage_V": 7.4,
        },
        "robot": {
            "wheel_radius_m": spread(RADIUS),
            "wheel_separation_m": spread(BASE),
            "encoder_ticks_per_revolution": TICKS,
        },
        "tof": {
            "range_offset_m": spread(0.0),
            "max_range_m": 1.2,
            "mount": {name: {"x_m": x, "y_m": y, "yaw_rad": yaw} for name, (x, y, yaw) in MOUNTS.items()},
        },
        "world": {"room_x_m": ROOM[0], "room_y_m": ROOM[1]},
        "noise": {
            "wheel_speed_rad_s": 0.045,
            "pose_xy_m": 0.001,
            "pose_theta_rad": 0.003,
            "travel_m_per_sqrt_m": 0.0006,
            "tof_polynomial_mm": [1.4, 4.88, 2.51, 1.15],
            "tof_polynomial_origin_m": 0.18,
        },
    }
)


@pytest.fixture(scope="module")
def robot():
    return nominal_robot(NOMINAL, draw_robot(load_section("robot", "nominal"), 1, "test")[0])


def trial(name, begins_s=0.0, rows=None, **columns):
    rows = rows or len(next(iter(columns.values())))
    t_s = ROW_S * np.arange(rows)
    channels = tuple(
        Channel.logged(
            TimeSeries(key, "", t_s, np.array(values, dtype=float)), Role.INPUT if key[0] == "u" else Role.READING
        )
        for key, values in columns.items()
    )
    return Trial(name, t_s, np.zeros(rows, dtype=bool), channels, begins_s=begins_s)


def stages(robot, *trials, nominal=NOMINAL):
    stages_of_log = STAGES[CaseKind.DRIVE_LOG](
        Measurement("m", CaseKind.DRIVE_LOG, MeasurementSource("here", ()), trials, nominal), robot
    )
    return {stage.name: stage for stage in stages_of_log}


def means(stage, robot, *several):
    for effect in several:
        robot = robot.with_effect(effect)
    return [predicted.mean[0] for predicted in stage.predict([robot])]


def pose_columns(pose):
    return {name: pose[:, k] for k, name in enumerate(("x_m", "y_m", "theta_rad"))}


def ticks_of(left_rad, right_rad):
    """Of wheels that have turned so far at each row, not rounded."""
    return {"enc_left_ticks": TICKS / math.tau * left_rad, "enc_right_ticks": TICKS / math.tau * right_rad}


class TestWheels:
    U = 3.0
    ROWS = 21
    FINAL = (K * U / R - TC) / DAMPING
    SESSION_S = 600.0

    @pytest.fixture
    def wheels(self, robot):
        voltage = np.append(np.full(self.ROWS - 1, self.U), math.nan)
        turned = {name: np.zeros(self.ROWS) for name in ("enc_left_ticks", "enc_right_ticks")}
        log = trial("1", self.SESSION_S, u_left_V=-voltage, u_right_V=voltage, **turned)
        return stages(robot, log)["wheels"]

    def run_up(self, final=FINAL, tau_s=TAU_S, late_s=0.0):
        """Mean speeds between rows: w = final (1 - exp(-t / tau)), integrated."""
        t = np.maximum(ROW_S * np.arange(self.ROWS) - late_s, 0.0)
        angle = final * (t - tau_s * (1.0 - np.exp(-t / tau_s)))
        return np.append(np.diff(angle) / ROW_S, math.nan)

    def test_a_step_from_rest_is_the_mean_of_an_exponential_and_no_row_follows_the_last(self, wheels, robot):
        left, right = means(wheels, robot)
        np.testing.assert_allclose(right, self.run_up(), rtol=1e-9)
        np.testing.assert_allclose(left, -self.run_up(), rtol=1e-9)

    def test_a_dead_zone_that_is_wider_than_a_voltage_takes_all_of_the_speed(self, robot):
        """The voltage is 10 % of the supply's."""
        voltage = np.append(np.full(self.ROWS - 1, 0.1 * 7.4), math.nan)
        turned = {name: np.zeros(self.ROWS) for name in ("enc_left_ticks", "enc_right_ticks")}
        left, right = stages(robot, trial("1", u_left_V=-voltage, u_right_V=voltage, **turned))["wheels"].observed
        lost = self.run_up((K * 0.1 * 7.4 / R - TC) / DAMPING)[:-1]
        zones = ([e for e in of.input_errors if e.covariate == "u_V"] for of in (left, right))
        for width, of_left, of_right in zip(DEAD_ZONES, *zones, strict=True):
            np.testing.assert_allclose(of_left.response[:-1], lost * (width > 0.1), rtol=1e-9, atol=1e-12)
            np.testing.assert_allclose(of_right.response[:-1], -lost * (width > 0.1), rtol=1e-9, atol=1e-12)

    @pytest.mark.parametrize("begins_s", [0.033, 0.048])
    def test_a_step_within_a_row_is_seen_where_the_finer_voltages_are_known(self, robot, begins_s):
        """The mean of the row would act from its beginning on, and is too weak to move the wheel in the second case."""
        rows = np.append(np.full(self.ROWS - 1, self.U), math.nan)
        rows[0] *= 1.0 - begins_s / ROW_S
        turned = {name: np.zeros(self.ROWS) for name in ("enc_left_ticks", "enc_right_ticks")}
        coarse = trial("1", u_left_V=0.0 * rows, u_right_V=rows, **turned)
        steps = TimeSeries("u_right_V", "V", np.array([0.0, begins_s]), np.array([0.0, self.U]))
        still = TimeSeries("u_left_V", "V", np.array([0.0]), np.array([0.0]))
        fine = replace(coarse, held_inputs=(still, steps))
        expected = self.run_up(late_s=begins_s)[:-1]
        off = []
        for log in (coarse, fine):
            left, right = means(stages(robot, log)["wheels"], robot)
            assert not left[:-1].any()
            off.append(float(np.sqrt(np.mean((right[:-1] - expected) ** 2) / 2.0)))
        assert off[0] > 0.4 * NOMINAL.noise.wheel_speed_rad_s
        assert off[1] < 0.12 * NOMINAL.noise.wheel_speed_rad_s

    def test_inertia_and_delay_act_on_the_run_up(self, wheels, robot):
        _, right = means(wheels, robot, RotorInertiaScale(scale=1.4))
        np.testing.assert_allclose(right, self.run_up(tau_s=1.4 * TAU_S), rtol=1e-9)
        _, right = means(wheels, robot, InputDelay(delay_s=0.073))
        np.testing.assert_allclose(right, self.run_up(late_s=0.073), rtol=1e-9)

    def test_a_mismatch_takes_from_one_wheel_what_it_gives_the_other(self, wheels, robot):
        left, right = means(wheels, robot, TorqueConstantMismatch(mismatch=0.1))
        for predicted, k in ((-left, 1.05 * K), (right, 0.95 * K)):
            damping = k * k / R + B
            expected = self.run_up((k * self.U / R - TC) / damping, J / damping)
            np.testing.assert_allclose(predicted, expected, rtol=1e-9)

    def test_the_battery_declines_with_the_time_of_the_session(self, wheels, robot):
        left_over = 1.0 - 0.02 * self.SESSION_S / 60.0
        _, right = means(wheels, robot, BatteryDecline(fraction_per_minute=0.02))
        expected = self.run_up((K * self.U * left_over / R - TC) / DAMPING)
        np.testing.assert_allclose(right, expected, rtol=1e-3)

    def test_a_bridge_takes_its_drop_off_the_voltage(self, wheels, robot):
        _, right = means(wheels, robot, BridgeVoltageDrop(drop_V=0.4))
        np.testing.assert_allclose(right, self.run_up((K * (self.U - 0.4) / R - TC) / DAMPING), rtol=3e-4)

    def test_a_sagging_supply_serves_both_motors(self, wheels, robot):
        """Settled: u - r duty (2 duty I) = R I + K w on each, K I = B w + Tc."""
        _, right = means(wheels, robot, SupplySag(source_resistance_ohm=0.6))
        duty = self.U / 7.4
        resistance = R + 2.0 * 0.6 * duty**2
        settled = (K * self.U / resistance - TC) / (K * K / resistance + B)
        assert right[-2] == pytest.approx(settled, rel=1e-4)

    def test_more_ticks_in_a_turn_are_read_as_more_speed(self, wheels, robot):
        _, right = means(wheels, robot, EncoderTicksScale(scale=1.07))
        np.testing.assert_allclose(right, 1.07 * self.run_up(), rtol=1e-9)

    def test_missed_ticks_are_lost_beyond_the_threshold_with_a_soft_edge(self, wheels, robot):
        left, right = means(wheels, robot, EncoderMissedTicks(side="left", fraction=0.1, threshold_rad_s=5.0))
        np.testing.assert_allclose(right, self.run_up(), rtol=1e-9)
        lost = 0.1 / (1.0 + np.exp(-(self.run_up() - 5.0) / 0.3))
        np.testing.assert_allclose(-left, self.run_up() * (1.0 - lost), rtol=1e-9)

    def test_measured_speeds_are_ticks_between_rows(self, robot):
        voltage = np.zeros(4)
        ticks = {"enc_left_ticks": [0.0, 10.0, math.nan, 40.0], "enc_right_ticks": [0.0, -20.0, -20.0, -60.0]}
        left, right = stages(robot, trial("1", u_left_V=voltage, u_right_V=voltage, **ticks))["wheels"].observed
        per_tick = math.tau / TICKS / ROW_S
        np.testing.assert_allclose(left.values, [10.0 * per_tick, math.nan, math.nan, math.nan])
        np.testing.assert_allclose(right.values, [-20.0 * per_tick, 0.0, -40.0 * per_tick, math.nan])
        assert (left.name, right.name, left.channel) == ("wheel_left_rad_s", "wheel_right_rad_s", "wheel_speed_rad_s")
        assert set(left.sd.tolist()) == {0.045}


class TestPose:
    """A circle: right wheel 6 rad/s, left 4 rad/s, in 40 rows from (0.5, 0.6) at a heading of 0.4 rad."""

    ROWS = 41
    T = ROW_S * np.arange(ROWS)
    V, W = RADIUS * 5.0, RADIUS * 2.0 / BASE
    FIRST = np.arange(0, 31, 5)

    def circle(self, v=V, w=W, late_s=0.0, marker_m=0.0, askew=0.0):
        yaw = 0.4 + w * (self.T - late_s)
        x = 0.5 + v / w * (np.sin(yaw) - math.sin(0.4)) + marker_m * np.cos(yaw)
        y = 0.6 - v / w * (np.cos(yaw) - math.cos(0.4)) + marker_m * np.sin(yaw)
        return np.stack([x, y, yaw + askew], axis=-1)

    def windows(self, pose):
        """Over ten rows in the frame of the body at the first."""
        change = pose[self.FIRST + 10] - pose[self.FIRST]
        c, s = np.cos(pose[self.FIRST, 2]), np.sin(pose[self.FIRST, 2])
        return [c * change[:, 0] + s * change[:, 1], c * change[:, 1] - s * change[:, 0], change[:, 2]]

    @pytest.fixture
    def pose(self, robot):
        columns = {**ticks_of(4.0 * self.T, 6.0 * self.T), **pose_columns(self.circle())}
        return stages(robot, trial("1", **columns))["pose"]

    def check(self, predicted, expected, atol=2e-5):
        for a, b in zip(predicted, self.windows(expected), strict=True):
            np.testing.assert_allclose(a, b, atol=atol)

    def test_a_circle_is_the_same_arc_seen_from_every_window(self, pose, robot):
        self.check(means(pose, robot), self.circle())
        for of, expected in zip(pose.observed, self.windows(self.circle()), strict=True):
            np.testing.assert_allclose(of.values, expected, atol=1e-12)

    def test_a_heading_that_is_wrong_by_a_function_of_itself_is_in_proportion_to_the_turn(self, robot):
        """The tracked heading is wrong by A sin(2 yaw), a turn by the difference of both ends."""
        right = self.circle()
        wrong = right + np.array([0.0, 0.0, 1.0]) * 0.01 * np.sin(2.0 * right[:, 2:])
        columns = {**ticks_of(4.0 * self.T, 6.0 * self.T), **pose_columns(wrong)}
        turn = stages(robot, trial("1", **columns))["pose"].observed[2]
        (heading,) = (covariate for covariate in turn.covariates if covariate.name == "theta_rad")
        np.testing.assert_allclose(heading.values, wrong[self.FIRST + 5, 2])
        np.testing.assert_allclose(heading.size, 10 * ROW_S * self.W)
        error = turn.values - 10 * ROW_S * self.W
        # The tracked heading, at which the error is taken, is wrong by a hundredth itself.
        np.testing.assert_allclose(error, 0.02 * np.cos(2.0 * heading.values) * heading.size, rtol=0.03, atol=3e-4)

    def test_noise_is_the_formats(self, pose):
        q = 0.0006**2 * RADIUS * 5.0 * 10 * ROW_S
        place = 2.0 * 0.001**2 + (0.12 * 0.003) ** 2 + q / 2.0
        heading = 2.0 * 0.003**2 + 2.0 * q / BASE**2
        for of, variance in zip(pose.observed, (place, place, heading), strict=True):
            np.testing.assert_allclose(of.sd**2, variance, rtol=1e-9)
        assert pose.observed[0].correlation == pytest.approx(0.25 * q / place)

    def test_windows_one_after_the_other_share_a_pose_of_opposite_signs(self, pose):
        """Its x and y are seen from bodies that differ by the turn in between."""
        q = 0.0006**2 * RADIUS * 5.0 * 10 * ROW_S
        place = 2.0 * 0.001**2 + (0.12 * 0.003) ** 2 + q / 2.0
        of_place = -(0.001**2) / place * math.cos(self.W * 10 * ROW_S)
        of_heading = -(0.003**2) / (2.0 * 0.003**2 + 2.0 * q / BASE**2)
        for of, expected in zip(pose.observed, (of_place, of_place, of_heading), strict=True):
            assert of.shared.later == 2
            np.testing.assert_allclose(of.shared.correlation, expected, rtol=1e-3)

    @pytest.mark.parametrize(
        ("effect", "changed"),
        [
            (WheelRadiusScale(scale=1.1), {"v": 1.1 * V, "w": 1.1 * W}),
            (WheelbaseScale(scale=1.1), {"w": W / 1.1}),
            (EncoderTicksScale(scale=1.1), {"v": V / 1.1, "w": W / 1.1}),
            (TurnSlip(coefficient_s2_m=0.8), {"w": W / (1.0 + 0.8 * V * W)}),
            (
                WheelRadiusAsymmetry(asymmetry=0.1),
                {"v": RADIUS * (0.95 * 6 + 1.05 * 4) / 2, "w": RADIUS * (0.95 * 6 - 1.05 * 4) / BASE},
            ),
            (MarkerOffset(offset_m=0.03), {"marker_m": 0.03}),
            (MarkerYaw(angle_rad=0.1), {"askew": 0.1}),
        ],
        ids=lambda value: type(value).__name__,
    )
    def test_effects_bend_the_circle_by_their_definition(self, pose, robot, effect, changed):
        self.check(means(pose, robot, effect), self.circle(**changed))

    def test_a_whole_path_goes_on_from_the_first_logged_pose(self, robot):
        """Of an unseen run, which has no other pose; the tracked body is 30 mm ahead of the axle and askew."""
        log = np.full((self.ROWS, 3), math.nan)
        log[0] = self.circle(marker_m=0.03, askew=0.1)[0]
        columns = {**ticks_of(4.0 * self.T, 6.0 * self.T), **pose_columns(log)}
        stage = stages(robot, trial("1", **columns))["pose"]
        askew = robot.with_effect(MarkerOffset(offset_m=0.03)).with_effect(MarkerYaw(angle_rad=0.1))
        np.testing.assert_allclose(stage.path(askew, log[:1]), self.circle(marker_m=0.03, askew=0.1), atol=5e-5)

    def test_an_old_pose_lags_behind_the_wheels(self, pose, robot):
        """But in the first window, which begins at rest."""
        predicted = means(pose, robot, PoseTimeOffset(delay_s=0.083))
        late = self.windows(self.circle(late_s=0.083))
        for a, b in zip(predicted, late, strict=True):
            np.testing.assert_allclose(a[1:], b[1:], atol=1e-4)
        assert predicted[2][0] == pytest.approx(self.W * (0.5 - 0.083))

    @pytest.mark.parametrize(("side", "index"), [("left", 0), ("right", 1)])
    def test_a_wheel_that_is_not_round_travels_by_its_angle(self, robot, side, index):
        """In steps of 0.5 ms; its counts do not begin at 0, and those of the second trial elsewhere."""
        fine_s = 5e-4 * np.arange(1 + 100 * (self.ROWS - 1))
        trials, expected = [], []
        for name, begin_rad in (("1", 0.8), ("2", 2.3)):
            turned = np.array([4.0, 6.0])[:, None] * fine_s
            share = np.ones_like(turned)
            share[index] += 0.06 * np.cos(begin_rad + turned[index] + 1.9)
            travel = RADIUS * 0.5 * (share[:, 1:] + share[:, :-1]) * np.diff(turned)
            yaw = np.append(0.0, np.cumsum((travel[1] - travel[0]) / BASE))
            middle, ahead = 0.5 * (yaw[1:] + yaw[:-1]), travel.mean(axis=0)
            place = [np.append(0.0, np.cumsum(ahead * way(middle))) for way in (np.cos, np.sin)]
            expected.append(np.stack([*place, yaw], axis=-1)[::100])
            columns = {**ticks_of(begin_rad + 4.0 * self.T, begin_rad + 6.0 * self.T), **pose_columns(self.circle())}
            trials.append(trial(name, **columns))
        effect = WheelEccentricity(side=side, amplitude=0.06, phase_rad=1.9)
        predicted = means(stages(robot, *trials)["pose"], robot, effect)
        for k, path in enumerate(expected):
            self.check([each[7 * k : 7 * k + 7] for each in predicted], path, atol=5e-5)

    def test_on_a_slope_the_robot_creeps_in_one_direction_of_the_room(self, robot):
        """By 2 % of the travel of its wheels, 5 rad/s in the mean; its tracked heading is askew by 0.2 rad."""
        sloping = robot.with_effect(FloorSlope(gradient=0.02, direction_rad=2.5)).with_effect(MarkerYaw(angle_rad=0.2))
        crept = 0.02 * RADIUS * 5.0 * self.T[:, None] * np.array([math.cos(2.5), math.sin(2.5), 0.0])
        log = self.circle(askew=0.2) + crept
        columns = {**ticks_of(4.0 * self.T, 6.0 * self.T), **pose_columns(log)}
        stage = stages(robot, trial("1", **columns), trial("2", 10.0, **columns))["pose"]
        for predicted, expected in zip(means(stage, sloping), self.windows(log), strict=True):
            np.testing.assert_allclose(predicted, np.tile(expected, 2), atol=5e-5)
        np.testing.assert_allclose(stage.path(sloping, np.tile(log[:1], (2, 1))), np.tile(log, (2, 1)), atol=2e-4)

    @pytest.mark.parametrize("on_the_spot", [0.0, 0.4, 1.0])
    def test_on_a_slope_a_robot_that_turns_on_the_spot_creeps_by_a_share_of_its_rolling(self, robot, on_the_spot):
        """Its wheels turn by 5 rad/s in opposite directions, so that the middle of the axle would stay where it is."""
        columns = {**ticks_of(-5.0 * self.T, 5.0 * self.T), **pose_columns(self.circle())}
        stage = stages(robot, trial("1", **columns))["pose"]
        slope = FloorSlope(gradient=0.02, direction_rad=2.5, on_the_spot=on_the_spot)
        path = stage.path(robot.with_effect(slope), np.zeros((1, 3)))
        crept_m = 0.02 * on_the_spot * RADIUS * 5.0 * self.T[:, None] * np.array([math.cos(2.5), math.sin(2.5)])
        np.testing.assert_allclose(path[:, :2], crept_m, atol=2e-5)

    def test_on_a_slope_a_late_pose_has_the_creep_of_the_heading_at_its_time(self, robot):
        """The logged poses are 0.2 s old, in which the robot turns by 0.075 rad."""
        late_s = 0.2
        sloping = robot.with_effect(FloorSlope(gradient=0.2, direction_rad=2.5))
        sloping = sloping.with_effect(PoseTimeOffset(delay_s=late_s))
        downhill = np.array([math.cos(2.5), math.sin(2.5), 0.0])
        log = self.circle(late_s=late_s) + 0.2 * RADIUS * 5.0 * (self.T - late_s)[:, None] * downhill
        columns = {**ticks_of(4.0 * self.T, 6.0 * self.T), **pose_columns(log)}
        stage = stages(robot, trial("1", **columns), trial("2", 10.0, **columns))["pose"]
        for predicted, expected in zip(means(stage, sloping), self.windows(log), strict=True):
            for begin in (0, len(self.FIRST)):
                # The first window begins at rest.
                np.testing.assert_allclose(predicted[begin + 1 : begin + 7], expected[1:], atol=1e-4)

    @pytest.mark.parametrize(
        "several",
        [
            [(FloorSlope(gradient=0.01 * k, direction_rad=k), MarkerYaw(angle_rad=0.1)) for k in (1.0, 2.0)],
            [(WheelEccentricity(side="left", amplitude=0.02 * k, phase_rad=-k),) for k in (1.0, 2.0)],
            [(FloorSlope(gradient=0.02, direction_rad=0.5), MarkerYaw(angle_rad=0.1 * k)) for k in (1.0, 2.0)],
            [(FloorSlope(gradient=0.02, direction_rad=0.5), WheelbaseScale(scale=1.1 * k)) for k in (1.0, 1.1)],
            [(FloorSlope(gradient=0.02, direction_rad=0.5), PoseClockDrift(rate=0.01 * k)) for k in (1.0, 2.0)],
        ],
    )
    def test_several_slopes_and_wheels_are_predicted_at_once_as_one_by_one(self, pose, robot, several):
        """In each set the robots differ in one effect only, so that the other one has no axis of robots."""
        robots = [robot.with_effect(effects[0]).with_effect(effects[-1]) for effects in several]
        together = pose.predict(robots)
        for k, each in enumerate(robots):
            for all_of_them, alone in zip(together, pose.predict([each]), strict=True):
                np.testing.assert_allclose(all_of_them.mean[k], alone.mean[0], atol=1e-12)

    def test_a_drifting_clock_makes_poses_older_and_older(self, robot):
        """Both signs, of several robots at once; the last window of a fast clock ends with the log."""
        columns = {**ticks_of(4.0 * self.T, 6.0 * self.T), **pose_columns(self.circle())}
        stage = stages(robot, trial("1", **columns), trial("2", 10.0, **columns))["pose"]
        rates = (0.04, -0.03)
        predicted = stage.predict([robot.with_effect(PoseClockDrift(rate=rate)) for rate in rates])
        for k, rate in enumerate(rates):
            late = self.windows(self.circle(late_s=rate * self.T))
            for both, expected in zip(predicted, late, strict=True):
                for begin in (0, len(self.FIRST)):
                    np.testing.assert_allclose(both.mean[k, begin : begin + 6], expected[:6], atol=1e-4)

    def test_ticks_that_were_missed_are_put_back(self, robot):
        """Of the right wheel a tenth is missed at its 6 rad/s, of which the threshold's edge is 20 widths away."""
        effect = EncoderMissedTicks(side="right", fraction=0.1, threshold_rad_s=0.05)
        kept = 1.0 - 0.1 / (1.0 + math.exp(-(6.0 - 0.05) / 0.3))
        columns = {**ticks_of(4.0 * self.T, kept * 6.0 * self.T), **pose_columns(self.circle())}
        self.check(means(stages(robot, trial("1", **columns))["pose"], robot, effect), self.circle())

    @pytest.mark.parametrize("speed", [2.6, 3.0, 3.4])
    def test_missed_ticks_are_put_back_also_at_the_edge(self, robot, speed):
        effect = EncoderMissedTicks(side="right", fraction=0.2, threshold_rad_s=3.0)
        kept = 1.0 - 0.2 / (1.0 + math.exp(-(speed - 3.0) / 0.3))
        columns = {**ticks_of(0.0 * self.T, kept * speed * self.T), **pose_columns(self.circle())}
        predicted = means(stages(robot, trial("1", **columns))["pose"], robot, effect)
        np.testing.assert_allclose(predicted[2], RADIUS * speed / BASE * 10 * ROW_S, rtol=1e-3)

    def test_a_window_without_a_tick_or_a_pose_is_not_used(self, robot):
        columns = {**ticks_of(4.0 * self.T, 6.0 * self.T), **pose_columns(self.circle())}
        columns["x_m"][15] = math.nan
        columns["enc_left_ticks"][36] = math.nan
        (of, *_) = stages(robot, trial("1", **columns))["pose"].observed
        assert of.usable.tolist() == [True, False, True, False, True, True, False]

    def test_trials_do_not_run_into_each_other(self, robot):
        columns = {**ticks_of(4.0 * self.T, 6.0 * self.T), **pose_columns(self.circle())}
        both = stages(robot, trial("1", **columns), trial("2", 10.0, **columns))["pose"]
        assert both.observed[0].trial.tolist() == [0] * 7 + [1] * 7
        for predicted in means(both, robot, PoseTimeOffset(delay_s=0.06)):
            np.testing.assert_allclose(predicted[7:], predicted[:7], atol=1e-12)


class TestRanges:
    POSES = np.array([[1.0, 0.8, 0.0], [1.0, 0.8, 0.3], [0.6, 0.5, -2.0], [1.2, 1.0, 1.3], [0.9, 0.7, 3.0]])

    @pytest.fixture
    def ranges(self, robot):
        columns = pose_columns(self.POSES) | {f"tof_{name}_m": np.full(5, 0.5) for name in MOUNTS}
        return stages(robot, trial("1", **columns))["tof"]

    @staticmethod
    def cast(pose, mount):
        """By marching along the axis in steps of a tenth of a millimetre until it leaves the room."""
        x, y, yaw = pose
        mx, my, turn = mount
        px, py = x + math.cos(yaw) * mx - math.sin(yaw) * my, y + math.sin(yaw) * mx + math.cos(yaw) * my
        s = 1e-4 * np.arange(40_000)
        qx, qy = px + s * math.cos(yaw + turn), py + s * math.sin(yaw + turn)
        return s[np.argmax((qx < 0) | (qx > ROOM[0]) | (qy < 0) | (qy > ROOM[1]))]

    def expected(self, poses, mounts=MOUNTS):
        return np.array([[self.cast(pose, mount) for mount in mounts.values()] for pose in poses]).T

    def test_distances_are_those_of_a_march_to_the_walls(self, ranges, robot):
        np.testing.assert_allclose(means(ranges, robot), self.expected(self.POSES), atol=2e-4)

    def test_each_range_may_depend_on_its_change_from_row_to_row(self, robot):
        """The robot drives towards a wall with 0.2 m/s."""
        pose = np.array([0.3, 0.8, 0.0]) + np.outer(0.2 * ROW_S * np.arange(30), [1.0, 0.0, 0.0])
        columns = pose_columns(pose) | {f"tof_{name}_m": np.full(30, 0.5) for name in MOUNTS}
        front = stages(robot, trial("1", **columns))["tof"].observed[0]
        (change,) = (covariate for covariate in front.covariates if covariate.name == "distance_step_m")
        np.testing.assert_allclose(change.values[2:-2], -0.2 * ROW_S, rtol=1e-6)

    def test_a_turned_mount_looks_elsewhere(self, ranges, robot):
        turned = MOUNTS | {"left": (0.045, 0.05, math.pi / 4 + 0.1)}
        predicted = means(ranges, robot, TofMountYaw(sensor="left", angle_rad=0.1))
        np.testing.assert_allclose(predicted, self.expected(self.POSES, turned), atol=2e-4)

    def test_offset_and_scale_act_on_the_reading(self, ranges, robot):
        true = np.array(means(ranges, robot))
        predicted = means(ranges, robot, TofRangeOffset(sensor="right", offset_m=0.02), TofRangeScale(scale=1.1))
        np.testing.assert_allclose(predicted, 1.1 * true + np.array([[0.0], [0.0], [0.02]]), rtol=1e-12)

    def test_a_marker_ahead_of_the_axle_moves_the_sensors_back(self, ranges, robot):
        back = self.POSES.copy()
        back[:, :2] -= 0.03 * np.stack([np.cos(back[:, 2]), np.sin(back[:, 2])], axis=-1)
        predicted = means(ranges, robot, MarkerOffset(offset_m=0.03))
        np.testing.assert_allclose(predicted, self.expected(back), atol=2e-4)

    def test_a_body_that_is_tracked_askew_looks_elsewhere_than_its_log(self, ranges, robot):
        """Its marker is 30 mm ahead of the axle along the heading of the robot, which is not the tracked one."""
        axle = self.POSES - np.array([0.0, 0.0, 0.2])
        axle[:, :2] -= 0.03 * np.stack([np.cos(axle[:, 2]), np.sin(axle[:, 2])], axis=-1)
        predicted = means(ranges, robot, MarkerOffset(offset_m=0.03), MarkerYaw(angle_rad=0.2))
        np.testing.assert_allclose(predicted, self.expected(axle), atol=2e-4)

    def test_old_ranges_are_those_of_an_earlier_pose_and_old_poses_of_a_later_one(self, robot):
        t = ROW_S * np.arange(20)
        poses = np.stack([0.8 + 0.2 * t, np.full(20, 0.8), np.zeros(20)], axis=-1)
        stage = stages(robot, trial("1", **pose_columns(poses)))["tof"]
        front = means(stage, robot)[0]
        old = means(stage, robot, TofTimeOffset(delay_s=0.12))[0]
        np.testing.assert_allclose(old[3:], front[3:] + 0.2 * 0.12, rtol=1e-9)
        # At a constant speed, the mean over a time is the range in the middle of it.
        gathered = means(stage, robot, RangeGatheringTime(duration_s=0.24))[0]
        np.testing.assert_allclose(gathered[6:], old[6:], rtol=1e-9)
        late = means(stage, robot, PoseTimeOffset(delay_s=0.12))[0]
        np.testing.assert_allclose(late[:-3], front[:-3] - 0.2 * 0.12, rtol=1e-9)
        drifting = means(stage, robot, PoseClockDrift(rate=0.05))[0]
        np.testing.assert_allclose(drifting[:-1], front[:-1] - 0.2 * 0.05 * t[:-1], rtol=1e-9)

    @staticmethod
    def head_on_m(yaw):
        """From x = 1 m to the wall in front."""
        return (2.0 - 1.0 - 0.06 * math.cos(yaw)) / math.cos(yaw)

    @pytest.mark.parametrize(
        ("counts", "share"),
        [({}, 1.0), ({"enc_left_ticks": np.zeros(2), "enc_right_ticks": np.zeros(2)}, 0.62)],
        ids=["without_counts", "beside_counts"],
    )
    def test_noise_is_that_of_the_reading_and_of_the_pose(self, robot, counts, share):
        """Head-on to a wall, place counts in full and heading not at all; poses smoothed beside counts have less."""
        poses = np.array([[1.4, 0.8, 0.0], [1.0, 0.8, 0.3]])
        front = stages(robot, trial("1", **counts, **pose_columns(poses)))["tof"].observed[0]
        by_polynomial = 1e-3 * np.polyval([1.15, 2.51, 4.88, 1.4], 2.0 - 1.46 - 0.18)
        assert front.sd[0] == pytest.approx(math.hypot(by_polynomial, share * 0.001), rel=1e-9)
        h = 1e-5
        by_yaw = (self.head_on_m(0.3 + h) - self.head_on_m(0.3 - h)) / (2 * h)
        by_polynomial = 1e-3 * np.polyval([1.15, 2.51, 4.88, 1.4], self.head_on_m(0.3) - 0.18)
        variance = by_polynomial**2 + share**2 * ((0.001 / math.cos(0.3)) ** 2 + (0.003 * by_yaw) ** 2)
        assert front.sd[1] == pytest.approx(math.sqrt(variance), rel=1e-6)

    def test_readings_of_a_row_with_a_wrong_pose_are_left_out_and_the_others_are_correlated_by_an_estimate(self, robot):
        poses = np.tile([1.0, 0.8, 0.0], (20, 1))
        poses[9, 1] += 0.1
        counts = {"enc_left_ticks": np.zeros(20), "enc_right_ticks": np.zeros(20), "tof_front_m": np.full(20, 0.9)}
        front = stages(robot, trial("1", **counts, **pose_columns(poses)))["tof"].observed[0]
        assert np.flatnonzero(~front.usable).tolist() == [9]
        assert front.correlation is None

    def test_rays_near_corners_and_near_the_end_of_the_range_are_left_out(self, robot):
        """Straight into a corner; 0.06 rad beside it and so 54 mm off; 1.16 m and 1.18 m from a wall."""
        corner = math.atan2(0.3, 0.4)
        at = np.array([2.0 - 0.4, 1.6 - 0.3])
        poses = [(*(at - 0.06 * np.array([math.cos(a), math.sin(a)])), a) for a in (corner, corner + 0.08)]
        poses += [(2.0 - 0.06 - d, 0.8, 0.0) for d in (1.16, 1.18)]
        columns = pose_columns(np.array(poses)) | {"tof_front_m": np.full(4, 0.5)}
        front = stages(robot, trial("1", **columns))["tof"].observed[0]
        assert front.usable.tolist() == [False, True, True, False]


def test_what_misses_leaves_its_stage_out(robot):
    t = ROW_S * np.arange(21)
    ticks, pose = ticks_of(t, t), pose_columns(np.zeros((21, 3)) + 0.5)
    volts = {"u_left_V": np.zeros(21), "u_right_V": np.zeros(21)}
    assert set(stages(robot, trial("1", **ticks, **pose))) == {"pose", "tof"}
    assert set(stages(robot, trial("1", **ticks, **pose), nominal=None)) == {"pose"}
    assert set(stages(robot, trial("1", **volts, **ticks))) == {"wheels", "pose"}
    unlogged = {name: np.full(21, math.nan) for name in volts}
    assert set(stages(robot, trial("1", **unlogged, **ticks, **pose))) == {"pose", "tof"}
    assert set(stages(robot, trial("1", **volts))) == {"wheels"}
    assert set(stages(robot, trial("1", **pose))) == {"tof"}
    drive = trial("1", **volts, **ticks, **pose)
    for section, left in (("motor", {"pose", "tof"}), ("tof", {"wheels", "pose"}), ("world", {"wheels", "pose"})):
        assert set(stages(robot, drive, nominal=NOMINAL.model_copy(update={section: None}))) == left


def test_a_range_sensor_without_a_mount_is_not_compared(robot):
    tof = NOMINAL.tof.model_copy(update={"mount": NOMINAL.tof.mount.model_copy(update={"left": None})})
    pose = pose_columns(np.tile([1.0, 0.7, 0.1], (20, 1)))
    ranges = {f"tof_{side}_m": np.full(20, 0.7) for side in MOUNTS}
    stage = stages(robot, trial("1", **pose, **ranges), nominal=NOMINAL.model_copy(update={"tof": tof}))["tof"]
    assert [bool(observed.usable.any()) for observed in stage.observed] == [True, False, True]


WHEELS, TOF = "wheels", "tof"
DX, DY, TURN = "pose_dx_m", "pose_dy_m", "pose_dtheta_rad"
SIGNATURES = [
    (WheelRadiusScale(scale=1.05), set(), {DX, TURN}),
    (EncoderTicksScale(scale=1.05), {WHEELS}, {DX, TURN}),
    (WheelbaseScale(scale=1.05), set(), {TURN}),
    (TurnSlip(coefficient_s2_m=0.5), set(), {TURN}),
    (WheelRadiusAsymmetry(asymmetry=0.05), set(), {TURN}),
    (EncoderMissedTicks(side="left", fraction=0.1, threshold_rad_s=3.0), {WHEELS}, {DX, TURN}),
    (MarkerOffset(offset_m=0.02), {TOF}, {DX, DY}),
    (PoseTimeOffset(delay_s=0.05), {TOF}, {DX, DY, TURN}),
    (TofRangeOffset(sensor="left", offset_m=0.012), {TOF}, set()),
    (TofRangeScale(scale=1.05), {TOF}, set()),
    (TofMountYaw(sensor="left", angle_rad=0.1), {TOF}, set()),
    (TofTimeOffset(delay_s=0.05), {TOF}, set()),
    (RangeGatheringTime(duration_s=0.1), {TOF}, set()),
    (RangeOffset(offset_m=0.01), {TOF}, set()),
    (WindingResistanceScale(scale=1.15), {WHEELS}, set()),
    (TorqueConstantScale(scale=1.15), {WHEELS}, set()),
    (TorqueConstantMismatch(mismatch=0.1), {WHEELS}, set()),
    (ViscousFrictionScale(scale=1.5), {WHEELS}, set()),
    (CoulombFrictionScale(scale=1.3), {WHEELS}, set()),
    (RotorInertiaScale(scale=1.15), {WHEELS}, set()),
    (BridgeVoltageDrop(drop_V=0.3), {WHEELS}, set()),
    (SupplySag(source_resistance_ohm=0.5), {WHEELS}, set()),
    (BatteryDecline(fraction_per_minute=0.03), {WHEELS}, set()),
    (InputDelay(delay_s=0.04), {WHEELS}, set()),
]
"""The fault signature matrix of the method: other stages and components of the pose that an effect shows in."""


@pytest.fixture(scope="module")
def tour(robot):
    """Ten minutes into a session: straight on, spins and bends, stops between them, by the stages' own wheels."""
    legs = [(4.0, 4.0), (0.0, 0.0), (-2.5, 2.5), (2.0, -2.0), (3.0, 4.5), (0.0, 0.0), (4.5, 3.0), (2.0, 2.0)]
    left, right = (np.repeat(np.array(volts), 20) for volts in zip(*legs, strict=True))
    still = {name: np.zeros(160) for name in ("enc_left_ticks", "enc_right_ticks")}
    speeds = means(stages(robot, trial("1", u_left_V=left, u_right_V=right, **still))["wheels"], robot)
    turned = [ROW_S * np.concatenate([[0.0], np.cumsum(speed[:-1])]) for speed in speeds]
    ds, dyaw = (RADIUS * np.diff(side, prepend=0.0) for side in ((turned[0] + turned[1]) / 2, turned[1] - turned[0]))
    dyaw = dyaw / BASE
    yaw = np.cumsum(dyaw)
    x, y = (np.cumsum(ds * f(yaw - dyaw / 2)) for f in (np.cos, np.sin))
    pose = np.stack([0.6 + x, 0.7 + y, yaw], axis=-1)
    columns = ticks_of(*turned) | pose_columns(pose) | {"u_left_V": left, "u_right_V": right}
    columns |= {f"tof_{name}_m": np.full(160, 0.5) for name in MOUNTS}
    return stages(robot, trial("1", 600.0, **columns))


def test_the_wheels_are_compared_by_the_place_of_the_robot_and_by_the_way_they_turn(tour):
    for of in tour["wheels"].observed:
        (place,) = (covariate for covariate in of.covariates if covariate.name == "position")
        assert (place.values[0], place.second[0]) == pytest.approx((0.6, 0.7), abs=1e-3)
        turning = of.usable & (np.abs(of.values) > 1.0)
        np.testing.assert_array_equal(place.size[turning], np.sign(of.values[turning]))


@pytest.mark.parametrize(("effect", "stages_but_pose", "of_pose"), SIGNATURES, ids=lambda of: type(of).__name__)
def test_an_effect_shows_where_the_signature_matrix_says(tour, robot, effect, stages_but_pose, of_pose):
    """Changes of more than half a standard deviation, and no change at all in any other stage.

    A sideways change of a bend is of second order in the turn; only its largest component is held against the matrix.
    """
    largest = {}
    for stage in tour.values():
        bare, changed = (stage.predict([of]) for of in (robot, robot.with_effect(effect)))
        for of, a, b in zip(stage.observed, bare, changed, strict=True):
            key = of.name if stage.name == "pose" else stage.name
            size = np.max((np.abs(b.mean[0] - a.mean[0]) / of.sd)[of.usable])
            largest[key] = max(largest.get(key, 0.0), float(size))
    shown = {name for name, size in largest.items() if size > 0.5}
    assert shown - {DX, DY, TURN} == stages_but_pose
    assert of_pose <= shown
    pose = {name: largest[name] for name in (DX, DY, TURN)}
    assert max(pose, key=pose.__getitem__) in of_pose if of_pose else set(pose.values()) == {0.0}
    assert all(largest[name] == 0.0 for name in {WHEELS, TOF} - stages_but_pose)


def test_many_robots_at_once_are_each_of_them_alone(tour, robot):
    robots = [robot]
    for effect in EFFECTS.classes():
        if effect.name != "gear_backlash":
            choices = {name: options[0] if options else "wood" for name, options in effect.options().items()}
            robots += [robot.with_effect(effect.start(choices)), robot.with_effect(effect.null(choices))]
    for stage in tour.values():
        together = stage.predict(robots)
        for k in range(0, len(robots), 6):
            for many, alone in zip(together, stage.predict([robots[k]]), strict=True):
                np.testing.assert_allclose(many.mean[k], alone.mean[0], rtol=1e-9, atol=1e-9)
                sd = np.broadcast_to(many.sd, many.mean.shape)[k]
                np.testing.assert_allclose(sd, np.broadcast_to(alone.sd, alone.mean.shape)[0], rtol=1e-9)
