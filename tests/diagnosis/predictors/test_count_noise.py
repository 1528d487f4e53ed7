"""The noise of speeds from counts, against covariances that are written down term by term, and in a closed loop."""

import numpy as np
import pytest

from diagnosis.inference.evidence.noise_level import torque_noise
from diagnosis.predictors.wheels.count_noise import CountNoise, continued

ROW_S = 0.05
LAG_S = 0.12
KEEP = np.exp(-ROW_S / LAG_S)
PULSE = (1.0 - KEEP) * LAG_S / ROW_S
"""Mean speed in a row that began with speed 1 and has no torque; with a torque for speed 1 instead it is 1 - PULSE."""


def noise_of(rows, rounding, torque, starts=(0,)):
    goes_on = np.ones(rows, dtype=bool)
    goes_on[list(starts)] = False
    stated = float(np.hypot(rounding, torque))
    return CountNoise(np.full(rows, rounding), goes_on, np.ones(rows, dtype=bool), KEEP, stated)


def random_torques(rng, rows, repeats, warm_up=200):
    """Mean speeds (rows, repeats) by torques that are new in each row, each for a steady speed of variance 1."""
    speed, means = np.zeros(repeats), []
    for _ in range(rows + warm_up):
        steady = rng.standard_normal(repeats)
        means.append(PULSE * speed + (1.0 - PULSE) * steady)
        speed = KEEP * speed + (1.0 - KEEP) * steady
    return np.array(means[warm_up:])


def covariance(rows, rounding, torque, trial_rows):
    """Of the sum of rounding and torque, from the speed's variance (1 - KEEP)/(1 + KEEP) at the ends of rows."""
    ends = (1.0 - KEEP) / (1.0 + KEEP)
    variance = PULSE**2 * ends + (1.0 - PULSE) ** 2
    next_to = PULSE * (KEEP * PULSE * ends + (1.0 - KEEP) * (1.0 - PULSE))
    apart = np.abs(np.subtract.outer(np.arange(rows), np.arange(rows)))
    of_torque_alone = np.where(apart == 0, variance, next_to * KEEP ** np.maximum(apart - 1.0, 0.0)) / variance
    of_rounding = np.where(apart == 0, 1.0, np.where(apart == 1, -0.5, 0.0))
    trial = np.arange(rows) // trial_rows
    return (torque**2 * of_torque_alone + rounding**2 * of_rounding) * np.equal.outer(trial, trial)


@pytest.mark.parametrize(("rounding", "torque"), [(1.0, 0.2), (1.0, 1.0), (0.1, 1.0)])
def test_innovations_by_the_whole_covariance(rounding, torque):
    noise = noise_of(60, rounding, torque, starts=(0, 20, 40))
    residual = np.random.default_rng(1).standard_normal((3, 60))
    expected = np.linalg.solve(np.linalg.cholesky(covariance(60, rounding, torque, 20)), residual.T).T
    assert noise.whitening(torque).applied(residual) == pytest.approx(noise.stated * expected, rel=1e-9)


def test_speeds_that_are_not_known_say_nothing_about_the_others():
    rounding, torque, lost = 1.0, 0.5, [7, 8, 20]
    kept = np.setdiff1d(np.arange(40), lost)
    noise = noise_of(40, rounding, torque)
    noise.known[lost] = False
    residual = np.random.default_rng(2).standard_normal(40)
    whole = covariance(40, rounding, torque, 40)[np.ix_(kept, kept)]
    expected = noise.stated * np.linalg.solve(np.linalg.cholesky(whole), residual[kept])
    residual[lost] = np.nan
    assert noise.whitening(torque).applied(residual)[kept] == pytest.approx(expected, rel=1e-4, abs=1e-4)


def test_the_level_is_that_of_a_speed_by_both_parts_relative_to_the_statement():
    noise = noise_of(50, 3.0, 4.0)
    assert noise.whitening(4.0).level == pytest.approx(1.0)
    assert noise.whitening(9.0).level == pytest.approx(np.sqrt(90.0) / 5.0)


def test_innovations_have_speeds_again():
    whitening = noise_of(50, 1.0, 0.5, starts=(0, 25)).whitening(0.5)
    residual = np.random.default_rng(3).standard_normal(50)
    assert whitening.undone(whitening.applied(residual)) == pytest.approx(residual, abs=1e-9)


def test_a_row_continues_the_one_before_within_a_trial_of_the_fit_and_without_a_gap():
    trial = np.array([0, 0, 0, 0, 0, 0, 1, 1])
    holdout = np.array([False] * 7 + [True])
    lasts_s = np.array([0.05, 0.05, 0.05, 0.25, 0.05, 0.05, 0.05, 0.05])
    goes_on = continued(trial, holdout, lasts_s, 0.05)
    assert goes_on.tolist() == [False, True, True, False, False, True, False, False]


def test_a_prediction_that_does_not_exist_makes_no_other_rows_unknown():
    whitening = noise_of(10, 1.0, 0.5).whitening(0.5)
    speeds = np.ones((2, 10))
    speeds[1, 4] = np.nan
    found = whitening.applied(speeds)
    assert np.isfinite(found[0]).all()
    assert np.flatnonzero(np.isnan(found[1])).tolist() == [4]


@pytest.mark.parametrize("torque", [0.5, 1.5])
def test_the_random_torque_of_a_log_is_found(torque):
    """Real counts: angles that are rounded down."""
    rng, rows = np.random.default_rng(4), 4000
    speeds = 40.0 + torque * random_torques(rng, rows, 1)[:, 0] / np.sqrt(PULSE**2 * _ends() + (1.0 - PULSE) ** 2)
    # A step for which the error of the difference of two rounded angles has a standard deviation of 1.
    step = np.sqrt(6.0) * ROW_S
    counts = np.floor(np.append(0.0, np.cumsum(speeds * ROW_S)) / step)
    residual = np.diff(counts) * step / ROW_S - speeds.mean()
    noise = noise_of(rows, 1.0, 1.0)
    found = torque_noise(noise, residual, np.ones(rows, dtype=bool), np.zeros(rows, dtype=int))
    assert found.torque == pytest.approx(torque, rel=0.1)
    assert found.correlation < 0.05


def _ends():
    return (1.0 - KEEP) / (1.0 + KEEP)


def test_innovations_have_no_bias_in_a_closed_loop():
    """A controller answers the counts, so that their rounding is in the voltages too. A fit to the speeds themselves
    then finds a wrong delay of the voltages and a wrong lag of the motor, on average over 1000 drives; a fit to the
    innovations does not.
    """
    rng, repeats, rows, late_s, torque = np.random.default_rng(5), 1000, 300, 0.036, 0.1
    tick_rad = 2.0 * np.pi / 360
    target = 10.0 + 0.3 * np.repeat(rng.standard_normal((rows // 60, repeats)), 60, axis=0)
    wheel, lack_sum, measured, phase = _Wheel(repeats, late_s, LAG_S), 0.0, np.zeros(repeats), rng.random(repeats)
    counts, voltages, angle = [np.zeros(repeats)], [], np.zeros(repeats)
    for k in range(rows):
        lack = target[k] - measured
        lack_sum = lack_sum + 1.5 * ROW_S * lack
        voltages.append(target[k] + 0.4 * lack + lack_sum)
        angle = angle + ROW_S * wheel.mean_speed(voltages[-1], torque * rng.standard_normal(repeats))
        counts.append(np.floor(angle / tick_rad + phase))
        measured = (counts[-1] - counts[-2]) * tick_rad / ROW_S
    speeds = _speeds(voltages, late_s, LAG_S)
    residual = np.diff(counts, axis=0) * tick_rad / ROW_S - speeds
    slopes = np.stack([_speeds(voltages, late_s + 1e-5, LAG_S), _speeds(voltages, late_s, LAG_S + 1e-5)]) - speeds
    of_torques = torque * np.sqrt(PULSE**2 * _ends() + (1.0 - PULSE) ** 2)
    whitening = noise_of(rows, tick_rad / ROW_S / np.sqrt(6.0), of_torques).whitening(of_torques)
    assert np.abs(_biases(residual.T, slopes.transpose(0, 2, 1))).min() > 4.0
    assert np.abs(_biases(whitening.applied(residual.T), whitening.applied(slopes.transpose(0, 2, 1)))).max() < 3.0


def _biases(z, slopes):
    """Mean errors (P,) of the parameters with these slopes (P, repeats, rows), in their standard errors."""
    squares = np.einsum("pmn,qmn->mpq", slopes, slopes)
    found = np.linalg.solve(squares, np.einsum("pmn,mn->mp", slopes, z)[..., None])[..., 0]
    return found.mean(axis=0) / (found.std(axis=0) / np.sqrt(len(found)))


class _Wheel:
    """First-order motors with gain 1, whose voltages act late."""

    def __init__(self, repeats, late_s, lag_s):
        self.speed, self.before = np.zeros(repeats), np.zeros(repeats)
        self.late_s, self.lag_s = late_s, lag_s

    def mean_speed(self, voltage, torque):
        turned = np.zeros_like(self.speed)
        for duration_s, held in ((self.late_s, self.before), (ROW_S - self.late_s, voltage)):
            steady, decay = held + torque, np.exp(-duration_s / self.lag_s)
            turned += steady * duration_s + (self.speed - steady) * self.lag_s * (1.0 - decay)
            self.speed = steady + (self.speed - steady) * decay
        self.before = voltage
        return turned / ROW_S


def _speeds(voltages, late_s, lag_s):
    wheel = _Wheel(voltages[0].shape[0], late_s, lag_s)
    return np.array([wheel.mean_speed(voltage, 0.0) for voltage in voltages])


def test_a_load_that_begins_with_a_row_slows_the_means_as_a_first_order_lag_does():
    """The mean of 1 - exp(-t / lag) over the row from k to k + 1 lags is 1 - (1 - 1/e) exp(-k)."""
    noise = CountNoise.from_rounding(np.full(8, 0.1), np.arange(8) > 0, np.ones(8, dtype=bool), np.exp(-1.0), 0.2)
    load = (np.arange(8) >= 2).astype(float)
    expected = np.where(load > 0.0, 1.0 - (1.0 - np.exp(-1.0)) * np.exp(2.0 - np.arange(8)), 0.0)
    np.testing.assert_allclose(noise.response(load[:, None])[:, 0], expected, atol=1e-12)


def test_a_load_says_nothing_of_the_rows_after_a_gap():
    goes_on = np.arange(6) != 3
    noise = CountNoise.from_rounding(np.full(6, 0.1), goes_on, np.ones(6, dtype=bool), 0.5, 0.2)
    assert not noise.response(np.eye(6)[:, 2:3])[3:].any()
