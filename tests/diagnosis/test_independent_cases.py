"""The integrators of the independent cases against literal Euler steps of the format's equations."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import t as student_t

from benchmarks.diagnosis.independent_cases.beyond import WORSE
from benchmarks.diagnosis.independent_cases.case import make_cases
from benchmarks.diagnosis.independent_cases.disturbances import Plan, correlated_noise, outlier_masks
from benchmarks.diagnosis.independent_cases.drives import simulation as drive_simulation
from benchmarks.diagnosis.independent_cases.drives import wheels as drive_wheels
from benchmarks.diagnosis.independent_cases.drives.drive_log import DriveSetting
from benchmarks.diagnosis.independent_cases.motors.motor import Motor
from benchmarks.diagnosis.independent_cases.motors.motor_law import Lanes, coasting_current, plain_law
from benchmarks.diagnosis.independent_cases.motors.motor_steady import SteadySetting
from benchmarks.diagnosis.independent_cases.motors.motor_step import StepSetting
from benchmarks.diagnosis.independent_cases.motors.step_integrator import DT_S, filtered
from benchmarks.diagnosis.independent_cases.motors.wheel_step import moved
from benchmarks.diagnosis.independent_cases.ranges.tof_bench import RangeSetting
from benchmarks.diagnosis.independent_cases.recipes import Effect, Variant

R, K, B, TC, J, U = 3.0, 0.3, 0.002, 0.02, 0.003, 7.4
VALUES = {"R": R, "K": K, "B": B, "Tc": TC, "J": J}
MOTOR = Motor({key: (value, 0.01 * value) for key, value in VALUES.items()}, U)
# Effects, and the numbers of the equations below that they change.
EFFECTS = [
    (None, {}, {}),
    ("stribeck_friction", {"extra_torque_N_m": 0.02, "stribeck_speed_rad_s": 0.8}, {"extra": 0.02}),
    ("friction_asymmetry", {"asymmetry": 0.3}, {"asymmetry": 0.3}),
    ("bridge_voltage_drop", {"drop_V": 0.4}, {"drop": 0.4}),
    ("supply_sag", {"source_resistance_ohm": 1.5}, {"source": 1.5}),
    ("quadratic_drag", {"coefficient_N_m_s2_rad2": 1e-4}, {"drag": 1e-4}),
    ("current_limit", {"limit_A": 0.8}, {"limit": 0.8}),
    ("torque_ripple", {"amplitude_N_m": 0.01, "cycles_per_turn": 6.0, "phase_rad": 1.0}, {"ripple": 0.01}),
    ("input_delay", {"delay_s": 0.0123}, {"delay": 0.0123}),
    ("actuator_lag", {"time_constant_s": 0.011}, {"lag": 0.011}),
]
VARIANTS = [Variant((Effect(name, p),) if name else ()) for name, p, _ in EFFECTS]


def numbers(key, absent, count=None):
    return np.array([changed.get(key, absent) for _, _, changed in EFFECTS[:count]])[:, None]


class Euler:
    """Motors (effects, voltages) from rest in Euler steps."""

    def __init__(self, effects, inertia=J):
        self.inertia = inertia
        for key in ("extra", "asymmetry", "drop", "source", "drag", "ripple"):
            setattr(self, key, numbers(key, 0.0, effects))
        self.limit = numbers("limit", np.inf, effects)
        self.w = self.angle = 0.0

    def amps(self, u):
        e = u - K * self.w
        amps = np.sign(e) * np.maximum(np.abs(e) - self.drop, 0) / (R + self.source * (u / U) ** 2)
        return np.clip(amps, -self.limit, self.limit)

    def step(self, u, dt):
        drive = K * self.amps(u) - self.ripple * np.cos(6 * self.angle + 1.0)
        direction = np.where(self.w == 0, np.sign(drive), np.sign(self.w))
        dry = TC * (1 - self.asymmetry * direction) + self.extra * np.exp(-((self.w / 0.8) ** 2))
        after = self.w + (drive - B * self.w - direction * (dry + self.drag * self.w**2)) / self.inertia * dt
        stays = ((self.w == 0) & (np.abs(drive) <= dry)) | (after * self.w < 0)
        self.w = np.where(stays, 0.0, after)
        self.angle = self.angle + self.w * dt


def test_steady_states_are_where_a_motor_from_rest_ends():
    u = np.array([0.15, 0.19, 0.21, 0.3, 0.45, 0.7, 1.5, 4.0, 5.0, -0.3, -2.0, -5.0])
    euler = Euler(6, inertia=J / 5)  # inertia changes only how long it takes
    for _ in range(1500):
        euler.step(u, 3e-4)
    setting = SteadySetting(np.random.default_rng(0))
    setting.motor, setting.individual = MOTOR, VALUES
    amps, speed = setting.predict(VARIANTS[:6], np.arange(12.0), u)
    np.testing.assert_allclose(speed, euler.w, atol=1e-6)
    np.testing.assert_allclose(amps, euler.amps(u), atol=1e-6)
    assert (speed[0] == 0).tolist() == (np.abs(u) < 0.2).tolist()


def step_setting(u):
    setting = StepSetting(np.random.default_rng(0))
    setting.motor, setting.individual, setting.u_V, setting.samples = MOTOR, VALUES, u[None, :], len(u)
    setting.inertia_share, setting.friction_share = 0.6, 0.5
    return setting


def rough_voltage():
    rng = np.random.default_rng(0)
    wave = 3 * np.sin(np.arange(30) * 0.15)
    return np.concatenate([np.zeros(4), np.repeat(rng.uniform(-5, 5, 5), 12), np.zeros(16), wave])


def test_step_trials_follow_euler_steps():
    u, dt = rough_voltage(), 1e-4
    euler, level, speeds = Euler(len(EFFECTS)), 0.0, []
    delay, lag = numbers("delay", 0.0), numbers("lag", 0.0)
    for step in range(len(u) * 50):
        at = np.floor(((step + 0.5) * dt - delay) / 0.005).astype(int)
        now = np.where(at >= 0, u[np.maximum(at, 0)], 0.0)
        level = np.where(lag > 0, level + (now - level) * dt / np.maximum(lag, dt), now)
        euler.step(level, dt)
        if step % 50 == 49:
            speeds.append(euler.w[:, 0])
    _, speed = step_setting(u).predict(VARIANTS, [0])
    difference = np.abs(speed[:, 0] - np.array(speeds).T)
    assert difference.max() < 0.06, difference.max(axis=1)
    changes = np.abs(speed[1:, 0] - speed[0, 0]).max(axis=1)
    assert changes.min() > 0.15, "every effect must show"


@pytest.mark.parametrize("time_constant_s", [1e-4, 3e-4, 2e-3, 2e-2])
def test_a_filter_lags_behind_a_ramp_by_its_time_constant(time_constant_s):
    """A low-pass filter that starts at zero follows a t by a (t - tau (1 - exp(-t / tau)))."""
    steps, a = 5, 100.0
    t = np.arange(40 * steps + 1) * DT_S / steps
    level = filtered(a * t, steps, time_constant_s)
    assert level == pytest.approx(a * (t + time_constant_s * np.expm1(-t / time_constant_s)), abs=1e-9)


def free_step(w, torque, inertia, share, dt):
    if w == 0:
        return 0.0 if abs(torque) <= TC * share else (torque - np.sign(torque) * TC * share) / inertia * dt
    after = w + (torque - (B * w + TC * np.sign(w)) * share) / inertia * dt
    return 0.0 if after * w < 0 else after


def test_backlash_follows_two_bodies_with_inelastic_contact():
    u, gap, dt = rough_voltage(), 0.08, 1e-4
    motor = load = between = 0.0
    contact, speeds = 0, []
    for step in range(len(u) * 50):
        torque = K * (u[step // 50] - K * motor) / R
        m, n = free_step(motor, torque, J * 0.6, 0.5, dt), free_step(load, 0.0, J * 0.4, 0.5, dt)
        if contact and contact * (m - n) >= -1e-15:
            motor = load = free_step(motor, torque, J, 1.0, dt)
        else:
            motor, load, contact = m, n, 0
            between += dt * (m - n)
            if abs(between) >= gap / 2 and (m - n) * between > 0:
                contact = np.sign(between)
                between, motor = contact * gap / 2, 0.6 * m + 0.4 * n
                load = motor
        if step % 50 == 49:
            speeds.append(motor)
    _, speed = step_setting(u).predict([Variant((Effect("gear_backlash", {"gap_rad": gap}),)), Variant()], [0])
    difference, effect = speed[0, 0] - np.array(speeds), speed[0, 0] - speed[1, 0]
    assert np.sqrt(np.mean(difference**2)) < 0.03 * np.sqrt(np.mean(effect**2))


@pytest.mark.parametrize("volts", [-3.0, -1.0, -0.25, 0.0, 0.1])
def test_a_wheel_that_reverses_or_stops_within_a_step_turns_as_in_euler_steps(volts):
    lanes, h, count = Lanes.stack([plain_law(VALUES, U)]).column(0), 0.03, 2_000
    euler, turned = Euler(1), 0.0
    euler.w = start = np.array([[0.3]])
    for _ in range(count):
        before = euler.w
        euler.step(np.array([[volts]]), h / count)
        turned += 0.5 * float((before + euler.w).item()) * h / count
    after, mean = moved(lanes, np.array([volts]), start[0], np.zeros(1), h=h)
    assert after == pytest.approx(euler.w[0], abs=4e-3)
    assert h * mean == pytest.approx(turned, abs=4e-5)


@pytest.mark.parametrize(("inductance", "frequency", "diode"), [(0.0005, 2000.0, 1.0), (0.003, 800.0, 0.5)])
def test_a_coasting_bridge_gives_the_mean_current_of_switching_periods(inductance, frequency, diode):
    u, w = np.array([1.0, 3.0, 6.0, 6.0, -5.0, 7.4]), np.array([0.0, 5.0, 10.0, -4.0, 3.0, 20.0])
    duty, direction, steps = np.abs(u) / U, np.sign(u), 800
    amps = total = np.zeros(len(u))
    for _ in range(int(8 * inductance / R * frequency) + 4):
        total = np.zeros(len(u))
        for k in range(steps):
            v = np.where((k + 0.5) / steps < duty, U, -(U + diode))
            amps = np.maximum(0.0, amps + (v - R * amps - K * direction * w) / inductance / frequency / steps)
            total = total + amps / steps
    law = plain_law(VALUES, U)
    law.L, law.diode, law.switching, law.coast = inductance, diode, frequency, 1.0
    mean = coasting_current(Lanes.stack([law]).column(0), u, w)
    np.testing.assert_allclose(mean, direction * total, atol=5e-3)


WHEEL_EFFECTS = [
    Variant(),
    Variant((Effect("supply_sag", {"source_resistance_ohm": 1.2}),)),
    Variant((Effect("input_delay", {"delay_s": 0.033}),)),
    Variant((Effect("battery_decline", {"fraction_per_minute": 10.0}),)),
    Variant((Effect("torque_constant_mismatch", {"mismatch": 0.2}),)),
]


def test_wheels_on_one_supply_follow_euler_steps():
    rows, dt = 8, 2e-4
    u = np.repeat(np.random.default_rng(2).uniform(-6, 6, (rows // 4, 2)), 4, axis=0)
    k = np.array([[K, K]] * 4 + [[K * 1.1, K * 0.9]])
    source, decline = np.array([[0], [1.2], [0], [0], [0]]), np.array([[0], [0], [0], [10.0], [0]])
    w, turned, mean = np.zeros((5, 2)), np.zeros((5, 2)), []
    for step in range(rows * 250):
        at = np.floor(((step + 0.5) * dt - np.array([0, 0, 0.033, 0, 0])) / 0.05).astype(int)
        volts = np.where(at[:, None] >= 0, u[np.maximum(at, 0)], 0.0) * (1 - decline * (step // 250) * 0.05 / 60)
        factor = np.ones((5, 1))
        for _ in range(12):
            load = (np.abs(volts) / U * np.abs(volts * factor - k * w) / R).sum(axis=1, keepdims=True)
            factor = 0.5 * factor + 0.5 * (1 - source * load / U)
        torque = k * (volts * factor - k * w) / R
        direction = np.where(w == 0, np.sign(torque), np.sign(w))
        after = w + (torque - B * w - direction * TC) / J * dt
        w = np.where(((w == 0) & (np.abs(torque) <= TC)) | (after * w < 0), 0.0, after)
        turned = turned + w * dt
        if step % 250 == 249:
            mean.append(turned / 0.05)
            turned = np.zeros((5, 2))
    setting = DriveSetting(np.random.default_rng(0))
    setting.robot = replace(setting.robot, motor=MOTOR)
    setting.individual, setting.session_s = VALUES, np.arange(rows + 1)[None, :] * 0.05
    speeds = drive_wheels.run(setting, WHEEL_EFFECTS, [0], u[None], np.zeros((1, rows + 1, 3)))[:, 0]
    np.testing.assert_allclose(speeds, np.array(mean).transpose(1, 0, 2), atol=0.06)
    assert (np.abs(speeds[1:] - speeds[0]).max(axis=(1, 2)) > 0.3).all(), "every effect must show"


def test_noise_with_heavy_tails_has_unit_variance_and_the_tails_of_student_s_t():
    noise = correlated_noise(np.random.default_rng(1), (200_000,), 0.0, 5)
    beyond = 2 * student_t.sf(4 * np.sqrt(5 / 3), 5)
    assert np.var(noise) == pytest.approx(1.0, rel=0.05)
    assert np.mean(np.abs(noise) > 4) == pytest.approx(beyond, rel=0.1)


@pytest.mark.parametrize("kind", ["motor_steady", "tof_bench"])
def test_a_disturbance_beyond_the_usual_ones_is_in_every_case(kind):
    def plans(name):
        drawn = (truth for _, _, truth in make_cases(kind, 6, 3, WORSE[name]))
        # Beside a hidden effect of the noise, the noise is as stated.
        of_noise = RangeSetting.IN_NOISE
        return [t["disturbances"] for t in drawn if not any(each["name"] in of_noise for each in t["effects"])]

    assert all(0.3 <= plan["lag1"] <= 0.6 for plan in plans("correlation"))
    assert all(plan["tail_degrees"] in {3, 4, 5} for plan in plans("tails"))
    assert all(0.08 <= share <= 0.15 for plan in plans("outliers") for share in plan["outlier_share"].values())
    factors = np.array([list(plan["noise_factor"].values()) for plan in plans("noise")])
    assert len(factors) >= 4
    assert np.all((np.abs(np.log(factors)) >= np.log(2.49)) & (np.abs(np.log(factors)) <= np.log(4.01)))


def test_a_large_share_of_outliers_is_that_of_the_rows():
    plan = Plan({"x": 1.0}, {"x": 0.1}, "runs", outliers_together=False, lag1=0.0, dropout_share=0.0)
    for seed in range(20):
        masks = outlier_masks(np.random.default_rng(seed), 40, ["x"], plan)
        assert masks["x"].sum() == 4


def test_a_delayed_voltage_of_a_drive_acts_from_its_moment_on():
    """From rest, the angle is w (t - T (1 - exp(-t / T))) at t since the voltage acts; a mean over 10 ms is a lag."""
    setting = DriveSetting(np.random.default_rng(0))
    delay_s, volts, rows = 0.0032, 6.0, 2
    setting.robot = replace(setting.robot, motor=MOTOR)
    setting.individual |= VALUES
    body = drive_simulation._Body(setting, Variant((Effect("input_delay", {"delay_s": delay_s}),)))
    u = np.full((len(setting.session_s), rows, 2), volts)
    for step in range(rows * drive_wheels.SUB):
        body.step(u, *divmod(step, drive_wheels.SUB), np.zeros(u[:, 0].size), np.zeros_like(u[:, 0]))
    damping = K * K / R + B
    speed, tau_s = (K * volts / R - TC) / damping, J / damping
    since_s = rows * drive_wheels.ROW_S - delay_s
    turned = speed * (since_s - tau_s * (1.0 - np.exp(-since_s / tau_s)))
    np.testing.assert_allclose(body.angle, turned, rtol=1e-9)
