"""Detectability, rays, noise and grades of the independent cases against closed forms."""

import numpy as np
import pytest
from scipy.stats import chi2, norm

from benchmarks.diagnosis.independent_cases.case import make_cases
from benchmarks.diagnosis.independent_cases.detectability import left_over
from benchmarks.diagnosis.independent_cases.drives.room import cast
from benchmarks.diagnosis.independent_cases.files import write_case, write_truth
from benchmarks.diagnosis.independent_cases.judge import grade, parameter_hits, stated_names, wilson
from benchmarks.diagnosis.independent_cases.ranges.tof_bench import CHANNEL, RangeSetting
from benchmarks.diagnosis.independent_cases.ranges.unknown_noise import power_of_f_test, power_of_noise_test
from benchmarks.diagnosis.independent_cases.recipes import Effect, Variant


def test_a_tolerance_takes_its_share_of_a_likelihood_ratio():
    difference, column = np.array([3.0, 4.0, 0.0]), np.array([1.0, 2.0, 2.0])
    expected = 25 - 11.0**2 / (1 + 9)
    assert left_over(difference, [column]) == pytest.approx(expected)
    assert left_over(difference, [], [column]) == pytest.approx(25 - 11.0**2 / 9)


def exact_bench():
    setting = RangeSetting(np.random.default_rng(1))
    assert setting.prepare(["noise_scale", "tilt_asymmetry"], np.random.default_rng(0))
    setting.polynomial_mm = [2.0, 0.0, 0.0, 0.0]
    return setting


def test_an_effect_is_measured_in_the_noise_that_the_case_has():
    setting, rows = exact_bench(), (~exact_bench().holdout).sum()
    shift = Variant((Effect("range_offset", {"offset_m": 0.004}),))
    plain, shifted = setting.signatures([Variant(), shift], [Effect("noise_scale", {"scale": 3.0})])
    assert np.sum((shifted - plain) ** 2) == pytest.approx(rows * 0.004**2 / (0.006**2 + 1e-6 / 12))


def test_the_ratio_of_a_noise_scale_is_twice_the_divergence():
    setting, rows = exact_bench(), (~exact_bench().holdout).sum()
    ratio = (0.006**2 + 1e-6 / 12) / (0.002**2 + 1e-6 / 12)
    effect = Effect("noise_scale", {"scale": 3.0})
    assert setting.noise_ratio(effect, []) == pytest.approx(rows * (ratio - 1 - np.log(ratio)))


def test_tilts_have_both_signs_where_their_asymmetry_is_to_show():
    setting = exact_bench()
    shown = setting.bench.incidence_rad[~setting.holdout]
    assert shown.min() < 0 < shown.max()


def test_readings_have_the_noise_that_the_truth_reports():
    setting, errors = exact_bench(), []
    setting.plan.outlier_share, setting.plan.dropout_share, setting.no_target_share = {CHANNEL: 0.0}, 0.0, 0.0
    for seed in range(20):
        values, _ = setting.produce(Variant(), np.random.default_rng(seed)).tables["data.csv"][CHANNEL]
        errors.append(values - setting.predict(Variant()))
    assert np.std(errors) == pytest.approx(np.sqrt(0.002**2 + 1e-6 / 12), rel=0.05)


def test_rays_end_at_the_walls():
    headings = np.array([0.0, np.pi / 2, np.pi, -np.pi / 4])
    distance, wall = cast((np.full(4, 0.5), np.full(4, 0.25), headings), (2.0, 1.5))
    np.testing.assert_allclose(distance, [1.5, 1.25, 0.5, 0.25 * np.sqrt(2)])
    assert wall.tolist() == [1, 3, 0, 2]


def test_the_same_seed_gives_the_same_files(tmp_path):
    for run in ("first", "second"):
        for files, _, truth in make_cases("tof_bench", 3, 7):
            write_case(tmp_path / run / truth["case"], files)
            write_truth(tmp_path / run / "truth.json", truth)
    paths = sorted(path.relative_to(tmp_path / "first") for path in (tmp_path / "first").rglob("*.*"))
    assert len(paths) == 10
    for path in paths:
        assert (tmp_path / "first" / path).read_bytes() == (tmp_path / "second" / path).read_bytes()


def test_a_measurement_that_is_made_again_has_the_same_rows_and_other_noise():
    """The scatter of the difference is that of two readings; an outlier may have any size."""
    (files, again, _), *_ = make_cases("tof_bench", 1, 7)
    first, second = files.tables["data.csv"], again.tables["data.csv"]
    for column in first.keys() - {"reading_m"}:
        assert first[column][0].tolist() == second[column][0].tolist()
    difference = first["reading_m"][0] - second["reading_m"][0]
    assert 0.0 < np.nanmedian(np.abs(difference)) < 0.02


def test_wilson_interval_of_eight_in_ten():
    assert wilson(8, 10) == pytest.approx((0.4902, 0.9433), abs=1e-4)


def coast(inductance, frequency, std_inductance):
    return {
        "name": "bridge_coast",
        "parameters": {"inductance_H": inductance, "switching_Hz": frequency},
        "std": {"inductance_H": std_inductance, "switching_Hz": 0.0},
    }


def test_only_the_product_of_inductance_and_frequency_is_judged():
    assert parameter_hits(coast(0.001, 1000.0, 0), coast(0.002, 500.0, 1e-4)) == (1, 1)
    assert parameter_hits(coast(0.001, 1000.0, 0), coast(0.002, 1000.0, 1e-4)) == (0, 1)
    assert parameter_hits(coast(0.001, 1000.0, 0), coast(0.002, 1000.0, 0.0)) == (0, 0)


def test_an_effect_is_right_among_three_names_and_wrong_with_another_sensor():
    effect = {"name": "tof_mount_yaw", "parameters": {"sensor": "left", "angle_rad": 0.1}}
    truth = {"category": "one", "effects": [effect], "near_rivals": {}}

    def right(**answer):
        return grade(truth, {"effects": [answer]})[1]

    assert right(name="tof_mount_yaw", parameters={"sensor": "left"})
    assert right(name="tof_range_offset", ambiguous_with=["tof_mount_yaw[left]"])
    assert not right(name="tof_range_offset", ambiguous_with=["tof_mount_yaw[right]"])
    assert not right(name="tof_range_offset", ambiguous_with=["tof_mount_yaw", "turn_slip", "marker_yaw"])


def test_a_name_that_explains_the_data_as_well_is_right_and_its_parameters_are_not_judged():
    effect = {"name": "speed_scale", "parameters": {"scale": 1.1}, "equal": ["tof_range_offset[left]", "turn_slip"]}
    truth = {"category": "one", "effects": [effect], "near_rivals": {}}

    def right(**answer):
        return grade(truth, {"effects": [answer]})[1]

    assert right(name="turn_slip")
    assert right(name="tof_range_offset", parameters={"sensor": "left"})
    assert right(name="marker_yaw", ambiguous_with=["tof_range_offset[left]"])
    assert not right(name="tof_range_offset", parameters={"sensor": "right"})
    assert not right(name="marker_yaw")
    assert parameter_hits(effect, {"name": "turn_slip", "parameters": {"scale": 2.0}, "std": {"scale": 0.1}}) == (0, 0)
    assert parameter_hits(effect, {"name": "speed_scale", "parameters": {"scale": 2.0}, "std": {"scale": 0.1}}) == (
        0,
        1,
    )


def test_stated_names_are_right_or_near_rivals_or_wrong():
    truth = {"effects": [{"name": "supply_sag", "parameters": {}}], "near_rivals": {"speed_scale": 5.0}}
    answers = [{"name": name, "confidence": 0.9} for name in ("supply_sag", "speed_scale", "current_limit")]
    expected = [(0.9, True, True), (0.9, False, True), (0.9, False, False)]
    assert stated_names(truth, {"effects": [*answers, {"name": "no_confidence"}]}) == expected
    assert stated_names(truth, None) == []


def test_a_test_that_learns_the_noise_names_by_chance_as_often_as_its_level_and_sees_less_in_few_rows():
    """With one number and many rows, F and noncentral F are those of a normal variable squared."""
    assert power_of_f_test(1e-6, 1, 100, 0.01) == pytest.approx(0.01, rel=1e-3)
    many = power_of_f_test(9.0, 1, 100_000, 0.01)
    assert many == pytest.approx(norm.sf(norm.isf(0.005) - 3.0) + norm.cdf(-norm.isf(0.005) - 3.0), rel=1e-3)
    assert power_of_f_test(9.0, 1, 10, 0.01) < many


def test_a_larger_noise_is_seen_by_its_sum_of_squares():
    """The most powerful test compares it with the chi-square distribution."""
    rows, scale = 40, 1.5
    power = power_of_noise_test(np.eye(rows), scale**2 * np.eye(rows), 0.01)
    assert power == pytest.approx(chi2.sf(chi2.isf(0.01, rows) / scale**2, rows), abs=0.03)
