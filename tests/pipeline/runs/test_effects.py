"""Effects through the simulate stage: what they change in a recording, and what stays the truth."""

import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.stages.simulate import simulate


@pytest.fixture(scope="module")
def recorded():
    def run(*settings):
        loaded = load_scenario(
            "smoke", ["stop.time_limit_s=1.5", *(f"robot.effects.{setting}" for setting in settings)]
        )
        return simulate(draw_run(loaded, "CW", 1)).recording

    return run


@pytest.fixture(scope="module")
def bare(recorded):
    return recorded()


def test_a_pose_log_is_there_with_a_effect_of_it_alone(recorded, bare):
    assert "pose_log" not in [series.name for series in bare.series]
    logged = recorded("marker_offset.offset_m=0.03", "pose_time_offset.delay_s=0.1")
    np.testing.assert_array_equal(logged.trajectory.pose, bare.trajectory.pose)
    yaw = bare.trajectory.pose[:, 2]
    ahead = bare.trajectory.pose + 0.03 * np.stack([np.cos(yaw), np.sin(yaw), np.zeros_like(yaw)], axis=1)
    np.testing.assert_allclose(logged["pose_log"].values[2:], ahead[:-2], atol=1e-12)


def test_instruments_change_what_is_recorded_and_not_what_happens(recorded, bare):
    recording = recorded("current_sensor_gain.gain=1.2", "current_sensor_offset.offset_A=0.05", "speed_scale.scale=0.9")
    np.testing.assert_array_equal(recording.trajectory.pose, bare.trajectory.pose)
    amperes = bare["current_A"].values
    np.testing.assert_allclose(recording["current_A"].values, 1.2 * amperes + 0.05)
    np.testing.assert_allclose(recording["wheel_speed_rad_s"].values, 0.9 * bare["wheel_speed_rad_s"].values)


def test_odometry_does_not_know_of_smaller_wheels(recorded):
    recording = recorded("wheel_radius_scale.scale=0.95")
    gone = np.hypot(*np.diff(recording.trajectory.pose[:, :2], axis=0).T).sum()
    believed = np.hypot(*np.diff(recording["odometry"].values[:, :2], axis=0).T).sum()
    assert gone == pytest.approx(0.95 * believed, rel=5e-3)
