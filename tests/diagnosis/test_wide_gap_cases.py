"""What spoils the data of the wide families of hide-and-find cases, against closed forms."""

import importlib
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

ROWS = 2000
pytestmark = pytest.mark.usefixtures("cases_on_the_path")


@pytest.fixture(scope="module")
def gap():
    return importlib.import_module("gap_cases")


@pytest.fixture(scope="module")
def part():
    return lambda name: importlib.import_module(f"gap_cases.{name}")


@pytest.fixture
def remade(part):
    """A case of the narrow family on another day."""

    def spoilt(case, day):
        case = replace(case, day=day)
        kind = part(case.bench.kind)
        columns, _ = kind.observe(case.true_bench, case.world, np.random.default_rng(5), day)
        return replace(case, columns=columns)

    return spoilt


def runs(struck):
    """Lengths of runs of neighbouring outliers."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], struck != 0.0, [0]]).astype(int)))
    return edges[1::2] - edges[::2]


def test_outliers_have_the_share_and_the_sizes_that_are_asked_for(gap):
    outliers = gap.Outliers({"a": 0.05, "b": 0.0}, (5.0, 20.0), in_runs=0.0, sign=0.0, together=False)
    struck = outliers.struck(np.random.default_rng(1), ROWS)
    hit = struck["a"][struck["a"] != 0.0]
    assert len(hit) == 100
    assert np.abs(hit).min() >= 5.0
    assert np.abs(hit).max() <= 20.0
    assert 20 < np.sum(hit > 0.0) < 80
    assert not struck["b"].any()


def test_outliers_in_runs_are_neighbours_of_one_sign(gap):
    outliers = gap.Outliers({"a": 0.01}, (5.0, 20.0), in_runs=1.0, sign=-1.0, together=False)
    struck = outliers.struck(np.random.default_rng(1), ROWS)["a"]
    assert np.sum(struck != 0.0) == 20
    assert np.sum(runs(struck) == 1) <= 1  # what is left of the share may be a single row
    assert (struck <= 0.0).all()


@pytest.mark.parametrize("together", [True, False])
def test_outliers_of_several_channels_are_in_the_same_rows_or_not(gap, together):
    outliers = gap.Outliers({"a": 0.03, "b": 0.03}, (5.0, 20.0), in_runs=0.3, sign=0.0, together=together)
    struck = outliers.struck(np.random.default_rng(2), ROWS)
    assert bool(((struck["a"] != 0.0) == (struck["b"] != 0.0)).all()) is together
    assert not np.array_equal(struck["a"], struck["b"])


def test_a_drifting_zero_has_the_size_asked_for_and_another_value_in_each_session(gap):
    time, session = np.arange(400.0), np.repeat([1, 2, 3, 4], 100)
    drift = gap.Day(wander={"a": 0.6}, seed=3).zero("a", session, time)
    assert np.sqrt(np.mean(drift**2)) == pytest.approx(0.6)
    assert drift.mean() == pytest.approx(0.0, abs=1e-12)
    jumps = np.abs(np.diff(drift))
    assert set(np.argsort(jumps)[-3:].tolist()) == {99, 199, 299}
    assert gap.Day(wander={"a": 0.6}).zero("b", session, time) == 0.0


def test_heavy_tails_have_unit_variance_and_the_tails_of_students_t(part):
    noise = part("noise").white(np.random.default_rng(0), (400_000,), 5.0)
    assert noise.std() == pytest.approx(1.0, abs=0.01)
    expected = 2.0 * stats.t.sf(4.0 * np.sqrt(5.0 / 3.0), 5.0)
    assert np.mean(np.abs(noise) > 4.0) == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize(
    ("kind", "key"), [("tof_bench", "polynomial_mm"), ("motor_steady", "current_A"), ("motor_step", "omega_rad_s")]
)
def test_good_noise_is_the_stated_one_times_its_factor(gap, part, remade, kind, key):
    none = gap.Outliers(dict.fromkeys(part("disturbances").CHANNELS[kind], 0.0), (5.0, 6.0), 0.0, 0.0, together=False)
    bench = gap.draw_bench(kind, 1, "few" if kind == "motor_step" else "usual")
    case = remade(gap.Case("a", bench, {}, {}, bench.textbook()), gap.Day(noise={key: 1.8}, outliers=none))
    frame, true = (part(kind).frame(bench, case.columns) for bench in (case.bench, case.true_bench))
    error = frame.measured - part(kind).predict(case.bench, case.columns, [case.world])[0]
    channel = frame.sigma != true.sigma
    assert np.nanstd((error / frame.sigma)[channel]) == pytest.approx(1.8, rel=0.1)
    assert true.sigma[channel] == pytest.approx(1.8 * frame.sigma[channel])


@pytest.mark.parametrize("is_last", [True, False])
def test_a_saturation_acts_before_or_after_the_noise(gap, remade, is_last):
    case = gap.make_case("tof_bench", 2, [("range_saturation", {"saturation_m": 0.7})])
    none = gap.Outliers({"reading_m": 0.0}, (5.0, 6.0), 0.0, 0.0, together=False)
    reading = remade(case, gap.Day(clamp_is_last=is_last, outliers=none)).columns
    values = reading["reading_m"][reading["reading_m"] < 8.0]
    assert bool(np.nanmax(values) <= 0.7) is is_last
    assert np.nanmax(values) < 0.72


def test_a_limited_current_is_read_with_the_gain_of_the_ammeter(gap, part):
    effects = [("current_limit", {"limit_A": 0.5}), ("current_sensor_gain", {"gain": 1.2})]
    world = gap.World({}, tuple(gap.Effect(name, numbers) for name, numbers in effects))
    assert part("motor_step")._limits(world) == pytest.approx((-0.6, 0.6))


def test_a_stated_noise_within_a_factor_of_two_shows_nothing(gap):
    """Three times the stated noise, where twice is allowed: n (v - 1 - ln v) with v = (3/2)^2."""
    day = gap.Day(noise_limits=(0.5, 2.0))
    for scale, ratio in ((1.9, 1.0), (3.0, 1.5)):
        case = replace(gap.make_case("tof_bench", 1, [("noise_scale", {"scale": scale})]), day=day)
        reading = case.columns["reading_m"]
        rows = np.sum((case.columns["split"] == "fit") & np.isfinite(reading) & (reading < 8.0))
        expected = rows * (ratio**2 - 1.0 - np.log(ratio**2))
        assert gap.judge(case, with_rivals=False).drops == pytest.approx((expected,), abs=1e-6)


def test_the_judge_takes_the_true_noise_and_the_largest_tolerance(gap, part):
    """As in the narrow family by Woodbury's identity, with noise and tolerances half as large again."""
    day = gap.Day(noise={"polynomial_mm": 1.5}, noise_limits=(0.5, 2.0), tolerance_limit=1.5)
    case = replace(gap.make_case("tof_bench", 4, [("incidence_bias", {"coefficient": 0.04})]), day=day)
    columns, reading = case.columns, case.columns["reading_m"]
    rows = (columns["split"] == "fit") & np.isfinite(reading) & (reading < 8.0)
    sigma = 1.5 * part("tof_bench").sd(columns, [case.bench.textbook()])[0][rows]
    distance, tilt = columns["distance_m"][rows], np.sin(columns["incidence_rad"][rows]) ** 2
    J = 1.5 * np.stack([np.full_like(distance, 0.0005), 0.002 * distance], axis=1)
    shape = 0.04 * distance * tilt
    expected = shape @ np.linalg.solve(np.diag(sigma**2) + J @ J.T, shape)
    verdict = gap.judge(case, with_rivals=False)
    assert verdict.drops == pytest.approx((expected,), rel=1e-3)
    assert verdict.excused == ("noise_scale",)


@pytest.mark.parametrize(
    ("outside", "numbers", "expected"),
    [
        ("zero_jump", {"offset_A": 0.01, "begins_s": 30.0}, ([0.0, 0.0, 0.01], [0.0, 0.0, 0.0])),
        (
            "speed_cycle",
            {"amplitude_rad_s": 0.2, "period_rad_s": 4.0, "phase_rad": 0.0},
            ([0.0, 0.0, 0.0], [0.0, 0.2, -0.2]),
        ),
    ],
)
def test_instruments_with_an_effect_in_no_table(gap, part, outside, numbers, expected):
    """At rest, at 1 and at 3 rad/s."""
    worlds = [gap.World({}), gap.World({}, outsides=(gap.Outside(outside, numbers, (), ()),))]
    current, speed = (np.tile(values, (2, 1)) for values in (np.array([0.5, 0.1, 0.2]), np.array([0.0, 1.0, 3.0])))
    readings = part("motor_steady").instruments(worlds, current, speed, np.array([0.0, 10.0, 40.0]))
    for values, added in zip(readings, expected, strict=True):
        assert values[1] - values[0] == pytest.approx(added, abs=1e-12)


def test_two_effects_in_no_table_act_together(gap, part):
    hidden = {"mode_switch": {"offset_m": 0.01, "from_m": 0.5}, "bumped": {"offset_m": -0.004, "begins_s": 60.0}}
    own = {"range_offset_m": 0.0, "range_scale": 1.0}
    worlds = [gap.World(own), gap.World(own, (), tuple(gap.Outside(n, each, (), ()) for n, each in hidden.items()))]
    inputs = {
        "distance_m": np.array([0.4, 0.6, 0.6]),
        "t_s": np.array([100.0, 0.0, 100.0]),
        "material": np.array(["wood"] * 3),
        "incidence_rad": np.zeros(3),
        "temperature_C": np.full(3, 25.0),
    }
    means = part("tof_bench").mean(inputs, worlds)
    assert means[1] - means[0] == pytest.approx([-0.004, 0.01, 0.006])


def test_an_edge_on_the_floor_shortens_the_left_travel_in_its_circle(gap, part):
    numbers = {"share": 0.1, "x_m": 1.0, "y_m": 1.0, "radius_m": 0.2}
    world = gap.World({}, outsides=(gap.Outside("edge_on_the_floor", numbers, (), ()),))
    travel = part("drive_wheels").ground(world, np.ones((2, 2)), np.zeros((2, 2)), np.array([[1.1, 1.0], [1.3, 1.0]]))
    assert travel == pytest.approx(np.array([[0.9, 1.0], [1.0, 1.0]]))


def test_a_range_jump_is_of_the_front_sensor_from_its_moment_on(gap, part):
    world = gap.World({}, outsides=(gap.Outside("range_jump", {"offset_m": 0.01, "begins_s": 5.0}, (), ()),))
    time = np.array([0.0, 5.0, 9.0])
    assert part("drive_log")._jumped(world, "front", time) == pytest.approx([0.0, 0.01, 0.01])
    assert not part("drive_log")._jumped(world, "left", time).any()


def test_the_two_wide_families_differ_and_nothing_is_drawn_in_the_narrow_one(gap):
    bench = gap.draw_bench("tof_bench", 1)
    assert gap.FAMILIES["narrow"].day(bench.nominal, ["range_scale"], None) == gap.Day()
    a, b = gap.FAMILIES["wide_a"], gap.FAMILIES["wide_b"]
    for name in ("most_outliers", "outlier_sigmas", "runs", "degrees", "tolerance_by_parameter", "wander_sigmas"):
        assert getattr(a, name) != getattr(b, name), name


@pytest.mark.parametrize("family", ["wide_a", "wide_b"])
def test_wide_days_are_within_what_the_format_allows(gap, family):
    for seed in range(40):
        for kind in ("motor_steady", "tof_bench"):
            bench = gap.draw_bench(kind, seed, family=family)
            day = gap.FAMILIES[family].day(bench.nominal, list(bench.spreads()), np.random.default_rng(seed))
            assert all(0.5 <= factor <= 2.0 for factor in day.noise.values())
            assert all(0.7 <= factor <= 1.5 == day.tolerance_limit for factor in day.tolerance.values())
            assert all(0.0 <= share <= 0.06 for share in day.outliers.shares.values())
            assert all(0.3 <= level <= 1.0 for level in day.wander.values())


def test_a_wide_case_is_the_same_for_the_same_seed_and_another_in_the_other_family(gap, tmp_path):
    for name, family in (("a", "wide_a"), ("again", "wide_a"), ("b", "wide_b")):
        outside = gap.outside_names("motor_steady", family)[:2]
        gap.write(gap.make_case("motor_steady", 5, outside=outside, family=family), tmp_path / name)
    texts = {name: (tmp_path / name / "data.csv").read_text() for name in ("a", "again", "b")}
    assert texts["a"] == texts["again"] != texts["b"]


def test_the_noise_of_a_wide_case_is_an_effect_only_beyond_its_limits(gap):
    bench = gap.draw_bench("tof_bench", 1, family="wide_a")
    for seed in range(20):
        scale = gap.draw_effect("noise_scale", bench, seed, family="wide_a").parameters["scale"]
        assert scale > 2.5 or scale < 0.4
    case = gap.make_case("tof_bench", 1, [("noise_scale", None)], family="wide_a")
    assert case.day.noise == {}
