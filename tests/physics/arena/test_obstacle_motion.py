"""Timed paths against values worked out by hand, and what rays, sensors, engine and twin make of them."""

import math

import numpy as np
import pybullet
import pytest

from configs.schema.arena import MotionConfig, Obstacle, Waypoint
from configs.schema.scenario import Rates
from physics.arena.rays import RayScene
from physics.bullet.simulation import BulletSimulation
from physics.robot.model import RobotModel
from physics.twin import KinematicTwin, ReplayedWorld
from sensors.ranging.tof import TofArray
from symolo.arena.geometry import Arena
from symolo.arena.obstacle_motion import ObstacleMotion
from symolo.dataset.codes import TofStatus

SPEED_M_S = 0.08
FACE_M = 0.28
"""x of the approaching box's near face at t = 0, so near that the sensor's cone meets nothing else."""


def motion(*waypoints, repeat="once", yaw_deg=0.0):
    points = tuple(Waypoint(t_s=t, offset=offset, turn_deg=turn) for t, offset, turn in waypoints)
    obstacle = Obstacle(
        name="cart", center=(1.0, 2.0), yaw_deg=yaw_deg, motion=MotionConfig(waypoints=points, repeat=repeat)
    )
    found = ObstacleMotion.from_config(obstacle)
    assert found is not None
    return found


def world_with(arena_config, **obstacle):
    made = Obstacle(**{"name": "cart", "size": (0.1, 0.1, 0.1), "surface": "plastic"} | obstacle)
    return Arena.from_config(arena_config.model_copy(update={"walls": (), "obstacles": (made,)}))


def towards_the_robot(speed_m_s, seconds):
    return MotionConfig(waypoints=(Waypoint(t_s=seconds, offset=(-speed_m_s * seconds, 0.0)),))


@pytest.fixture
def approaching(arena_config):
    """A box that comes along the x axis towards the origin for 1.5 s."""
    path = towards_the_robot(SPEED_M_S, 1.5)
    return world_with(arena_config, center=(FACE_M + 0.05, 0.0), size=(0.1, 0.6, 0.3), motion=path)


class TestPath:
    def test_once_is_linear_between_waypoints_and_stays_at_the_last(self):
        found = motion((2.0, (0.4, 0.0), 90.0), (4.0, (0.4, -1.0), 90.0), yaw_deg=10.0)
        poses = found.poses_at(np.array([0.0, 0.5, 2.0, 3.0, 4.0, 100.0]))
        expected = [
            (1.0, 2.0, 10.0),
            (1.1, 2.0, 32.5),
            (1.4, 2.0, 100.0),
            (1.4, 1.5, 100.0),
            (1.4, 1.0, 100.0),
            (1.4, 1.0, 100.0),
        ]
        np.testing.assert_allclose(poses, [(x, y, math.radians(yaw)) for x, y, yaw in expected], atol=1e-12)

    def test_back_and_forth_returns_the_same_way_and_so_on(self):
        found = motion((1.0, (0.2, 0.0), 0.0), (3.0, (0.2, 0.4), 0.0), repeat="back_and_forth")
        # One period is 6 s: 0.2 along x in 1 s, 0.4 along y in 2 s, and the same back.
        times = np.array([0.5, 2.0, 3.0, 4.0, 5.5, 6.0, 6.5, 62.0])
        expected = [(1.1, 2.0), (1.2, 2.2), (1.2, 2.4), (1.2, 2.2), (1.1, 2.0), (1.0, 2.0), (1.1, 2.0), (1.2, 2.2)]
        np.testing.assert_allclose(found.poses_at(times)[:, :2], expected, atol=1e-12)

    def test_a_loop_begins_again_and_may_have_turned_round(self):
        found = motion((1.0, (0.2, 0.0), 180.0), (2.0, (0.0, 0.0), 360.0), repeat="loop")
        poses = found.poses_at(np.array([1.5, 2.0, 2.5, 7.5]))
        np.testing.assert_allclose(poses[:, 0], [1.1, 1.0, 1.1, 1.1], atol=1e-12)
        expected = np.radians([270.0, 0.0, 90.0, 270.0])
        np.testing.assert_allclose(np.exp(1j * poses[:, 2]), np.exp(1j * expected), atol=1e-12)

    @pytest.mark.parametrize("repeat", ["once", "loop", "back_and_forth"])
    def test_the_rates_are_the_change_of_the_pose(self, repeat):
        found = motion((0.7, (0.3, 0.1), 40.0), (1.0, (0.3, 0.1), 40.0), (2.0, (0.0, 0.0), 0.0), repeat=repeat)
        t_s = np.arange(0.005, 7.0, 0.01)  # the half step keeps every corner of the path out of the difference
        changes = (found.poses_at(t_s + 1e-6) - found.poses_at(t_s)) / 1e-6
        np.testing.assert_allclose(found.rates_at(t_s), changes, atol=1e-8)

    def test_a_corner_has_the_rate_of_what_follows(self):
        found = motion((1.0, (0.5, 0.0), 0.0), repeat="back_and_forth")
        np.testing.assert_allclose(found.rates_at(np.array([0.0, 1.0, 2.0]))[:, 0], [0.5, -0.5, 0.5])


class TestRays:
    def test_a_ray_meets_the_face_where_it_is_at_that_time(self, approaching):
        scene = RayScene(approaching)
        origin, end = np.array([[0.0, 0.0, 0.05]]), np.array([[1.0, 0.0, 0.05]])
        for time_s in (0.0, 0.4, 1.2, 0.4, 99.0):
            hits = scene.cast(origin, end, time_s)
            assert hits.fraction[0] == pytest.approx(FACE_M - SPEED_M_S * min(time_s, 1.5))
            assert hits.surface[0] == 1

    def test_the_face_turns_with_the_box(self, arena_config):
        turning = MotionConfig(waypoints=(Waypoint(t_s=1.0, turn_deg=90.0),))
        scene = RayScene(world_with(arena_config, center=(0.5, 0.0), motion=turning))
        hits = scene.cast(np.array([[0.0, 0.01, 0.05]]), np.array([[1.0, 0.01, 0.05]]), 0.5)
        # At 45 degrees a corner points at the origin, half a diagonal before the middle; the ray is 10 mm beside it.
        assert hits.fraction[0] == pytest.approx(0.5 - 0.05 * math.sqrt(2) + 0.01)
        np.testing.assert_allclose(hits.normal[0], [-math.sqrt(0.5), math.sqrt(0.5), 0.0], atol=1e-12)


def front_range_m(world, tof):
    reading, status = tof.sample(world)[0]
    assert status == TofStatus.VALID
    return reading


class TestStandingRobot:
    """The range falls as d(t) = d0 - v t from the sensor to the near face."""

    TIMES_S = (0.0, 0.033, 0.5, 1.0, 1.32)

    @pytest.fixture
    def tof(self, robot, approaching):
        exact = {"error_scale": 0.0, "noise_scale": 0.0, "quantisation_m": 0.0}
        return TofArray(robot.tof.model_copy(update=exact), approaching, 1000, np.random.default_rng(0))

    def expected_m(self, robot, time_s):
        plastic_m = -0.0003  # paper Table 4
        return FACE_M - SPEED_M_S * time_s - robot.tof.mounts.front.x_m + plastic_m

    def test_in_the_engine(self, robot, approaching, tof):
        with BulletSimulation(robot, approaching, (0.0, 0.0, 0.0), Rates()) as world:
            for time_s in self.TIMES_S:
                world.advance(round(time_s * 1000) - world.steps)
                assert front_range_m(world, tof) == pytest.approx(self.expected_m(robot, time_s), abs=2e-4)

    def test_in_the_twin(self, robot, approaching, tof):
        run = KinematicTwin(RobotModel.from_config(robot)).drive(np.zeros((300, 1, 2)), np.zeros((1, 3)))
        world = ReplayedWorld(run, 0, approaching, 1000)
        for time_s in self.TIMES_S:
            world.advance(round(time_s * 1000) - world.steps)
            assert front_range_m(world, tof) == pytest.approx(self.expected_m(robot, time_s), abs=2e-4)


class TestContact:
    def test_a_box_that_runs_into_a_standing_robot_is_touched_when_it_arrives(self, robot, arena_config):
        arrives_s = (FACE_M - 0.5 * robot.chassis.length_m) / 0.5
        arena = world_with(arena_config, center=(FACE_M + 0.05, 0.0), motion=towards_the_robot(0.5, 1.0))
        with BulletSimulation(robot, arena, (0.0, 0.0, 0.0), Rates()) as world:
            world.advance(math.floor(1000 * arrives_s) - 10)
            assert world.touching() == ()
            world.advance(30)
            assert world.touching() == ("cart",)

    def test_the_box_pushes_with_its_own_speed_and_does_not_sink_in(self, robot, arena_config):
        """What placing it without its velocity would not give; a rolling robot takes on the speed of the push."""
        arena = world_with(
            arena_config, center=(-0.3, 0.0), motion=MotionConfig(waypoints=(Waypoint(t_s=2.0, offset=(0.6, 0.0)),))
        )
        with BulletSimulation(robot, arena, (0.0, 0.0, 0.0), Rates()) as world:
            world.set_voltages(0.0, 0.0)
            deepest = 0.0
            for _ in range(1500):
                world.advance(1)
                contacts = pybullet.getContactPoints(bodyA=world._robot, linkIndexA=-1, physicsClientId=world._client)
                deepest = min([deepest, *(contact[8] for contact in contacts)])
            assert world.touching() == ("cart",)
            assert world.twist()[0] == pytest.approx(0.3, rel=0.1)
            assert deepest > -0.0006  # two steps of its way

    def test_how_the_steps_are_cut_up_does_not_matter(self, robot, approaching):
        ends = []
        for cuts in ((1500,), (1, 6, 3, 490, 13, 987)):
            with BulletSimulation(robot, approaching, (0.0, 0.0, 0.0), Rates()) as world:
                world.set_wheel_speeds(4.0, 4.0)
                for steps in cuts:
                    world.advance(steps)
                ends.append((world.pose(), world.twist(), world.touching()))
        assert ends[0] == ends[1]
