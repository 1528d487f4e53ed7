"""Predictions of the motor's stages against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.effects.base import Setup
from configs.effects.registry import EFFECTS
from configs.loader import load_section
from diagnosis.measured.case_files.nominal import NominalSteady, NominalStep
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.nominal_robot import nominal_robot
from diagnosis.predictors import STAGES
from physics.effects.driver_and_battery.input_delay import InputDelay
from physics.effects.motor_and_gearbox.friction_warmup import FrictionWarmup
from physics.effects.motor_and_gearbox.gear_backlash import GearBacklash
from physics.effects.motor_and_gearbox.stribeck_friction import StribeckFriction
from physics.effects.motor_and_gearbox.torque_constant_mismatch import TorqueConstantMismatch
from sensors.effects.motor_bench.current_sensor_gain import CurrentSensorGain
from sensors.effects.motor_bench.speed_time_offset import SpeedTimeOffset
from symolo.core.errors import InputError
from symolo.core.tables.time_series import TimeSeries

ALL_EFFECTS = EFFECTS.classes()
ROWS_S = 0.005 * np.arange(1, 201)
R, K, B, TC, J = 3.0, 0.3, 0.002, 0.02, 0.003
DAMPING = K * K / R + B
TAU_S = J / DAMPING


def spread(value):
    return {"value": value, "tolerance": 0.01 * value}


STEADY_MOTOR = {
    "winding_resistance_ohm": spread(R),
    "torque_constant_N_m_A": spread(K),
    "viscous_friction_N_m_s_rad": spread(B),
    "coulomb_friction_N_m": spread(TC),
    "supply_voltage_V": 7.4,
}
MOTOR = {
    **STEADY_MOTOR,
    "rotor_inertia_kg_m2": spread(J),
    "motor_side_inertia_fraction": 0.6,
    "motor_side_friction_fraction": 0.5,
}


@pytest.fixture(scope="module")
def base_robot():
    return draw_robot(load_section("robot", "nominal"), 1, "test")[0]


@pytest.fixture(scope="module")
def robot(base_robot):
    noise = {"current_A": 0.01, "omega_rad_s": 0.1, "lag1_correlation": 0.3}
    case = {"kind": "motor_step", "motor": MOTOR, "sample_rate_Hz": 200, "noise": noise}
    return nominal_robot(NominalStep.model_validate(case), base_robot)


def trial(name, t_s, voltage, begins_s=0.0, *, is_timed=True, reads=0.0):
    """Rows whose instruments read a number; a steady motor that reads 0 rad/s stands still."""
    t_s = np.array(t_s, dtype=float)
    channels = [Channel.logged(TimeSeries("u_cmd_V", "V", t_s, np.array(voltage, dtype=float)), Role.INPUT)]
    channels += [
        Channel.logged(TimeSeries(name, unit, t_s, np.full(len(t_s), reads)), Role.READING)
        for name, unit in (("current_A", "A"), ("omega_rad_s", "rad/s"))
    ]
    return Trial(name, t_s, np.zeros(len(t_s), dtype=bool), tuple(channels), begins_s=begins_s, is_timed=is_timed)


def bound(kind, robot, *trials, nominal=None):
    (stage,) = STAGES[kind](Measurement("case", kind, MeasurementSource("made here", ()), trials, nominal), robot)
    return stage


def predict(kind, robot, *trials, nominal=None):
    """By trial, the predicted values of each quantity."""
    stage = bound(kind, robot, *trials, nominal=nominal)
    predicted = stage.predict([robot])
    return [
        {of.name: p.mean[0][of.trial == k] for of, p in zip(stage.observed, predicted, strict=True)}
        for k in range(len(trials))
    ]


def test_a_settled_motor_balances_its_torques(base_robot):
    case = {"kind": "motor_steady", "motor": STEADY_MOTOR, "noise": {"current_A": 0.001, "omega_rad_s": 0.04}}
    robot = nominal_robot(NominalSteady.model_validate(case), base_robot)
    (predicted,) = predict(
        CaseKind.MOTOR_STEADY, robot, trial("1", range(5), [0.0, 0.19, 2.0, -5.0, math.nan], reads=math.nan)
    )
    speed = [0.0, 0.0, (K * 2.0 / R - TC) / DAMPING, -(K * 5.0 / R - TC) / DAMPING, math.nan]
    current = [(u - K * w) / R for u, w in zip((0.0, 0.19, 2.0, -5.0, math.nan), speed, strict=True)]
    np.testing.assert_allclose(predicted["omega_rad_s"], speed, rtol=1e-9)
    np.testing.assert_allclose(predicted["current_A"], current, rtol=1e-9)


def test_a_bench_without_any_voltage_is_refused_with_what_to_log(base_robot):
    with pytest.raises(
        InputError, match=r"case: no row has a voltage at the motor.*the battery's voltage and the duty"
    ):
        bound(CaseKind.MOTOR_STEADY, base_robot, trial("1", range(3), [math.nan] * 3))


def test_a_sweep_taken_later_has_a_warmer_gear(robot):
    """Friction is 1.5 times its value when switched on and has fallen to 1.5/e above it after 100 s."""
    warm = robot.with_effect(FrictionWarmup(amplitude=0.5, time_constant_s=100.0))
    rows = (trial(name, [t_s], [2.0], reads=15.0) for name, t_s in (("1", 0.0), ("2", 100.0)))
    first, second = predict(CaseKind.MOTOR_STEADY, warm, *rows)
    for predicted, share in ((first, 1.5), (second, 1 + 0.5 / math.e)):
        assert predicted["omega_rad_s"][0] == pytest.approx((K * 2.0 / R - share * TC) / DAMPING)


def test_a_step_from_rest_is_an_exponential(robot):
    t = 0.005 * np.arange(1, 101)
    (predicted,) = predict(CaseKind.MOTOR_STEP, robot, trial("1", t, np.full(100, 3.0)))
    settled = (K * 3.0 / R - TC) / DAMPING
    np.testing.assert_allclose(predicted["omega_rad_s"], settled * (1 - np.exp(-t / TAU_S)), rtol=1e-6)
    np.testing.assert_allclose(predicted["current_A"], (3.0 - K * predicted["omega_rad_s"]) / R, rtol=1e-6)


def test_rows_that_a_log_lacks_do_not_move_the_others(robot):
    t, voltage = 0.005 * np.arange(1, 101), np.repeat([0.0, 4.0, -2.0, 0.0], 25)
    kept = np.ones(100, dtype=bool)
    kept[[7, 8, 40, 99]] = False
    whole, gappy = predict(CaseKind.MOTOR_STEP, robot, trial("1", t, voltage), trial("2", t[kept], voltage[kept], 0.5))
    np.testing.assert_array_equal(gappy["omega_rad_s"], whole["omega_rad_s"][kept])


def test_a_missing_voltage_is_the_one_before(robot):
    t = 0.005 * np.arange(1, 41)
    holed = np.full(40, 3.0)
    holed[10:12] = math.nan
    whole, patched = predict(CaseKind.MOTOR_STEP, robot, trial("1", t, np.full(40, 3.0)), trial("2", t, holed))
    np.testing.assert_array_equal(patched["omega_rad_s"], whole["omega_rad_s"])


@pytest.mark.parametrize("states_rate", [True, False])
@pytest.mark.parametrize(("rate_hz", "decimals"), [(150, 4), (30, 3)])
def test_rounded_times_do_not_drift(robot, rate_hz, decimals, states_rate):
    """6 s at rates whose period is no round number, 3 V and 5 V in turns, against the exponential of each piece."""
    number = np.arange(1, 6 * rate_hz + 1)
    voltage = np.where((number // rate_hz) % 2 == 0, 3.0, 5.0)
    speed, expected = 0.0, []
    for settled in (K * voltage / R - TC) / DAMPING:
        speed = settled + (speed - settled) * math.exp(-1 / (rate_hz * TAU_S))
        expected.append(speed)
    log = trial("1", np.round(number / rate_hz, decimals), voltage)
    noise = {"current_A": 0.01, "omega_rad_s": 0.1, "lag1_correlation": 0.3}
    case = {"kind": "motor_step", "motor": MOTOR, "sample_rate_Hz": rate_hz, "noise": noise}
    nominal = NominalStep.model_validate(case) if states_rate else None
    (predicted,) = predict(CaseKind.MOTOR_STEP, robot, log, nominal=nominal)
    np.testing.assert_allclose(predicted["omega_rad_s"], expected, atol=1e-5 if states_rate else 5e-3)


def test_a_log_whose_clock_is_not_the_stated_one_keeps_its_own(robot):
    """199 Hz where 200 Hz are stated: at the end of 2 s the log is two rows away from the stated grid."""
    t = np.arange(1, 399) / 199
    noise = {"current_A": 0.01, "omega_rad_s": 0.1, "lag1_correlation": 0.3}
    case = {"kind": "motor_step", "motor": MOTOR, "sample_rate_Hz": 200, "noise": noise}
    log = trial("1", t, np.full(398, 3.0))
    (predicted,) = predict(CaseKind.MOTOR_STEP, robot, log, nominal=NominalStep.model_validate(case))
    settled = (K * 3.0 / R - TC) / DAMPING
    np.testing.assert_allclose(predicted["omega_rad_s"], settled * (1 - np.exp(-t / TAU_S)), rtol=1e-6)


def test_a_row_at_time_0_is_the_state_at_rest(robot):
    t = 0.005 * np.arange(0, 101)
    (predicted,) = predict(CaseKind.MOTOR_STEP, robot, trial("1", t, np.full(101, 3.0)))
    settled = (K * 3.0 / R - TC) / DAMPING
    np.testing.assert_allclose(predicted["omega_rad_s"], settled * (1 - np.exp(-t / TAU_S)), rtol=1e-6)
    assert predicted["current_A"][0] == 0.0


def test_two_rows_at_one_sample_are_refused_by_their_times(robot):
    t = 0.005 * np.arange(1, 41)
    t[20] = t[19] + 0.001
    with pytest.raises(InputError, match=r"column t_s: 0\.1 and 0\.101 of trial 1.*same sample.*keep one"):
        predict(CaseKind.MOTOR_STEP, robot, trial("1", t, np.full(40, 3.0)))


def mixed_robots(robot):
    """Robots that differ in numbers, in effects and in choices."""
    stronger = robot.model_copy(update={"motor": robot.motor.model_copy(update={"torque_constant_N_m_A": 1.1 * K})})
    robots = [robot, stronger]
    for effect in ALL_EFFECTS:
        choices = {name: options[0] if options else "wood" for name, options in effect.options().items()}
        robots += [robot.with_effect(effect.start(choices)), stronger.with_effect(effect.start(choices))]
    return robots


@pytest.mark.parametrize("kind", [CaseKind.MOTOR_STEADY, CaseKind.MOTOR_STEP])
def test_many_robots_at_once_are_each_of_them_alone(robot, kind):
    t = 0.005 * np.arange(1, 61)
    logs = trial("1", t, np.repeat([0.0, 4.0, -2.0], 20)), trial("2", t, np.repeat([3.0, 0.0, 1.0], 20), 30.0)
    stage, robots = bound(kind, robot, *logs), mixed_robots(robot)
    together = stage.predict(robots)
    for k, one in enumerate(robots):
        for many, alone in zip(together, stage.predict([one]), strict=True):
            np.testing.assert_allclose(many.mean[k], alone.mean[0], rtol=1e-9, atol=1e-9, err_msg=str(one.effects))


@pytest.mark.parametrize("kind", [CaseKind.MOTOR_STEADY, CaseKind.MOTOR_STEP])
def test_robots_that_only_read_differently_move_as_one(robot, kind):
    t = 0.005 * np.arange(1, 61)
    logs = trial("1", t, np.full(60, 4.0)), trial("2", t, np.full(60, -3.0), 30.0)
    gains = (1.0, 1.1, 0.8)
    current, _ = bound(kind, robot, *logs).predict([robot.with_effect(CurrentSensorGain(gain=gain)) for gain in gains])
    for mean, gain in zip(current.mean, gains, strict=True):
        np.testing.assert_allclose(mean, gain * current.mean[0], rtol=1e-12)


def central_slopes(stage, robots_of, value, step):
    """Derivative of the predicted speeds by a parameter, by two widths of step."""
    slopes = []
    for h in (step, 0.5 * step):
        above, below = (stage.predict([robots_of(value + s)])[1].mean[0] for s in (h, -h))
        slopes.append((above - below) / (2 * h))
    return slopes


@pytest.mark.parametrize("delay_s", [0.0012, 0.0113])
def test_a_delay_is_a_smooth_parameter_with_the_slope_of_the_exponential(robot, delay_s):
    """The speed is w(t - d), whose derivative by d is minus the acceleration."""
    t = 0.005 * np.arange(1, 61)
    stage = bound(CaseKind.MOTOR_STEP, robot, trial("1", t, np.full(60, 3.0)))
    settled = (K * 3.0 / R - TC) / DAMPING
    later = t > delay_s + 0.001
    expected = -settled / TAU_S * np.exp(-(t - delay_s) / TAU_S)
    for slope in central_slopes(stage, lambda d: robot.with_effect(InputDelay(delay_s=d)), delay_s, 1e-4):
        np.testing.assert_allclose(slope[later], expected[later], rtol=1e-3)


def test_a_late_speed_log_is_interpolated_along_the_samples(robot):
    t = 0.005 * np.arange(1, 61)
    stage = bound(CaseKind.MOTOR_STEP, robot, trial("1", t, np.full(60, 3.0)))
    settled = (K * 3.0 / R - TC) / DAMPING
    (_, speed) = stage.predict([robot.with_effect(SpeedTimeOffset(delay_s=0.0083))])
    delayed = np.interp(t - 0.0083, np.append(0.0, t), settled * (1 - np.exp(-np.append(0.0, t) / TAU_S)))
    np.testing.assert_allclose(speed.mean[0], delayed, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    "effect", [StribeckFriction(extra_torque_N_m=0.01, stribeck_speed_rad_s=1.5), GearBacklash(gap_rad=0.08)]
)
def test_rows_of_5_ms_come_to_the_same_as_much_shorter_ones(robot, effect):
    """Through a start, a stop and a reversal, within a tenth of the noise."""
    changed, voltage = robot.with_effect(effect), np.repeat([0.5, 4.0, 0.0, -3.0, 2.0], 30)
    (long,) = predict(CaseKind.MOTOR_STEP, changed, trial("1", 0.005 * np.arange(1, 151), voltage))
    (short,) = predict(CaseKind.MOTOR_STEP, changed, trial("1", 0.0005 * np.arange(1, 1501), np.repeat(voltage, 10)))
    np.testing.assert_allclose(long["omega_rad_s"], short["omega_rad_s"][9::10], atol=0.01)


def test_the_load_lets_a_gearbox_with_play_catch_up(robot):
    """Two masses and a gap by the definition, in explicit steps of 10 microseconds: run-up, brake, reversal."""
    gap, voltage = 0.06, np.repeat([4.0, 0.0, -3.0], 24)
    (predicted,) = predict(
        CaseKind.MOTOR_STEP, robot.with_effect(GearBacklash(gap_rad=gap)), trial("1", ROWS_S[:72], voltage)
    )
    h, side_j, side_f = 1e-5, (0.6 * J, 0.4 * J), 0.5
    motor = load = slack = 0.0
    expected = []
    for u in voltage:
        for _ in range(500):
            torque = K * (u - K * motor) / R
            speeds = []
            for speed, pull, j in ((motor, torque, side_j[0]), (load, 0.0, side_j[1])):
                after = speed + h * (pull - side_f * B * speed) / j
                grip = h * side_f * TC / j
                speeds.append(math.copysign(max(abs(after) - grip, 0.0), after))
            after = slack + h * (speeds[0] - speeds[1])
            if abs(after) >= gap / 2 and (speeds[0] - speeds[1]) * after >= 0.0:
                joint = side_j[0] / J * motor + side_j[1] / J * load
                moved = joint + h * (torque - B * joint) / J
                both = math.copysign(max(abs(moved) - h * TC / J, 0.0), moved)
                speeds, after = [both, both], math.copysign(gap / 2, after)
            (motor, load), slack = speeds, after
        expected.append(motor)
    np.testing.assert_allclose(predicted["omega_rad_s"], expected, atol=0.02)


@pytest.mark.parametrize("kind", [CaseKind.MOTOR_STEADY, CaseKind.MOTOR_STEP])
def test_robots_of_different_effects_in_one_pass_are_each_as_alone(robot, kind):
    effects = [
        *(effect.start() for effect in EFFECTS.classes() if Setup.MOTOR_BENCH in effect.setups),
        TorqueConstantMismatch(mismatch=0.1),
    ]
    robots = [robot, *(robot.with_effect(values) for values in effects)]
    t, voltage = 0.005 * np.arange(1, 121), np.repeat([0.0, 4.0, -3.0, 0.3, 0.0, 6.0], 20)
    measurement = Measurement("m", kind, MeasurementSource("made here", ()), (trial("1", t, voltage),))
    readings = tuple(
        Channel.logged(TimeSeries(name, unit, t, np.zeros(120)), Role.READING)
        for name, unit in (("current_A", "A"), ("omega_rad_s", "rad/s"))
    )
    whole = replace(measurement.trials[0], channels=(*measurement.trials[0].channels, *readings))
    (stage,) = STAGES[kind](replace(measurement, trials=(whole,)), robot)
    together = stage.predict(robots)
    for k, one in enumerate(robots):
        for many, alone in zip(together, stage.predict([one]), strict=True):
            np.testing.assert_allclose(many.mean[k], alone.mean[0], rtol=1e-6, atol=1e-6, err_msg=str(one.effects))


class TestRowsNearBreakaway:
    """The motor starts at TC R / K = 0.2 V; the rows at 0.1 and 0.3 V decide what is known of its friction."""

    VOLTS = (0.0, 0.1, 0.3, 0.3, 2.0)

    def stage(self, robot, speeds):
        row = trial("1", range(len(self.VOLTS)), self.VOLTS)
        channels = [channel for channel in row.channels if channel.name != "omega_rad_s"]
        series = TimeSeries("omega_rad_s", "rad/s", row.t_s, np.array(speeds, dtype=float))
        speed = Channel.logged(series, Role.READING, noise_sd=np.full(len(speeds), 0.1))
        return bound(CaseKind.MOTOR_STEADY, robot, replace(row, channels=(*channels, speed)))

    def test_a_motor_that_stands_still_is_a_reading_of_its_resistance(self, robot):
        stage = self.stage(robot, [0.0, 0.0, 0.0, 1.0, 16.0])
        current, speed = stage.observed
        assert current.usable.all()
        # Without a voltage, a motor that stands still says nothing.
        assert speed.usable.tolist() == [False, True, True, True, True]
        predicted, _ = stage.predict([robot])
        np.testing.assert_allclose(predicted.mean[0, :3], np.array([0.0, 0.1, 0.3]) / R)
        moving = (K * 0.3 / R - TC) / DAMPING
        assert predicted.mean[0, 3] == pytest.approx((0.3 - K * moving) / R)

    def test_whether_it_turns_is_evidence_about_the_friction(self, robot):
        """With the logistic distribution of scale 0.05, -2 log P of standing still at 1.5 times the friction is 20."""
        stage = self.stage(robot, [0.0, 0.0, 0.0, 1.0, 16.0])
        _, speed = stage.predict([robot])
        z = speed.mean[0] / 0.1
        assert z[2] ** 2 == pytest.approx(2.0 * math.log1p(math.exp(0.5 / 0.05)))
        assert z[1] == pytest.approx(0.0, abs=0.01)
        doubled = robot.with_section("motor", {"coulomb_friction_N_m": 2.0 * TC})
        _, with_more = stage.predict([doubled])
        # With twice the friction, the row that stands still is expected, and the one that turns is not.
        assert with_more.mean[0, 2] / 0.1 == pytest.approx(math.sqrt(2.0 * math.log1p(math.exp(-0.25 / 0.05))))
        assert with_more.mean[0, 3] / 0.1 == pytest.approx(-math.sqrt(2.0 * math.log1p(math.exp(0.25 / 0.05))))

    def test_where_nobody_knows_whether_it_turns_the_row_is_not_used(self, robot):
        current, speed = self.stage(robot, [0.0, math.nan, 0.0, 1.0, 16.0]).observed
        assert not current.usable[1]
        assert not speed.usable[1]

    def test_an_instrument_with_noise_at_rest_is_believed_beyond_it(self, robot):
        """No reading is exactly 0: above six standard deviations the motor turns, and below it may do so slowly.

        In both cases the current is (u - K w) / R, and w is known from its reading to 0.1 rad/s.
        """
        stage = self.stage(robot, [0.05, -0.02, 0.45, 1.0, 16.0])
        current, speed = stage.observed
        assert current.usable.all()
        assert speed.usable.tolist() == [False, True, True, True, True]
        np.testing.assert_allclose(stage.predict([robot])[0].mean[0, 1:3], [(0.1 + K * 0.02) / R, (0.3 - K * 0.45) / R])
        np.testing.assert_allclose(current.sd[1:3], np.hypot(current.sd[0], K * 0.1 / R))

    @pytest.mark.parametrize("friction", [0.8, 1.0, 1.3, 1.45])
    def test_a_motor_that_turns_within_the_noise_is_no_surprise(self, robot, friction):
        """At 0.3 V it turns by (0.3 K / R - T) / (K^2 / R + B), or stands still; the more probable one counts.

        -2 log P of standing still is 2 log(1 + exp(s / 0.05)), where s is the torque beyond the friction as its share.
        """
        reading = 0.45
        stage = self.stage(robot, [0.05, -0.02, reading, 1.0, 16.0])
        hard = robot.with_section("motor", {"coulomb_friction_N_m": friction * TC})
        turns = (0.3 * K / R - friction * TC) / DAMPING
        standing = reading**2 / 0.01 + 2.0 * math.log1p(math.exp((1.5 / friction - 1.0) / 0.05))
        z = (reading - stage.predict([hard])[1].mean[0, 2]) / 0.1
        assert z**2 == pytest.approx(min(((reading - turns) / 0.1) ** 2, standing))

    def test_a_speed_against_the_voltage_beyond_the_noise_says_nothing_of_the_current(self, robot):
        current, _ = self.stage(robot, [0.05, -1.0, 0.45, 1.0, 16.0]).observed
        assert current.usable.tolist() == [True, False, True, True, True]

    def test_at_a_voltage_that_turns_a_motor_fast_it_stands_still_within_the_noise(self, robot):
        stage = self.stage(robot, [0.05, 1.0, 1.0, 1.0, 0.05])
        current, _ = stage.observed
        assert current.usable.all()
        assert stage.predict([robot])[0].mean[0, 4] == pytest.approx((2.0 - K * 0.05) / R)

    def test_a_motor_that_turns_within_the_noise_does_not_change_the_resistance(self, robot):
        """At 0.1 V and half the friction the motor just turns, with the current TC / (2 K) and not 0.1 V / R."""
        easy = robot.with_section("motor", {"coulomb_friction_N_m": 0.499 * TC})
        stage = self.stage(robot, [0.05, 0.001, 1.0, 1.0, 16.0])
        assert stage.predict([easy])[0].mean[0, 1] == pytest.approx(0.5 * TC / K, rel=0.01)
        assert stage.observed[0].sd[1] > K * 0.1 / R


def test_errors_of_the_voltage_have_the_responses_of_a_linear_motor(robot):
    """A motor that has settled at u turns by K u / (R D) minus its friction; behind a ramp, it lags by a time constant.

    The responses are differences between 1 % more and 1 % less.
    """
    stage = bound(CaseKind.MOTOR_STEP, robot, trial("1", ROWS_S, np.where(ROWS_S < 0.5025, 4.0, 2.0)))
    current, speed = ([e for e in quantity.input_errors if not e.chosen] for quantity in stage.observed)
    assert [error.covariate for error in speed] == ["u_cmd_V", "u_cmd_V", "session_time_s"]
    at_4_V = 0.02 * 4.0 * K / (R * DAMPING)
    whole, with_trend, drifting = (error.response for error in speed)
    assert whole[[99, 199]] == pytest.approx([at_4_V, 0.5 * at_4_V], rel=0.01)
    assert with_trend[[99, 199]] == pytest.approx([at_4_V, -0.5 * at_4_V], rel=0.03)
    assert drifting[199] == pytest.approx(0.5 * at_4_V * (1.0 - TAU_S), rel=0.02)
    np.testing.assert_allclose(
        current[0].response[[99, 199]], (0.02 * np.array([4.0, 2.0]) - K * whole[[99, 199]]) / R, rtol=0.01
    )
