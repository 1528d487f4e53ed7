"""The inertial sensors: what they feel in motions of closed form, and the Allan deviation of their errors."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from physics.robot.body_motion import BodyMotion, velocity_of_turn
from pipeline.stages.simulate import simulate
from sensors.inertial.imu import Imu, ImuSettings
from sensors.inertial.inertial_errors import ErrorSizes, RandomErrors
from symolo.core.errors import InputError

G = 9.81
NOTHING = ErrorSizes(*[0.0] * 7, range=100.0)
PERFECT = {
    "accelerometer": {
        "noise_density_m_s2_rtHz": 0.0,
        "bias_instability_m_s2": 0.0,
        "random_walk_m_s3_rtHz": 0.0,
        "bias_sd_m_s2": 0.0,
        "bias_per_K_sd_m_s2": 0.0,
        "scale_sd": 0.0,
        "misalignment_sd_rad": 0.0,
    },
    "gyroscope": {
        "noise_density_rad_s_rtHz": 0.0,
        "bias_instability_rad_s": 0.0,
        "random_walk_rad_s2_rtHz": 0.0,
        "bias_sd_rad_s": 0.0,
        "bias_per_K_sd_rad_s": 0.0,
        "scale_sd": 0.0,
        "misalignment_sd_rad": 0.0,
    },
    "bits": 32,
    "warm_up_K": 0.0,
}


@dataclass
class Turntable:
    """A robot that drives round the origin on a circle: speed [m/s], yaw rate [rad/s] and acceleration [m/s^2]."""

    speed_m_s: float
    rate_rad_s: float
    acceleration_m_s2: float = 0.0
    time_s: float = 0.0

    def motion(self):
        yaw = self.rate_rad_s * self.time_s
        speed = self.speed_m_s + self.acceleration_m_s2 * self.time_s
        R_WR = np.array([[np.cos(yaw), -np.sin(yaw), 0.0], [np.sin(yaw), np.cos(yaw), 0.0], [0.0, 0.0, 1.0]])
        return BodyMotion(R_WR, np.zeros(3), speed * R_WR[:, 0], np.array([0.0, 0.0, self.rate_rad_s]))


def felt(world, **settings):
    """Return the second sample of an IMU without errors, 5 ms after the first."""
    imu = Imu(ImuSettings.model_validate({**PERFECT, **settings}), None, 1000, np.random.default_rng(0))
    imu.sample(world)
    return imu.sample(replace(world, time_s=0.005))


def test_at_rest_it_feels_gravity_upwards_and_no_turn():
    np.testing.assert_allclose(felt(Turntable(0.0, 0.0)), [0, 0, G, 0, 0, 0, 25], atol=1e-6)


def test_a_turning_robot_is_pulled_towards_the_middle_of_its_circle():
    # v = 0.3 m/s and w = 2 rad/s: a circle of 0.15 m, whose middle is on the left, and v w = 0.6 m/s^2 towards it.
    np.testing.assert_allclose(felt(Turntable(0.3, 2.0)), [0, 0.6, G, 0, 0, 2, 25], atol=2e-5)


def test_beside_the_axle_the_place_counts():
    # 0.1 m ahead of the axle, a turn on the spot pulls backwards with w^2 r; on the left, it pulls to the right.
    np.testing.assert_allclose(felt(Turntable(0.0, 2.0), x_m=0.1)[:3], [-0.4, 0, G], atol=2e-5)
    np.testing.assert_allclose(felt(Turntable(0.0, 2.0), y_m=0.1)[:3], [0, -0.4, G], atol=2e-5)


def test_the_velocity_of_a_turn_is_the_cross_product_of_numpy_to_the_last_bit():
    turns, arms_m = np.random.default_rng(1).standard_normal((2, 200, 3))
    velocities = [velocity_of_turn(w, arm_m) for w, arm_m in zip(turns, arms_m, strict=True)]
    np.testing.assert_array_equal(velocities, np.cross(turns, arms_m))


def test_its_axes_turn_with_its_mounting():
    driving = Turntable(0.0, 0.0, acceleration_m_s2=1.0)
    np.testing.assert_allclose(felt(driving)[:3], [1, 0, G], atol=1e-6)
    np.testing.assert_allclose(felt(driving, yaw_deg=90)[:3], [0, -1, G], atol=1e-6)
    np.testing.assert_allclose(felt(driving, pitch_up_deg=90)[:3], [G, 0, -1], atol=1e-6)
    np.testing.assert_allclose(felt(driving, roll_deg=90)[:3], [1, G, 0], atol=1e-6)
    np.testing.assert_allclose(felt(Turntable(0.0, 1.0), roll_deg=90)[3:6], [0, 1, 0], atol=2e-6)


def test_readings_stop_at_the_range_and_are_rounded_to_the_steps_of_the_converter():
    assert felt(Turntable(0.0, 6.0))[5] == pytest.approx(np.radians(250), abs=1e-5)
    step = 2 * 19.6133 / 2**8
    reading = felt(Turntable(0.0, 0.0), bits=8)[2]
    assert reading / step == pytest.approx(round(reading / step))
    assert abs(reading - G) <= 0.5 * step


def test_a_range_below_gravity_is_refused():
    with pytest.raises(InputError, match=r"imu\.accelerometer\.range_m_s2: got 9\.0, allowed: more than 9\.8"):
        load_scenario("smoke", ["robot.sensors.imu.accelerometer.range_m_s2=9.0"])


def test_temperature_rises_as_in_a_first_order_warm_up_and_shifts_the_biases():
    world = replace(Turntable(0.0, 0.0), time_s=300.0)
    warm = felt(world, warm_up_K=10.0, warm_up_s=300.0)[6]
    assert warm == pytest.approx(25 + 10 * (1 - np.exp(-0.005 / 300)))
    settings = {**PERFECT, "temperature_C": 45.0, "calibrated_at_C": 25.0}
    settings["gyroscope"] = {**settings["gyroscope"], "bias_per_K_sd_rad_s": 0.01}
    rates = [
        Imu(ImuSettings.model_validate(settings), None, 1000, np.random.default_rng(seed)).sample(Turntable(0, 0))[3:6]
        for seed in range(400)
    ]
    assert np.std(rates) == pytest.approx(20 * 0.01, rel=0.1)


def allan_deviation(values, period_s, tau_s):
    """Return the overlapping Allan deviation of a rate at an averaging time, IEEE Std 952-1997, equation C.6 on."""
    steps = round(tau_s / period_s)
    angle = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(values, axis=0) * period_s])
    second = angle[2 * steps :] - 2 * angle[steps:-steps] + angle[: -2 * steps]
    return np.sqrt(np.mean(second**2) / 2) / tau_s


def errors(period_s, count, **sizes):
    axes = [RandomErrors(replace(NOTHING, **sizes), period_s, np.random.default_rng(seed)) for seed in range(4)]
    return np.hstack([one.block(count) for one in axes])


def test_white_noise_has_the_allan_deviation_of_its_density():
    values = errors(0.005, 20_000, noise_density=0.003)
    for tau_s in (0.01, 0.1, 1.0):
        assert allan_deviation(values, 0.005, tau_s) == pytest.approx(0.003 / np.sqrt(tau_s), rel=0.05)


def test_the_bias_instability_is_the_height_of_a_flat_allan_deviation():
    values = errors(0.25, 100_000, bias_instability=0.02)
    for tau_s in (1.0, 10.0, 100.0, 1000.0):
        assert allan_deviation(values, 0.25, tau_s) == pytest.approx(0.664 * 0.02, rel=0.1)


def test_a_random_walk_of_the_bias_makes_it_grow_with_the_root_of_the_time():
    values = errors(0.01, 20_000, random_walk=0.02)
    for tau_s in (0.1, 1.0, 5.0):
        assert allan_deviation(values, 0.01, tau_s) == pytest.approx(0.02 * np.sqrt(tau_s / 3), rel=0.1)


def test_a_robot_that_drives_has_the_rates_and_accelerations_of_its_log():
    settings = [f"robot.sensors.imu.{part}.{key}=0" for part in ("accelerometer", "gyroscope") for key in PERFECT[part]]
    spec = draw_run(load_scenario("smoke", ["stop.time_limit_s=4", *settings, "robot.sensors.imu.bits=32"]), "CW", 1)
    recording = simulate(spec).recording
    imu, (v, w) = recording["sensor_imu"], recording.trajectory.twist.T
    assert len(imu.t_s) == 801
    # Between two rows of 50 ms the gyroscope adds up to the turn, and the accelerometer to the change of speed.
    turned = np.add.reduceat(imu.values[1:, 5] * 0.005, np.arange(0, 800, 10))
    np.testing.assert_allclose(turned, np.diff(recording.trajectory.pose[:, 2]), atol=1e-5)
    pushed = np.add.reduceat(imu.values[1:, 0] * 0.005, np.arange(0, 800, 10))
    np.testing.assert_allclose(pushed, np.diff(v), atol=2e-3)
    # On its arc it is pulled to the side by v w.
    driving = slice(200, None)
    pulled = imu.values[driving, 1].reshape(-1)[::10]
    np.testing.assert_allclose(pulled, np.interp(imu.t_s[driving][::10], recording.trajectory.t_s, v * w), atol=0.01)
