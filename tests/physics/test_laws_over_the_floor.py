"""Effects that depend on the place of the robot, on its wheel or on the time, against closed forms."""

from typing import Annotated

import numpy as np
import pytest

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from physics.bullet.open_loop import open_loop
from physics.drivetrain.driveline import Driveline
from physics.drivetrain.motor_bench import steady_states
from physics.drivetrain.wheel_turns import MeasuredRows, counted_turns
from physics.robot.floor_place import at_wheel
from physics.robot.model import RobotModel
from physics.twin import KinematicTwin

FROM_M, LOST, MORE_N_M = 0.1, 0.4, 0.004
ROW_S, ROWS = 0.01, 150
Number = Annotated[float, Parameter("1", null=0.0, start=0.1, low=-1.0, high=1.0)]


class _OfPlace(Effect):
    cause, excitation, setups = "a floor of two parts", "drives over both parts", (Setup.DRIVE,)
    size: Number


class SlipperyBeyond(_OfPlace):
    slot = Slot.TRAVEL

    def apply(self, share, place):
        return share * np.where(place.x_m > FROM_M, 1.0 - self.size, 1.0)


class RoughBeyond(_OfPlace):
    slot = Slot.FRICTION

    def apply(self, friction_N_m, motion):
        return friction_N_m + np.where(motion.x_m > FROM_M, self.size, 0.0)


class TurnsLess(_OfPlace):
    slot = Slot.TURNING

    def apply(self, share, place):
        return share * np.where(place.time_s > 0.5 * ROW_S * ROWS, 1.0 - self.size, 1.0)


class PulledAtLeft(_OfPlace):
    slot = Slot.SHAFT_TORQUE

    def apply(self, torque_N_m, angle_rad, turned_rad):
        return torque_N_m + at_wheel("left", torque_N_m) * self.size * np.sin(angle_rad + 0.0 * turned_rad)


def driven(robot, effect, voltages_V, engine):
    """Poses and wheel speeds of a drive from the origin."""
    robot = robot.with_effect(effect) if effect is not None else robot
    volts = np.tile(voltages_V, (ROWS, 1))
    if engine == "PyBullet":
        run = open_loop(robot, volts, ROW_S)
        return run.pose, run.wheel_speed_rad_s
    run = KinematicTwin(RobotModel.from_config(robot), ROW_S).drive(volts[:, None], np.zeros((1, 3)))
    return run.pose[:, 0], run.wheel_speed_rad_s[:, 0]


ENGINES = pytest.mark.parametrize(("engine", "off"), [("twin", 0.003), ("PyBullet", 0.01)])


@ENGINES
def test_wheels_lose_a_share_of_their_travel_beyond_an_edge(robot, engine, off):
    slippery, _ = driven(robot, SlipperyBeyond(size=LOST), (3.0, 3.0), engine)
    bare, _ = driven(robot, None, (3.0, 3.0), engine)
    expected = np.where(bare[:, 0] > FROM_M, FROM_M + (1.0 - LOST) * (bare[:, 0] - FROM_M), bare[:, 0])
    assert bare[-1, 0] > 2.0 * FROM_M
    np.testing.assert_allclose(slippery[:, 0], expected, atol=off)


@ENGINES
def test_friction_is_larger_beyond_an_edge(robot, engine, off):
    """A settled speed falls by the torque over the damping; the engine has a body, of which wheels and caster see the
    acceleration alone.
    """
    rough, speed = driven(robot, RoughBeyond(size=MORE_N_M), (3.0, 3.0), engine)
    _, bare = driven(robot, None, (3.0, 3.0), engine)
    damping = Driveline.of_robot(RobotModel.from_config(robot)).damping_N_m_s_rad
    before = rough[:, 0] < FROM_M
    np.testing.assert_allclose(speed[before][:-2], bare[before][:-2], atol=1e-9)
    np.testing.assert_allclose((bare - speed)[-1], MORE_N_M / damping, rtol=0.02 + off)


@ENGINES
def test_the_robot_turns_less_from_some_time_on(robot, engine, off):
    less, _ = driven(robot, TurnsLess(size=LOST), (3.0, 2.4), engine)
    bare, _ = driven(robot, None, (3.0, 2.4), engine)
    turned, half = np.diff(bare[:, 2]), ROWS // 2
    np.testing.assert_allclose(np.diff(less[:, 2])[:half], turned[:half], atol=1e-9)
    assert np.diff(less[:, 2])[half + 1 :].sum() == pytest.approx(
        (1.0 - LOST) * turned[half + 1 :].sum(), rel=0.02 + off
    )


def test_a_measured_angle_stands_for_one_that_is_computed(robot):
    """At an angle of 90 degrees in all rows, the torque is constant, and so is the change of the settled speed."""
    volts = np.full((ROWS, 1, 2), 3.0)
    nowhere = np.zeros((ROWS, 1, 1))
    measured = MeasuredRows(nowhere, nowhere, np.full((ROWS, 1, 2), 0.5 * np.pi))
    model = RobotModel.from_config(robot)
    bare, pulled = (
        counted_turns(each, volts, ROW_S, np.zeros(1), measured=measured)[-1, 0] / ROW_S
        for each in (model, model.with_effect(PulledAtLeft(size=MORE_N_M)))
    )
    assert pulled[0] == pytest.approx(bare[0], abs=1e-9)
    assert pulled[1] - bare[1] == pytest.approx(MORE_N_M / Driveline.of_robot(model).damping_N_m_s_rad[1], rel=0.01)


def test_a_measured_place_stands_for_one_that_is_computed(robot):
    volts, x_m = np.full((ROWS, 1, 2), 3.0), np.zeros((ROWS, 1, 1))
    x_m[ROWS // 2 :] = 2.0 * FROM_M
    measured = MeasuredRows(x_m, np.zeros_like(x_m), np.full((ROWS, 1, 2), np.nan))
    model = RobotModel.from_config(robot)
    bare, rough = (
        counted_turns(each, volts, ROW_S, np.zeros(1), measured=measured)[:, 0] / ROW_S
        for each in (model, model.with_effect(RoughBeyond(size=MORE_N_M)))
    )
    np.testing.assert_allclose(rough[: ROWS // 2], bare[: ROWS // 2], atol=1e-9)
    damping = Driveline.of_robot(model).damping_N_m_s_rad
    np.testing.assert_allclose((bare - rough)[-1], MORE_N_M / damping, rtol=0.02)


def test_a_single_motor_on_a_bench_may_be_either_wheel(robot):
    assert at_wheel("left", np.zeros((4, 2))).tolist() == [0.0, 1.0]
    assert at_wheel("right", np.zeros((4, 2))).tolist() == [1.0, 0.0]
    assert at_wheel("left", np.zeros((4, 1))).tolist() == [1.0]
    model = RobotModel.from_config(robot).with_effect(PulledAtLeft(size=MORE_N_M))
    assert all(len(each) == 1 for each in steady_states(model, np.array([3.0]), np.zeros(1)))
