"""A slow error of a range sensor is named if nothing simpler is as likely."""

import importlib
from dataclasses import replace

import numpy as np
import pytest

from diagnosis import diagnose as diagnose_module
from diagnosis.extended_robot import extended_robot
from diagnosis.importers import tof_bench
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.gain import trimmed_rms
from diagnosis.inference.naming.verdict import CaseVerdict
from diagnosis.inference.selection.selected import selected
from diagnosis.inference.unexplained.adequacy import Adequacy, Structure
from diagnosis.inference.unexplained.drift import search as module
from diagnosis.inference.unexplained.drift.random_drift import random_drift
from diagnosis.report.report_data import report_data
from diagnosis.report.sentences.effects.named import effect_sentences
from diagnosis.report.sentences.verdict.headline import headline
from sensors.effects.range_sensor.range_wander import RangeWander

pytestmark = pytest.mark.usefixtures("cases_on_the_path")

OF_TIME = ("range_offset", "range_scale", "warmup_drift", "temperature_drift", "noise_scale", "ambient_noise")
"""Effects of a bench that an error over time could be taken for, alone or together."""


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    """A bench of 150 rows whose readings have an error [m] that is a function of time [s].

    The rows are 2 s apart, times a factor. A second error [m] is a function of the distance [m].
    """

    def of(error_m, slower=1.0, near_m=np.zeros_like):
        gap = importlib.import_module("gap_cases")
        case = gap.make_case("tof_bench", 8, rows="some")
        t_s = slower * case.columns["t_s"]
        error = error_m(t_s) + near_m(case.columns["distance_m"])
        columns = {**case.columns, "t_s": t_s, "reading_m": np.round(case.columns["reading_m"] + error, 3)}
        folder = tmp_path_factory.mktemp("bench") / "case"
        gap.write(replace(case, columns=columns), folder)
        return tof_bench.IMPORTER.read(folder)

    return of


@pytest.fixture(scope="module")
def diagnosed(bench, diagnosed_among):
    """The diagnosis of a bench among the effects that an error over time could be taken for, and further ones."""
    return lambda error_m, *further, **bench_of: diagnosed_among(bench(error_m, **bench_of), *OF_TIME, *further)


@pytest.fixture
def drift_of(nominal_fit):
    """The random drift that a bench shows beside the nominal robot."""

    def of(measurement):
        fit = nominal_fit(measurement)
        return random_drift(fit.evidence, fit, fit)

    return of


@pytest.fixture(scope="module")
def drifting(diagnosed):
    return diagnosed(lambda t_s: gauss_markov(t_s, 0.006, 25.0))


@pytest.fixture(scope="module")
def drifting_about_an_offset(diagnosed):
    return diagnosed(lambda t_s: 0.03 + gauss_markov(t_s, 0.006, 25.0))


def gauss_markov(t_s, sd_m, tau_s, seed=2):
    """By the Cholesky factor of its covariance."""
    covariance = np.exp(-np.abs(np.subtract.outer(t_s, t_s)) / tau_s)
    factor = np.linalg.cholesky(covariance + 1e-9 * np.eye(len(t_s)))
    return sd_m * factor @ np.random.default_rng(seed).standard_normal(len(t_s))


def test_a_random_drift_is_named_with_its_size_and_time(drifting):
    answer = drifting.answer()
    (effect,) = answer["effects"]
    assert effect["name"] == "range_wander"
    assert not answer["unexplained"]
    for name, value in (("sd_m", 0.006), ("time_constant_s", 25.0)):
        # The size of a path over few time constants varies in proportion: here it is half of that which was drawn.
        relative = effect["std"][name] / effect["parameters"][name]
        assert np.log(effect["parameters"][name]) == pytest.approx(np.log(value), abs=3.0 * relative)
    assert drifting.conclusion is CaseVerdict.NAMED
    assert headline(drifting) == "The real robot differs from the nominal one by range_wander."
    assert effect_sentences(drifting)[0].startswith("range_wander: sd_m = 0.00")
    # It is random: no prediction of the held-out rows uses it.
    assert answer["heldout_gain"] == pytest.approx(0.0, abs=0.1)
    assert extended_robot(drifting).config.effects.get(RangeWander).time_constant_s == pytest.approx(
        effect["parameters"]["time_constant_s"], rel=1e-6
    )


@pytest.mark.parametrize("period_s", [23.0, 61.0, 130.0])
def test_an_error_that_repeats_is_no_random_drift(diagnosed, period_s):
    """A wave of 3 mm, such as the beat of two clocks, with 2.3 to 13 periods in the 300 s."""
    diagnosis = diagnosed(lambda t_s: 0.003 * np.sin(2.0 * np.pi * t_s / period_s + 0.7))
    assert diagnosis.names == ()
    assert diagnosis.conclusion is CaseVerdict.UNEXPLAINED


@pytest.mark.parametrize(("period_s", "duty", "size_m"), [(27.0, 0.2, -0.0074), (54.0, 0.4, -0.01)])
def test_an_offset_that_switches_on_and_off_is_no_random_drift(diagnosed, period_s, duty, size_m):
    """A lamp that lights the target for a part of each period has harmonics that one wave lacks."""
    diagnosis = diagnosed(lambda t_s: np.where((t_s / period_s + 0.3) % 1.0 < duty, size_m, 0.0))
    assert diagnosis.names == ()
    assert diagnosis.conclusion is CaseVerdict.UNEXPLAINED


def test_an_offset_that_grows_and_is_reset_is_no_random_drift(diagnosed):
    """A sensor that calibrates itself again and again."""
    diagnosis = diagnosed(lambda t_s: -0.0244 * ((t_s / 83.0 + 0.27) % 1.0))
    assert diagnosis.names == ()
    assert diagnosis.conclusion is CaseVerdict.UNEXPLAINED


@pytest.mark.parametrize(("p", "is_named"), [(1e-6, False), (0.5, True)])
def test_a_random_drift_that_leaves_structure_over_time_is_a_part_of_it(drifting, monkeypatch, p, is_named):
    """Half a sigma of any other error over time could be the drift of a zero, but that is what the drift explains."""
    rows = np.ones((len(drifting.measured.values), 1))
    over_time = Structure("reading_m", "reading_m", "t_s", "wave", p, 30.0, 0, rows, 0.5, is_over_time=True)
    monkeypatch.setattr(diagnose_module, "_structures_of", lambda *_: Adequacy((over_time,)))
    bare, library = drifting.selection.nominal.hypothesis, drifting.candidates
    evidence, selection = selected(drifting.measured, bare, library.testable)
    *_, drift = diagnose_module._beside_random_drift(evidence, bare, library, selection, drifting.adequacy)
    assert (drift is not None) == is_named


def test_a_random_drift_much_larger_than_the_noise_is_named(diagnosed):
    """Most readings are so far away that they would count as outliers beside the noise."""
    diagnosis = diagnosed(lambda t_s: gauss_markov(t_s, 0.05, 20.0))
    assert diagnosis.names == ("range_wander",)
    # The standard deviation over a time T is known to a share of about sqrt(tau / T).
    assert diagnosis.random_drift.effect.sd_m == pytest.approx(0.05, rel=2.0 * np.sqrt(20.0 / 300.0))


def test_an_effect_that_is_not_linear_stays_beside_a_random_drift(diagnosed):
    """Amplitude and decay length of the error near the sensor are so uncertain together that neither seems needed."""
    diagnosis = diagnosed(
        lambda t_s: gauss_markov(t_s, 0.006, 25.0),
        "near_field_error",
        "log_range_error",
        near_m=lambda d_m: -0.08 * np.exp(-d_m / 0.025),
    )
    assert set(diagnosis.names) == {"near_field_error", "range_wander"}


def test_a_linear_drift_is_no_random_one(diagnosed):
    assert "range_wander" not in diagnosed(lambda t_s: 1e-4 * t_s).names


def test_noise_whose_neighbours_have_a_correlation_of_a_fifth_is_no_random_drift(bench, drift_of):
    assert drift_of(bench(lambda t_s: gauss_markov(t_s, 0.006, 1.2))) is None
    assert drift_of(bench(lambda t_s: gauss_markov(t_s, 0.006, 25.0))) is not None


@pytest.fixture
def swept(tmp_path, diagnosed_among):
    """The diagnosis of a bench whose distance grows and falls slowly, with an error [m] of distance and time."""

    def of(error_m):
        gap = importlib.import_module("gap_cases")
        case = gap.make_case("tof_bench", 8, rows="some")
        t_s, distance_m = case.columns["t_s"], case.columns["distance_m"]
        order = np.argsort(np.argsort(np.abs(np.sin(2.0 * np.pi * t_s / np.ptp(t_s)))))
        sweep_m = np.sort(distance_m)[order]
        error = case.columns["reading_m"] - distance_m
        reading_m = np.round(sweep_m + error[np.argsort(distance_m)][order] + error_m(sweep_m, t_s), 3)
        gap.write(
            replace(case, columns={**case.columns, "distance_m": sweep_m, "reading_m": reading_m}), tmp_path / "c"
        )
        return diagnosed_among(tof_bench.IMPORTER.read(tmp_path / "c"), *OF_TIME)

    return of


@pytest.fixture
def at_rest(tmp_path):
    """A bench whose target stays at one distance [m], with an error [m] of time and noise of 2 mm."""

    def of(distance_m, error_m):
        gap = importlib.import_module("gap_cases")
        case = gap.make_case("tof_bench", 8, rows="some")
        t_s = case.columns["t_s"]
        noise_m = 0.002 * np.random.default_rng(4).standard_normal(len(t_s))
        still = {"distance_m": np.full(len(t_s), distance_m), "incidence_rad": np.zeros(len(t_s))}
        reading_m = np.round(distance_m + noise_m + error_m(t_s), 3)
        gap.write(replace(case, columns={**case.columns, **still, "reading_m": reading_m}), tmp_path / "still")
        return tof_bench.IMPORTER.read(tmp_path / "still")

    return of


@pytest.mark.parametrize(
    "error_m",
    [
        lambda distance_m, _: 0.02 * np.exp(-(((distance_m - 0.4) / 0.08) ** 2)),
        lambda distance_m, t_s: distance_m * gauss_markov(t_s, 0.02, 25.0),
    ],
    ids=["bump along the distance", "scale that drifts"],
)
def test_what_depends_on_the_distance_is_no_random_drift(swept, error_m):
    diagnosis = swept(error_m)
    assert "range_wander" not in diagnosis.names
    assert diagnosis.answer()["unexplained"]


def test_a_target_at_rest_shows_a_random_drift_but_not_whether_it_is_one_of_the_scale(at_rest, drift_of):
    """Both have the same likelihood at one distance, whatever a sum in another order does to the last digits."""
    for distance_m in (0.2, 0.3, 0.41):
        error = drift_of(at_rest(distance_m, lambda t_s: gauss_markov(t_s, 0.006, 60.0)))
        assert error is not None
        assert error.confidence < 0.5


def test_a_jump_is_no_random_drift(diagnosed):
    """A drift after power-on, an offset and a random drift imitate it together."""
    assert diagnosed(lambda t_s: np.where(t_s > 0.4 * t_s.max(), -0.02, 0.0)).names == ()


@pytest.mark.parametrize("size_m", [-0.02, 0.02])
def test_a_jump_that_a_wrong_scale_imitates_is_no_random_drift(swept, size_m):
    """The distance grows for a quarter of the time, falls, and does so again; nothing else has happened."""
    diagnosis = swept(lambda _, t_s: np.where(t_s > 0.55 * t_s.max(), size_m, 0.0))
    assert diagnosis.names == ()
    assert diagnosis.answer()["unexplained"]


@pytest.mark.parametrize("seed", [2, *(pytest.param(seed, marks=pytest.mark.long) for seed in (3, 5))])
def test_what_a_random_drift_explains_by_itself_is_no_effect(diagnosed, seed):
    """Over few time constants a random drift has a mean and a trend, which look like other effects."""
    assert diagnosed(lambda t_s: gauss_markov(t_s, 0.006, 60.0, seed)).names == ("range_wander",)


def test_an_offset_beyond_a_random_drift_is_named_beside_it(drifting_about_an_offset):
    assert set(drifting_about_an_offset.names) == {"range_offset", "range_wander"}
    (offset,) = drifting_about_an_offset.named
    # The mean of an error with this time constant over 300 s has a standard deviation of sqrt(2 tau / T) of it.
    assert offset.values["offset_m"] == pytest.approx(0.03, abs=3.0 * 0.006 * np.sqrt(2.0 * 25.0 / 300.0))


def test_an_effect_beside_a_drift_that_nobody_can_predict_stands(diagnosed):
    """Held-out readings are off by the drift, with the effect and without it, and say little about either."""
    diagnosis = diagnosed(lambda t_s: gauss_markov(t_s, 0.03, 12.0), near_m=lambda d_m: 0.12 * d_m)
    assert set(diagnosis.names) == {"range_scale", "range_wander"}
    (scale,) = diagnosis.named
    assert scale.values["scale"] == pytest.approx(1.12, abs=3.0 * scale.std["scale"])


def test_a_larger_noise_is_named_beside_a_random_drift(diagnosed):
    """The readings have four times the noise of the paper's Eq. 23, which the case states."""

    def noise_m(distance_m):
        beyond_m = np.maximum(distance_m - 0.18, 0.0)
        sd_m = 1e-3 * np.polyval([1.15, 2.51, 4.88, 1.4], beyond_m)
        return np.sqrt(15.0) * sd_m * np.random.default_rng(8).standard_normal(len(distance_m))

    diagnosis = diagnosed(lambda t_s: gauss_markov(t_s, 0.03, 40.0, seed=3), near_m=noise_m)
    assert set(diagnosis.names) == {"noise_scale", "range_wander"}
    (noise,) = diagnosis.named
    assert noise.values["scale"] == pytest.approx(4.0, abs=3.0 * noise.std["scale"])


def test_every_error_of_the_report_is_that_of_the_readings_as_they_were_measured(drifting_about_an_offset):
    """The bench has one quantity, so its errors are those of the headline; the random drift is in all of them."""
    diagnosis = drifting_about_an_offset
    data = report_data(diagnosis)
    (quantity,), (ablation,) = data.by_quantity, data.ablations
    assert quantity.extended == diagnosis.gain
    assert quantity.calibrated == diagnosis.calibrated
    assert ablation.gain.before == pytest.approx(diagnosis.gain.before)
    assert ablation.effect_gain.after == pytest.approx(diagnosis.gain.after)
    errors = [trimmed_rms(np.abs(z[diagnosis.evidence.heldout])) for z in data.z]
    assert errors == pytest.approx([diagnosis.gain.before, diagnosis.calibrated.after, diagnosis.gain.after])


def test_held_out_readings_have_no_part_in_the_error_that_is_taken_out_of_them(drifting):
    nominal = drifting.selection.nominal

    def path_m(evidence):
        (fit,) = fits(evidence, [(nominal.hypothesis, nominal.x)])
        return random_drift(evidence, fit, fit).path_m

    changed = drifting.measured.without(np.where(drifting.measured.heldout, 0.003, 0.0))
    assert path_m(changed) == pytest.approx(path_m(drifting.measured), abs=1e-9)


def test_an_error_along_another_covariate_must_only_be_less_likely(drifting, monkeypatch):
    """It has as many numbers. If it is equally likely, the name has at most half the weight."""
    nominal = drifting.selection.nominal
    (fit,) = fits(drifting.measured, [(nominal.hypothesis, nominal.x)])
    search = module.DriftSearch.from_fit(drifting.measured, fit)

    def beside(rise):
        def gains(other, *_, **__):
            yield search.cost_of_white_noise(other) - search.beside(other).cost - rise

        monkeypatch.setattr(module, "gains_of_others", gains)
        return random_drift(drifting.measured, fit, fit)

    assert beside(-0.1) is None
    assert 0.4 < beside(0.1).confidence < 0.52
    assert beside(30.0).confidence > 0.8


@pytest.mark.parametrize(("row_s", "tau_s"), [(0.008, 0.1), (1200.0, 15_000.0)], ids=["8 ms", "20 minutes"])
def test_a_random_drift_of_rows_of_any_distance_has_a_time_constant_within_its_limits(bench, drift_of, row_s, tau_s):
    drift = drift_of(bench(lambda t_s: gauss_markov(t_s, 0.006, tau_s), slower=0.5 * row_s))
    assert drift is not None
    time_constant = RangeWander.parameters()["time_constant_s"]
    assert time_constant.low <= drift.effect.time_constant_s <= time_constant.high


@pytest.mark.parametrize("row_s", [1e-4, 1e4])
def test_rows_too_close_or_too_far_apart_for_any_time_constant_show_no_random_drift(bench, drift_of, row_s):
    assert drift_of(bench(lambda t_s: gauss_markov(t_s, 0.006, 20.0 * row_s), slower=0.5 * row_s)) is None
