"""The range sensors of a drive drift at random, independently of each other, with one size and one time constant."""

import importlib
from copy import copy
from dataclasses import replace
from itertools import accumulate

import numpy as np
import pytest

from diagnosis.importers import drive_log
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.unexplained.drift.random_drift import random_drift
from diagnosis.inference.unexplained.drift.range_series import RangeSeries, range_rows

pytestmark = pytest.mark.usefixtures("cases_on_the_path")

SD_M, TAU_S, ROW_S = 0.006, 2.0, 0.05


@pytest.fixture
def drift_of(drive):
    """The random drift that is found where the ranges have an error [m], a function of their rows."""
    evidence, hypothesis = drive
    ranges = range_rows(evidence)

    def of(error_m):
        errors_m = np.zeros(len(evidence.values))
        errors_m[ranges.place] = np.nan_to_num(error_m(ranges))
        (fit,) = fits(evidence.without(-errors_m), [(hypothesis, hypothesis.null())])
        return random_drift(fit.evidence, fit, fit)

    return of


def first_order(ranges, seed=5, tau_s=TAU_S):
    """A path of first-order Gauss-Markov errors for each trial of each sensor, by recursion from row to row."""
    rng, keep = np.random.default_rng(seed), np.exp(-ROW_S / tau_s)
    errors = np.zeros(len(ranges.time_s))
    for row in range(len(errors)):
        begins = row == 0 or not 0.0 < ranges.time_s[row] - ranges.time_s[row - 1] < 2.0 * ROW_S
        deviate = rng.standard_normal()
        errors[row] = deviate if begins else keep * errors[row - 1] + np.sqrt(1.0 - keep**2) * deviate
    return SD_M * errors


def test_it_is_named_with_size_and_time_constant_and_its_path_follows_the_error(drive, drift_of):
    evidence, _ = drive
    ranges = range_rows(evidence)
    drift = drift_of(first_order)
    for name, true in (("sd_m", SD_M), ("time_constant_s", TAU_S)):
        assert getattr(drift.effect, name) == pytest.approx(true, abs=3.0 * drift.std[name])
    assert drift.confidence > 0.95
    assert drift.answer()["range"].keys() == {"session_time_s"}
    fitted = evidence.fit[ranges.place]
    left_m = (first_order(ranges) - drift.path_m[ranges.place])[fitted]
    assert np.sqrt(np.mean(left_m**2)) < 0.5 * SD_M


@pytest.mark.parametrize("rows", [10.0, 12.0])
def test_one_that_lasts_little_longer_than_correlated_noise_is_named(drift_of, rows):
    """Least time constant: 5 rows. An error of 4 rows is none, as `test_what_looks_alike_is_not_called_so` shows."""
    drift = drift_of(lambda ranges: first_order(ranges, tau_s=rows * ROW_S))
    for name, true in (("sd_m", SD_M), ("time_constant_s", rows * ROW_S)):
        assert getattr(drift.effect, name) == pytest.approx(true, abs=3.0 * drift.std[name])


def test_without_a_session_each_trial_of_a_sensor_has_a_path_of_its_own(drive):
    """Both trials begin at 0, and rows of the same time must not be taken for neighbours."""
    evidence, hypothesis = drive
    stages = [copy(stage) for stage in evidence.stages]
    for stage in stages:
        stage.observed = tuple(_with_own_times(quantity) for quantity in stage.observed)
    apart = Evidence(tuple(stages))
    ranges = range_rows(apart)
    assert len(np.unique(ranges.path)) == 3 * 2
    errors_m = np.zeros(len(apart.values))
    errors_m[ranges.place] = first_order(ranges)
    (fit,) = fits(apart.without(-errors_m), [(hypothesis, hypothesis.null())])
    drift = random_drift(fit.evidence, fit, fit)
    assert drift.effect.sd_m == pytest.approx(SD_M, abs=3.0 * drift.std["sd_m"])


def _with_own_times(quantity):
    times = (replace(c, values=quantity.t_s) if c.name == "session_time_s" else c for c in quantity.covariates)
    return replace(quantity, covariates=tuple(times))


@pytest.mark.parametrize(
    "error_m",
    [
        lambda _: 0.0,
        lambda ranges: 0.01 * (ranges.time_s > 12.0) * (ranges.sensor == 1),
        lambda ranges: 0.006 * np.sin(3.0 * of_name(ranges, "theta_rad") + ranges.sensor),
        lambda ranges: 0.006 * np.cos(7.0 * of_name(ranges, "distance_m")),
        lambda ranges: np.where(of_name(ranges, "wall") == 1.0, 0.01, 0.0),
        lambda ranges: 0.006 * np.sin(4.0 * of_name(ranges, "wall_place_m")),
        lambda ranges: of_name(ranges, "distance_m") * first_order(ranges),
        lambda ranges: first_order(ranges, tau_s=4.0 * ROW_S),
    ],
    ids=[
        "nothing",
        "jump of a sensor",
        "along the heading",
        "along the distance",
        "at one wall",
        "bent walls",
        "scale that drifts",
        "noise correlated over four rows",
    ],
)
def test_what_looks_alike_is_not_called_so(drift_of, error_m):
    assert drift_of(error_m) is None


def of_name(ranges, name):
    (values,) = (covariate.values for covariate in ranges.covariates if covariate.name == name)
    return values


def test_no_mean_of_neighbours_reaches_across_a_pause_or_into_another_sensor(drive):
    evidence, hypothesis = drive
    ranges = range_rows(evidence)
    (fit,) = fits(evidence, [(hypothesis, hypothesis.null())])
    at = ranges.path_time_s
    series = RangeSeries.from_fit(fit, ranges, at, np.ones(len(at), dtype=bool))
    assert len(series.at) < 0.6 * len(at)
    away = np.abs(series.at[:, None] - at).min(axis=1)
    assert away.max() < 0.51 * ROW_S


def test_the_mean_of_a_drift_of_one_sensor_is_no_offset_of_it(tmp_path, diagnosed_among):
    """Over 30 s, a drift with a time constant of 4 s has a mean with a standard deviation of half its own.

    Here it is that of the front sensor, whose white noise seems larger than that of the others without an offset.
    """
    gap = importlib.import_module("gap_cases")
    case = gap.make_case("drive_log", 1, rows="few")
    columns, rng = dict(case.columns), np.random.default_rng(10)
    keep = np.exp(-np.diff(columns["session_time_s"], prepend=-np.inf) / 4.0)
    for name in ("tof_front_m", "tof_left_m", "tof_right_m"):
        drift = list(
            accumulate(
                zip(keep, rng.standard_normal(len(keep)), strict=True),
                lambda last, row: row[0] * last + np.sqrt(1.0 - row[0] ** 2) * row[1],
                initial=0.0,
            )
        )[1:]
        columns[name] = np.round(columns[name] + SD_M * np.array(drift), 3)
    columns |= {name: np.full(len(keep), np.nan) for name in ("u_left_V", "u_right_V")}
    gap.write(replace(case, columns=columns), tmp_path / "case")
    measurement = drive_log.IMPORTER.read(tmp_path / "case")
    others = ("tof_range_offset", "tof_range_scale", "tof_mount_yaw", "tof_time_offset", "range_gathering_time")
    (effect,) = diagnosed_among(measurement, *others).answer()["effects"]
    assert effect["name"] == "range_wander"
    for name, true in (("sd_m", SD_M), ("time_constant_s", 4.0)):
        assert effect["parameters"][name] == pytest.approx(true, abs=3.0 * effect["std"][name])
