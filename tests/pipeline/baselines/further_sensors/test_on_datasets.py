"""The methods with further sensors on real drives and on a release."""

from dataclasses import replace

import numpy as np
import pytest

from configs.draw import draw_run
from configs.effects.robot_effects import RobotEffects
from configs.loader import load_scenario
from pipeline.baselines import METHODS, odometry
from pipeline.baselines.compare import why_not
from pipeline.baselines.further_sensors import gyro_ekf, lidar_matching, stereo_matching
from pipeline.baselines.runs import LoggedRun, open_runs
from pipeline.stages.simulate import simulate
from symolo.core.random_streams import stream
from symolo.evaluation.errors import errors_of

EXACT = np.array([0.001, 0.001, 0.002])
HALF_LOST = np.array([0.02, 0.02, np.radians(2)])
WITH_SENSORS = (gyro_ekf, lidar_matching)


@pytest.fixture(scope="module")
def driven_with_sensors():
    """Five seconds of a worn robot with an IMU and a lidar."""
    sensors = ["robot.sensors.imu={period_s: 0.01}", "robot.sensors.lidar={z_m: 0.1, rays: 90, ray_step_deg: 4}"]
    scenario = load_scenario("symolo", ["robot=worn", *sensors, "stop={lap: false, time_limit_s: 5}"])
    spec = draw_run(scenario, "CCW", 1)
    return LoggedRun.of_recording(spec.key, spec, simulate(spec).recording)


def estimate_of(run, method, start_sd=HALF_LOST):
    return method.METHOD.estimate(run.knowledge(start_sd, stream(1, run.name, "start")), (), stream(3))


def errors(run, method, start_sd):
    return errors_of(estimate_of(run, method, start_sd), run.rows.t_ms / 1000, run.truth)


def test_the_gyroscope_reads_turns_that_the_worn_wheels_do_not_make(driven_with_sensors):
    with_gyroscope, by_wheels = (errors(driven_with_sensors, method, EXACT) for method in (gyro_ekf, odometry))
    assert with_gyroscope.rpe_per_s_rad < 0.4 * by_wheels.rpe_per_s_rad
    assert with_gyroscope.ate_rad < 0.5 * by_wheels.ate_rad


def test_the_lidar_corrects_a_wrong_start(driven_with_sensors):
    with_lidar, by_wheels = (errors(driven_with_sensors, method, HALF_LOST) for method in (lidar_matching, odometry))
    assert with_lidar.ate_m < 0.2 * by_wheels.ate_m
    assert with_lidar.ate_rad < 0.5 * by_wheels.ate_rad


def test_methods_know_neither_the_truth_nor_what_is_hidden_in_the_robot(driven_with_sensors):
    run = driven_with_sensors
    robot = run.spec.robot.model_copy(update={"effects": RobotEffects()})
    other = replace(run, spec=run.spec.model_copy(update={"robot": robot, "seed": 99}))
    for method in WITH_SENSORS:
        first, second = estimate_of(run, method), estimate_of(other, method)
        assert first.pose.tobytes() == second.pose.tobytes()
        assert first.covariance.tobytes() == second.covariance.tobytes()


def test_a_release_with_all_sensors_is_localised_by_all_of_them(sensing_release):
    runs = open_runs(sensing_release)
    (run,) = runs
    assert run.further.imu
    assert run.further.lidar
    assert run.further.stereo
    for method in (*WITH_SENSORS, stereo_matching):
        assert not why_not(method.METHOD, runs)
        estimate = estimate_of(run, method)
        assert len(estimate.pose) == len(run.truth)
        assert np.linalg.eigvalsh(estimate.covariance).min() > 0.0


def test_a_release_without_the_sensors_leaves_the_methods_out_with_a_sentence(symolo, dataset, tmp_path):
    runs = open_runs(dataset)
    missing = {method.name: why_not(method, runs) for method in METHODS}
    assert "no IMU" in missing["ekf_imu"]
    assert "no lidar" in missing["lidar"]
    assert "stereo pair" in missing["stereo"]
    assert not any(missing[name] for name in ("odometry", "ekf", "particles", "retrieval"))
    ended = symolo("baselines", dataset, "--out", tmp_path / "out", "--methods", "lidar")
    assert ended.code == 2
    assert "--methods lidar: the robot has no lidar" in ended.err
