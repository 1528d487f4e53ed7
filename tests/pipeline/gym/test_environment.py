"""The Gymnasium environment is the simulation: same readings, same poses, and rewards that follow from them."""

import subprocess
import sys
import warnings
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from configs.draw import draw_run
from configs.loader import load_scenario
from physics.control.base import Twist
from physics.run.controller_runner import DriveKinematics
from pipeline.gym.environment import DriveEnvironment
from pipeline.gym.reward import Outcome, Reward
from pipeline.gym.track import DrivingTrack
from pipeline.stages.simulate import simulate
from symolo.arena.geometry import Arena
from symolo.core.errors import InputError

EXAMPLE = Path(__file__).parents[3] / "examples/gym_agents.py"
ACTION = np.array([0.125, 0.25], dtype=np.float32)
"""Numbers without rounding in 32 bits, so that the same twist can be given to `simulate`."""
TWO_SECONDS = ("stop.lap=false", "stop.time_limit_s=2")


class Constant:
    def __init__(self, spec):
        self._decision = DriveKinematics(spec.robot).decision(Twist(*ACTION.tolist()))

    def decide(self, _seen):
        return self._decision


@pytest.fixture(scope="module")
def environment():
    made = gymnasium.make(
        "pipeline.gym:symolo/Drive-v0", scenario="smoke", settings=TWO_SECONDS, render_mode="rgb_array"
    )
    yield made.unwrapped
    made.close()


def test_gymnasium_finds_no_fault(environment):
    with warnings.catch_warnings():
        # It recommends actions from -1 to 1, and limits for all readings, such as those of odometry.
        warnings.filterwarnings("ignore", message=".*(normalized space|-infinity|is infinity).*")
        check_env(environment)


def test_an_episode_has_the_poses_and_readings_of_a_simulated_run(environment):
    readings, info = environment.reset(seed=5)
    poses, lines, ranges, over = [info["pose"]], [readings["line"]], [readings["ranges"]], False
    while not over:
        readings, _, terminated, truncated, info = environment.step(ACTION)
        poses.append(info["pose"])
        lines.append(readings["line"])
        ranges.append(readings["ranges"])
        over = terminated or truncated
    spec = draw_run(load_scenario("smoke", [*TWO_SECONDS, "seed=5"]), "CW", 1)
    recording = simulate(spec, runner=Constant(spec)).recording
    np.testing.assert_array_equal(poses, recording.trajectory.pose)
    np.testing.assert_array_equal(lines, recording["line"].values.astype(np.float32))
    np.testing.assert_array_equal(ranges, recording["tof_m"].values.astype(np.float32))
    assert truncated
    assert not terminated


def test_each_episode_draws_again_and_a_seed_begins_again():
    environment = DriveEnvironment("smoke", ["routes.0.start.x_m={uniform: [0.5, 0.6]}"])
    starts = [environment.reset(seed=7)[1]["pose"], *(environment.reset()[1]["pose"] for _ in range(2))]
    assert len(set(starts)) == 3
    assert environment.reset(seed=7)[1]["pose"] == starts[0]
    assert environment.reset()[1]["pose"] == starts[1]
    environment.close()


def test_the_reward_is_the_distance_along_the_line(environment):
    start = np.array(environment.reset(seed=1)[1]["pose"])
    rewards = [environment.step(np.array([0.2, 0.0]))[1] for _ in range(20)]
    driven_m = float(np.hypot(*(np.array(environment._pose) - start)[:2]))
    # The run begins on a straight of the line, in its direction.
    assert sum(rewards) == pytest.approx(driven_m, abs=1e-4) == pytest.approx(0.19, abs=0.01)
    turned = np.array(environment._pose)
    back = [environment.step(np.array([-0.2, 0.0]))[1] for _ in range(20)]
    returned_m = float(np.hypot(*(np.array(environment._pose) - turned)[:2]))
    assert sum(back) == pytest.approx(-returned_m, abs=2e-3)
    assert returned_m > 0.8 * driven_m


def test_a_contact_ends_the_episode():
    environment = DriveEnvironment("smoke", ["stop.time_limit_s=6"], route="CCW")
    environment.reset(seed=1)
    for _ in range(120):
        _, reward, terminated, truncated, info = environment.step(np.array([0.25, 0.0]))
        if terminated:
            break
    environment.close()
    assert info["touched"] == ("O2",)
    assert not truncated
    assert reward == pytest.approx(-1.0, abs=0.05)


def test_weights_add_up():
    outcome = Outcome((0.0, 0.0, 0.0), (0.0, 0.0), 0.5, 0.1, ("wall",), lap_closed=True, duration_s=0.05)
    reward = Reward(per_metre=2.0, per_second=-1.0, per_metre_off_track=-4.0, touch=-3.0, lap=5.0)
    assert reward(outcome) == pytest.approx(2.0 * 0.5 - 0.05 - 0.05 * 4.0 * 0.1 - 3.0 + 5.0)


def test_voltages_are_actions_within_the_limit_of_the_driver():
    environment = DriveEnvironment("smoke", TWO_SECONDS, action="voltages", reward=lambda outcome: outcome.twist[0])
    assert environment.action_space.high.tolist() == [6.0, 6.0]
    environment.reset(seed=1)
    speeds = [environment.step(np.array([3.0, 3.0]))[1] for _ in range(10)]
    assert speeds[-1] > 0.15
    with pytest.raises(InputError, match="two finite numbers"):
        environment.step(np.array([1.0, np.nan]))
    environment.close()


def test_the_track_leads_once_around_the_arena_in_the_direction_of_the_start():
    for route, turn in (("CW", -1), ("CCW", 1)):
        spec = draw_run(load_scenario("smoke"), route, 1)
        track = DrivingTrack.from_spec(spec, Arena.from_config(spec.arena))
        place = track.nearest(0.55, 0.0)
        assert place.distance_m == pytest.approx(0.0, abs=1e-9)
        assert place.along == pytest.approx((0.0, turn), abs=1e-6)
        # The arc about (0.30, 0.50) with a radius of 0.25 m, at 45 degrees.
        x, y = 0.30 + 0.30 * np.cos(np.pi / 4), 0.50 + 0.30 * np.sin(np.pi / 4)
        place = track.nearest(float(x), float(y))
        assert place.distance_m == pytest.approx(0.05, abs=1e-9)
        assert place.along == pytest.approx((-turn * np.sqrt(0.5), turn * np.sqrt(0.5)), abs=1e-4)


def test_the_image_shows_the_robot_where_it_is(environment):
    environment.reset(seed=1)
    image = environment.render()
    blue = (image == (40, 90, 180)).all(axis=-1)
    rows, columns = np.nonzero(blue)
    # 0.18 x 0.17 m in an image whose 480 px are the height of the arena with its margin, 2.36 m.
    assert blue.sum() * (2.36 / 480) ** 2 == pytest.approx(0.18 * 0.17, rel=0.1)
    assert 370 < columns.mean() < 400
    assert 220 < rows.mean() < 300


def test_the_example_drives_both_agents():
    command = [sys.executable, str(EXAMPLE), "--steps", "40"]
    ended = subprocess.run(command, capture_output=True, text=True, check=True, timeout=300)
    lines = ended.stdout.strip().splitlines()
    assert [line.split(":")[0] for line in lines if "Agent" in line] == ["RandomAgent", "LineAgent"]
    assert "0.3" in lines[-1].split("steps,")[1]
