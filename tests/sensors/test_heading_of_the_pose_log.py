"""The heading that the pose log adds an error to, by a law of the true heading and of the time."""

import math
from typing import Annotated

import numpy as np
import pytest

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from sensors.effects.pose_log.marker_offset import MarkerOffset
from sensors.effects.pose_log.marker_yaw import MarkerYaw
from sensors.pose_log import PoseLog

DRIFT_RAD_S = 0.003


class SwungHeading(Effect):
    slot = Slot.POSE_HEADING
    cause, excitation, setups = "a field that bends a compass", "headings all around", (Setup.DRIVE,)
    swing_rad: Annotated[float, Parameter("rad", null=0.0, start=0.05, low=-1.0, high=1.0)]

    def apply(self, error_rad, yaw_rad, time_s):
        return error_rad + self.swing_rad * np.sin(2.0 * yaw_rad) + DRIFT_RAD_S * time_s


@pytest.fixture
def log_of(arena_of):
    def make(robot):
        log = PoseLog.on_robot(robot, arena_of(), 1000, np.random.default_rng(0))
        assert log is not None
        return log

    return make


@pytest.mark.parametrize("yaw", [0.0, 0.7, 2.0])
def test_a_law_of_the_heading_adds_its_error_to_the_logged_heading_alone(robot, log_of, plane_world, yaw):
    """The law takes the heading of the robot, which is not that of a body that is tracked askew."""
    swung = robot.with_effect(SwungHeading(swing_rad=0.05))
    error = 0.05 * math.sin(2.0 * yaw) + DRIFT_RAD_S * 20.0
    world = plane_world(at=(1.0, 2.0, yaw), time_s=20.0)
    assert log_of(swung).sample(world) == pytest.approx((1.0, 2.0, yaw + error))
    askew = swung.with_effect(MarkerYaw(angle_rad=-0.3)).with_effect(MarkerOffset(offset_m=0.04))
    ahead = 1.0 + 0.04 * math.cos(yaw), 2.0 + 0.04 * math.sin(yaw)
    assert log_of(askew).sample(world) == pytest.approx((*ahead, yaw - 0.3 + error))
