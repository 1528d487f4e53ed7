"""Laws of the place, of the angle of a wheel and of the heading in the stages of a drive, against closed forms."""

import math
from typing import Annotated, Any

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from configs.loader import load_section
from diagnosis.measured.case_files.nominal import NominalDrive
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.nominal_robot import nominal_robot
from diagnosis.predictors import STAGES
from diagnosis.predictors.pose.tracked_axle import TrackedAxle
from sensors.effects.pose_log.marker_offset import MarkerOffset
from sensors.effects.pose_log.marker_yaw import MarkerYaw
from symolo.core.tables.time_series import TimeSeries

R, K, B, TC, J = 3.0, 0.3, 0.002, 0.02, 0.003
DAMPING = K * K / R + B
RADIUS, BASE, TICKS = 0.03, 0.16, 2000
ROW_S, ROWS, VOLTS = 0.05, 41, 3.0
T = ROW_S * np.arange(ROWS)
EDGE, DRIFT_RAD_S = 5.0, 0.002
Number = Annotated[float, Parameter("1", null=0.0, start=0.1, low=-1.0, high=1.0)]


def spread(value):
    return {"value": value, "tolerance": 0.01 * value}


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


class _Law(Effect):
    cause, excitation, setups = "none, for a test", "a drive", (Setup.DRIVE,)
    size: Number


class RoughPlaces(_Law):
    """More friction from an edge in x on, and twice as much more from one in y on."""

    slot = Slot.FRICTION

    def apply(self, friction_N_m, motion):
        return friction_N_m + self.size * (1.0 * (motion.x_m > EDGE) + 2.0 * (motion.y_m > EDGE))


class PulledAngles(_Law):
    slot = Slot.SHAFT_TORQUE

    def apply(self, torque_N_m, angle_rad, turned_rad):
        return torque_N_m - self.size * (angle_rad + 0.5 * turned_rad > EDGE)


class SlipperyPlaces(_Law):
    slot = Slot.TRAVEL

    def apply(self, share, place):
        return share * np.where(place.x_m > EDGE, 1.0 - self.size, 1.0)


class SwungHeading(_Law):
    slot = Slot.POSE_HEADING

    def apply(self, error_rad, yaw_rad, time_s):
        return error_rad + self.size * np.sin(2.0 * yaw_rad) + DRIFT_RAD_S * time_s


@pytest.fixture(scope="module")
def robot():
    return nominal_robot(NOMINAL, draw_robot(load_section("robot", "nominal"), 1, "test")[0])


def trial(name, begins_s, **columns):
    channels = tuple(
        Channel.logged(TimeSeries(key, "", T, np.array(values, dtype=float)), Role.READING)
        for key, values in columns.items()
    )
    return Trial(name, T, np.zeros(ROWS, dtype=bool), channels, begins_s=begins_s)


def log_of(*trials):
    return Measurement("m", CaseKind.DRIVE_LOG, MeasurementSource("here", ()), trials, NOMINAL)


def stage(robot, name, *trials) -> Any:
    (found,) = (each for each in STAGES[CaseKind.DRIVE_LOG](log_of(*trials), robot) if each.name == name)
    return found


def pose_columns(pose):
    return {name: pose[:, k] for k, name in enumerate(("x_m", "y_m", "theta_rad"))}


def ticks_of(left_rad, right_rad):
    return {"enc_left_ticks": TICKS / math.tau * left_rad, "enc_right_ticks": TICKS / math.tau * right_rad}


class TestWheels:
    """The log says where the robot is and how far its wheels have turned: not where its voltages bring them."""

    VOLTAGE = np.append(np.full(ROWS - 1, VOLTS), math.nan)
    UNTIL, LATER = 12, 25

    @staticmethod
    def mean_speeds(loads_N_m):
        """J w' = K U / R - DAMPING w - Tc - load, from rest, with a load that is constant in each row."""
        speed, left, means = 0.0, math.exp(-ROW_S * DAMPING / J), []
        for load in loads_N_m[:-1]:
            final = (K * VOLTS / R - TC - load) / DAMPING
            means.append(final + (speed - final) * (1.0 - left) * J / (DAMPING * ROW_S))
            speed = final + (speed - final) * left
        return np.append(means, math.nan)

    def predicted(self, robot, effect, **columns):
        """Of the left and of the right wheel."""
        log = trial("1", 0.0, u_left_V=self.VOLTAGE, u_right_V=self.VOLTAGE, **columns)
        return [of.mean[0] for of in stage(robot, "wheels", log).predict([robot.with_effect(effect)])]

    def test_friction_of_a_place_acts_where_the_log_has_the_robot(self, robot):
        row = np.arange(ROWS)
        in_x, in_y = row >= self.UNTIL, row >= self.LATER
        pose = np.stack([np.where(in_x, 6.0, 4.0), np.where(in_y, 6.0, 4.0), np.zeros(ROWS)], axis=-1)
        columns = ticks_of(np.zeros(ROWS), np.zeros(ROWS)) | pose_columns(pose)
        for speeds in self.predicted(robot, RoughPlaces(size=0.03), **columns):
            np.testing.assert_allclose(speeds, self.mean_speeds(0.03 * in_x + 0.06 * in_y), rtol=1e-9)

    def test_torque_of_an_angle_acts_where_the_log_has_the_wheel(self, robot):
        """Each wheel passes the angle in another row; within a row it turns by less than 0.5 rad."""
        row = np.arange(ROWS)
        beyond = row >= self.UNTIL, row >= self.LATER
        columns = ticks_of(*(np.where(each, 5.5, 4.2) for each in beyond))
        sides = self.predicted(robot, PulledAngles(size=0.08), **columns)
        for speeds, each in zip(sides, beyond, strict=True):
            np.testing.assert_allclose(speeds, self.mean_speeds(0.08 * each), rtol=1e-9)


class TestHeading:
    """Circles: right wheel 6 rad/s, left 4 rad/s. The logged heading has an error of 0.1 sin(2 yaw) and a drift."""

    V, W, MARKER_M = RADIUS * 5.0, RADIUS * 2.0 / BASE, 0.03
    SWING = SwungHeading(size=0.1)
    BEGINS = ((0.4, 30.0), (2.3, 60.0))
    """Heading of the robot at the start of each trial, and time since the start of the session."""

    def axle(self, begin_rad):
        yaw = begin_rad + self.W * T
        x = 0.5 + self.V / self.W * (np.sin(yaw) - math.sin(begin_rad))
        y = 0.6 - self.V / self.W * (np.cos(yaw) - math.cos(begin_rad))
        return np.stack([x, y, yaw], axis=-1)

    def logged(self, begin_rad, begins_s, askew_rad):
        x, y, yaw = self.axle(begin_rad).T
        error = 0.1 * np.sin(2.0 * yaw) + DRIFT_RAD_S * (begins_s + T)
        ahead = self.MARKER_M * np.cos(yaw), self.MARKER_M * np.sin(yaw)
        return np.stack([x + ahead[0], y + ahead[1], yaw + askew_rad + error], axis=-1)

    def swung(self, robot, askew_rad):
        robot = robot.with_effect(self.SWING).with_effect(MarkerOffset(offset_m=self.MARKER_M))
        return robot.with_effect(MarkerYaw(angle_rad=askew_rad))

    @pytest.mark.parametrize("askew_rad", [0.0, 0.3])
    def test_a_whole_path_has_the_error_at_the_heading_of_the_robot(self, robot, askew_rad):
        """From the logged start alone, whose own error is to be taken off first.

        Each pass for the error of the start leaves a fifth of 0.1 rad or less; the place is by the mid-point rule.
        """
        logs = [self.logged(*begin, askew_rad) for begin in self.BEGINS]
        trials = []
        for k, (log, (_, begins_s)) in enumerate(zip(logs, self.BEGINS, strict=True)):
            first = np.full_like(log, math.nan)
            first[0] = log[0]
            trials.append(trial(str(k), begins_s, **ticks_of(4.0 * T, 6.0 * T), **pose_columns(first)))
        starts = np.stack([log[0] for log in logs])
        path = stage(robot, "pose", *trials).path(self.swung(robot, askew_rad), starts)
        np.testing.assert_allclose(path[:, 2], np.concatenate(logs)[:, 2], atol=2e-5)
        np.testing.assert_allclose(path[:, :2], np.concatenate(logs)[:, :2], atol=2e-4)

    @pytest.mark.parametrize("askew_rad", [0.0, 0.3])
    def test_the_axle_is_found_from_the_logged_pose_without_its_error(self, robot, askew_rad):
        begin_rad, begins_s = self.BEGINS[0]
        log = self.logged(begin_rad, begins_s, askew_rad)
        tracked = TrackedAxle(log_of(trial("1", begins_s, **pose_columns(log))))
        found = tracked.at([self.swung(robot, askew_rad)], 0.0)
        np.testing.assert_allclose(found.reshape(ROWS, 3), self.axle(begin_rad), atol=2e-5)


def test_a_whole_path_loses_travel_from_the_edge_on_that_it_reaches_itself(robot):
    """An unseen run has no places but the ones that are predicted: straight on from 0.1 m before a slippery floor."""
    rolled = RADIUS * 5.0 * T
    first = np.full((ROWS, 3), math.nan)
    first[0] = (EDGE - 0.1, 0.0, 0.0)
    pose = stage(robot, "pose", trial("1", 0.0, **ticks_of(5.0 * T, 5.0 * T), **pose_columns(first)))
    path = pose.path(robot.with_effect(SlipperyPlaces(size=0.4)), first[:1])
    x_m = EDGE - 0.1 + np.where(rolled > 0.1, 0.1 + 0.6 * (rolled - 0.1), rolled)
    # The place in the middle of a row is that of the whole row.
    np.testing.assert_allclose(path[:, 0], x_m, atol=0.4 * RADIUS * 5.0 * ROW_S)
