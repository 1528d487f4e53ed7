"""Dead reckoning against closed forms of differential-drive kinematics."""

import math

import numpy as np
import pytest

from sensors.wheels.encoders import WheelEncoders
from sensors.wheels.odometry import Odometry

COUNTS = 3840
CIRCUMFERENCE_M = math.pi * 0.065
TRACK_M = 0.14


@pytest.fixture(scope="module")
def odometry():
    return Odometry(CIRCUMFERENCE_M / COUNTS, TRACK_M)


def drive(odometry, right, left, steps):
    pose = (0.0, 0.0, 0.0)
    for _ in range(steps):
        pose = odometry.step(pose, np.array([right, left]))
    return pose


def test_one_turn_of_both_wheels_is_one_circumference_ahead(odometry):
    assert drive(odometry, 384, 384, 10) == pytest.approx((CIRCUMFERENCE_M, 0.0, 0.0), abs=1e-12)


def test_wheels_against_each_other_turn_on_the_spot(odometry):
    # The right wheel forward and the left back: counter-clockwise by arc over half the track.
    x, y, yaw = drive(odometry, 100, -100, 5)
    assert (x, y) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert yaw == pytest.approx(500 / COUNTS * CIRCUMFERENCE_M / (TRACK_M / 2))


def test_small_steps_follow_a_circle(odometry):
    right, left, steps = 60, 40, 200
    x, y, yaw = drive(odometry, right, left, steps)
    radius = TRACK_M / 2 * (right + left) / (right - left)
    assert (x, y) == pytest.approx((radius * math.sin(yaw), radius * (1 - math.cos(yaw))), abs=2e-4)


def test_the_nominal_robot_has_a_resolution_of_53_micrometres(robot):
    assert Odometry.from_config(robot).metres_per_count == pytest.approx(53.2e-6, abs=0.1e-6)


def test_a_failed_encoder_reading_keeps_the_counts_before(robot, plane_world):
    encoders = WheelEncoders(robot.encoder, 1000, np.random.default_rng(0))
    assert encoders.sample(plane_world(counts=(3, 4))).tolist() == [3, 4]
    encoders._dropout_probability = 1.0
    assert encoders.sample(plane_world(counts=(7, 9))).tolist() == [3, 4]
