"""Rates, gaps and samples that stand out, on series whose faults were put there."""

import numpy as np
import pytest

from diagnosis.measured.channel import Channel, Role, SampleQuality
from diagnosis.measured.screening import far_out, noise_of, resolution, spikes, timing
from symolo.core.tables.time_series import TimeSeries


def rng(seed):
    return np.random.Generator(np.random.PCG64(seed))


def channel(values, t_s=None, **marks):
    t_s = 0.005 * np.arange(len(values)) if t_s is None else t_s
    return Channel.logged(
        TimeSeries("omega_rad_s", "rad/s", t_s, np.asarray(values, dtype=float)), Role.READING, **marks
    )


def test_rate_and_gaps_are_those_of_the_times():
    steps = timing(np.array([0.0, 0.1, 0.2, 0.5, 0.6, 0.75]))
    assert steps.rate_hz == pytest.approx(10.0)
    assert (steps.gaps, steps.longest_s) == (1, pytest.approx(0.3))
    assert timing(np.array([0.0, 0.1, 0.3])).gaps == 1
    assert timing(np.array([3.0])) is None


def test_the_spikes_of_a_step_response_are_found_and_its_steps_are_not():
    """A speed that rises and falls with 50 ms, and the current that peaks with it."""
    t = 0.005 * np.arange(800)
    rise = 1 - np.exp(-(t % 2.0) / 0.05)
    speed = np.where(t < 2.0, 10 * rise, 10 * (1 - rise))
    current = np.where(t < 2.0, 2.0 * (1 - rise), -2.0 * (1 - rise)) + 0.1
    planted = [100, 101 + 50, 420, 700]
    for seed, (signal, sd, size) in enumerate(((speed, 0.1, 4.0), (current, 0.012, -0.6))):
        values = signal + sd * rng(seed).standard_normal(800)
        assert not spikes(channel(values.copy())).any()
        values[planted] += size
        assert np.flatnonzero(spikes(channel(values))).tolist() == planted


def test_a_start_without_noise_is_no_spike():
    """Rows of a robot that stands and then drives off, to six digits, as a simulation logs them."""
    x = np.concatenate([np.zeros(30), np.round(0.01 * np.arange(30) ** 1.5, 6)])
    assert not spikes(channel(x)).any()


def test_what_is_marked_already_is_no_spike():
    values = 0.01 * rng(1).standard_normal(100)
    values[50] = 8.19
    no_target = np.arange(100) == 50
    assert spikes(channel(values)).sum() == 1
    assert not spikes(channel(values, no_target=no_target)).any()


def test_far_out_readings_are_found_in_any_order():
    deviations = 0.002 * rng(2).standard_normal(400) + 0.01
    deviations[[7, 300]] = 0.1, -0.2
    deviations[9] = np.nan
    assert np.flatnonzero(far_out(deviations)).tolist() == [7, 300]


def test_resolution_is_the_step_that_all_values_lie_on():
    assert resolution(np.array([0.321, 0.322, 0.325, np.nan])) == pytest.approx(0.001)
    assert resolution(np.array([0.0, 1.0, 2.5])) is None
    assert resolution(np.ones(4)) is None


def test_a_channel_is_refused_whose_marks_contradict_its_values():
    series = TimeSeries("x_m", "m", np.arange(3.0), np.array([0.0, np.nan, 1.0]))
    with pytest.raises(ValueError, match="NaN and the quality MISSING do not agree"):
        Channel(series, Role.READING, np.array([SampleQuality.GOOD] * 3, dtype=np.int8))
    with pytest.raises(ValueError, match="shape"):
        Channel.logged(series, Role.READING, noise_sd=np.ones(2))


@pytest.mark.parametrize("steps_of_sd", [2.0, 3.0, 4.0, 5.0])
def test_noise_finer_than_the_resolution_is_never_estimated_too_small(steps_of_sd):
    """At rest; a value that may lie anywhere in a step of q is known to a variance of q^2/12 and no better."""
    fresh = np.random.Generator(np.random.PCG64(9)).standard_normal(4000)
    t = 0.005 * np.arange(4000)
    values = np.rint(fresh / steps_of_sd) * steps_of_sd
    noise = noise_of(Channel.logged(TimeSeries("x", "m", t, values), Role.READING))
    assert noise.sd >= steps_of_sd / np.sqrt(12) * (1 - 1e-12)
    assert noise.sd < 1.6 * np.hypot(1.0, steps_of_sd / np.sqrt(12))


def test_a_channel_that_seldom_changes_by_a_step_has_noise_below_its_resolution():
    t = 0.005 * np.arange(400)
    noise = noise_of(Channel.logged(TimeSeries("x", "m", t, np.repeat([0.2, 0.3], 200)), Role.READING))
    assert not noise.is_resolved
    assert noise.sd == pytest.approx(0.1 / np.sqrt(12))
    assert (noise.correlation, noise.sd_error) == (0.0, None)
