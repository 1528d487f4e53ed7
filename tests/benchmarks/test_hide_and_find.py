"""Scores of made-up answers to made-up cases, and the figures of made-up scores."""

import importlib
import os
import subprocess
import sys
from dataclasses import asdict, replace
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module", autouse=True)
def _scripts_on_the_path():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ROOT / "tests"))
        patch.syspath_prepend(str(ROOT / "benchmarks" / "diagnosis" / "evaluations"))
        yield


@pytest.fixture(scope="module")
def gap():
    return importlib.import_module("gap_cases")


@pytest.fixture(scope="module")
def scoring():
    return importlib.import_module("score")


@pytest.fixture(scope="module")
def bent(gap):
    """An offset that is as good as a bias of the one material there is."""
    return gap.make_case("tof_bench", 1, [("range_offset", {"offset_m": 0.01})], rows="few")


@pytest.fixture(scope="module")
def twice(gap):
    effects = [("temperature_drift", {"coefficient_m_per_K": 0.001}), ("incidence_bias", {"coefficient": 0.1})]
    return gap.make_case("tof_bench", 1, effects)


def named(name, parameters, *ambiguous, std=None):
    return {"name": name, "parameters": parameters, "std": std or {}, "ambiguous_with": list(ambiguous)}


def answer(*effects, where=None):
    found = {"effects": list(effects), "unexplained": where is not None, "heldout_gain": 0.5}
    return found | ({"unexplained_where": dict(zip(("channel", "covariate"), where, strict=True))} if where else {})


OFFSET = named("range_offset", {"offset_m": 0.0102}, std={"offset_m": 0.0001})


@pytest.mark.parametrize(
    ("effects", "right", "exact"),
    [
        ((OFFSET,), True, True),
        ((), False, False),
        ((named("range_scale", {"scale": 1.02}, "range_offset", "log_range_error"),), True, False),
        ((named("range_scale", {"scale": 1.02}, "range_offset", "a", "b"),), False, False),
        ((OFFSET, named("range_scale", {"scale": 1.02})), False, False),
        ((named("material_bias", {"material": "white_paper", "offset_m": 0.01}),), False, True),
        ((named("material_bias", {"material": "wood", "offset_m": 0.01}),), False, False),
    ],
    ids=["right", "nothing", "in its set", "in too large a set", "one too many", "equivalent", "of another material"],
)
def test_one_effect_is_right_by_its_name_or_in_a_small_set(scoring, bent, effects, right, exact):
    result = scoring.score(bent, "single", answer(*effects))
    assert (result.right, result.exact) == (right, exact)


def test_two_effects_are_right_in_either_order_and_only_together(scoring, twice):
    drift = named("temperature_drift", {"coefficient_m_per_K": 0.00101})
    tilt = named("incidence_bias", {"coefficient": 0.099})
    for effects, right in (((drift, tilt), True), ((tilt, drift), True), ((drift,), False), ((drift, drift), False)):
        assert scoring.score(twice, "pair", answer(*effects)).right is right


def test_parameters_are_held_against_their_errors_and_sizes(scoring, bent):
    """0.0102 instead of 0.01: two standard errors of 0.0001, and within a tenth."""
    result = scoring.score(bent, "single", answer(OFFSET))
    assert result.within == (True,)
    far = named("range_offset", {"offset_m": 0.0104}, std={"offset_m": 0.0001})
    assert scoring.score(bent, "single", answer(far)).within == (False,)
    assert scoring.score(bent, "single", answer(named("range_scale", {"scale": 1.0}))).within == ()


def test_large_effects_are_to_be_right_within_a_tenth_of_what_they_differ_by(scoring, gap):
    """1.2 is 0.2 off neutral: 0.02 is a tenth of it."""
    case = gap.make_case("tof_bench", 1, [("range_scale", {"scale": 1.2})])
    for value, close in ((1.219, True), (1.221, False)):
        result = scoring.score(case, "single", answer(named("range_scale", {"scale": value})))
        assert result.drops[0] > scoring.LARGE_DROP
        assert result.close == (close,)


def test_what_is_in_no_table_is_to_be_placed(scoring, gap):
    case = gap.make_case("tof_bench", 1, outside="memory")
    placed = scoring.score(case, "outside", answer(where=("reading_m", "previous_distance_m")))
    assert (placed.unexplained, placed.place, placed.named, placed.gain_error) == (True, True, False, None)
    assert scoring.score(case, "outside", answer(where=("reading_m", "t_s"))).place is False
    assert scoring.score(case, "outside", answer()).place is None
    assert scoring.score(case, "outside", answer(OFFSET)).named


def test_the_gain_is_held_against_the_true_models(scoring, gap, bent):
    gain = gap.judge(bent, with_rivals=False).gain
    assert scoring.score(bent, "single", answer(OFFSET)).gain_error == pytest.approx(abs(gain - 0.5))


def test_a_diagnosis_that_raised_is_a_wrong_one(scoring, bent):
    result = scoring.score(bent, "single", None, 1.0, "Traceback: boom")
    assert (result.right, result.exact, result.failed) == (False, False, "Traceback: boom")


def test_the_figures_count_what_they_say(scoring):
    figures = importlib.import_module("figures")
    single = scoring.Score("single", "tof_bench", right=True, exact=False, within=(True, True, False), gain_error=0.04)
    none = scoring.Score("none", "tof_bench", gain_error=0.06, seconds=3.0)
    failed = replace(none, failed="boom", gain_error=None)
    outside = scoring.Score("outside", "motor_step", unexplained=True, place=False, named=True)
    lines = figures.table([single, replace(single, right=False), none, failed, outside])
    shares = {line[:34].strip(): line[43:].split("(")[0].strip() for line in lines[1:-2]}
    assert shares["one: right name, or in a set of 3"] == "50 % of 2"
    assert shares["one: top name exact"] == "0 % of 2"
    assert shares["none: a name was reported"] == "50 % of 2"
    assert shares["outside: reported as unexplained"] == "100 % of 1"
    assert shares["of those: channel and covariate"] == "0 % of 1"
    assert shares["outside: a name was reported"] == "100 % of 1"
    assert shares["parameters within 3 std errors"] == "67 % of 6"
    assert shares["gain within 0.05 of the true one"] == "50 % of 4"
    assert shares["cases that failed"] == "20 % of 5"
    assert lines[-1].startswith("tof_bench: CPU median 1.50 s, worst 3.00 s")


def test_the_interval_is_wilsons():
    """8 of 10: 0.490 to 0.943, as in Brown, Cai and DasGupta (2001)."""
    assert importlib.import_module("figures").interval(8, 10) == pytest.approx((0.490, 0.943), abs=0.001)


def test_the_mix_is_as_asked_and_longer_runs_begin_alike():
    cases = importlib.import_module("hidden_cases")
    plans = cases.plans(400, 1, list(cases.KINDS))
    shares = {
        kind: sum(plan.category == kind for plan in plans) / 400 for kind in ("single", "pair", "none", "outside")
    }
    assert shares == {"single": 0.4, "pair": 0.25, "none": 0.15, "outside": 0.2}
    assert plans[:30] == cases.plans(30, 1, list(cases.KINDS))


def test_a_planned_case_is_detectable_and_comes_out_the_same(gap):
    cases = importlib.import_module("hidden_cases")
    plan = cases.Plan(7, "single", "tof_bench", 3, 1)
    case = cases.hidden_case(plan)
    assert gap.judge(case, with_rivals=False).drops[0] > gap.DETECTABLE
    assert cases.hidden_case(plan).world == case.world


def test_our_packages_are_not_hidden_by_folders_of_tests_of_the_same_name(tmp_path):
    """As the script is started, from anywhere: tests/configs is no package, and yet comes before an installed one."""
    evaluations = str(ROOT / "benchmarks" / "diagnosis" / "evaluations")
    script = f"import sys; sys.path.insert(0, {evaluations!r}); import hidden_cases, score; import diagnosis.diagnose"
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    ended = subprocess.run(
        [sys.executable, "-c", script], cwd=tmp_path, env=kept, capture_output=True, text=True, check=False
    )
    assert ended.returncode == 0, ended.stderr


def named_by(scoring, case, *effects):
    return scoring.score(case, "none", answer(*effects))


def test_a_wrong_stated_noise_may_be_named_and_only_on_its_side(scoring, gap):
    """Neither right nor wrong where the noise is 1.7 times what is stated; another name is a false one all the same."""
    case = replace(gap.make_case("tof_bench", 1), day=gap.Day(noise={"polynomial_mm": 1.7}))
    larger, smaller = (named("noise_scale", {"scale": scale}) for scale in (1.6, 0.6))
    for effects, excused, is_named in (((larger,), 1, False), ((smaller,), 0, True), ((larger, OFFSET), 1, True)):
        result = named_by(scoring, case, *effects)
        assert (result.excused, result.named) == (excused, is_named)
    assert named_by(scoring, gap.make_case("tof_bench", 1), larger).named


def test_what_the_day_did_beside_a_hidden_effect_leaves_its_name_right(scoring, gap):
    case = gap.make_case("tof_bench", 1, [("range_offset", {"offset_m": 0.01})])
    case = replace(case, day=gap.Day(noise={"polynomial_mm": 1.7}, wander={"reading_m": 0.5}))
    noise, wander = named("noise_scale", {"scale": 1.8}), named("range_wander", {"sd_m": 0.001})
    result = scoring.score(case, "single", answer(OFFSET, noise, wander))
    assert (result.right, result.exact, result.excused) == (True, True, 2)


def test_names_are_counted_with_their_confidence(scoring, bent):
    """A bias of the one material is no wrong name, but it is not what was hidden."""
    alike = named("material_bias", {"material": "white_paper", "offset_m": 0.01}) | {"confidence": 0.4}
    wrong = named("range_saturation", {"saturation_m": 0.8}) | {"confidence": 0.9995}
    result = scoring.score(bent, "single", answer(OFFSET | {"confidence": 0.6}, alike, wrong))
    assert result.confidences == (0.6, 0.4, 0.9995)
    assert result.name_hits == (True, False, False)
    assert result.name_alike == (True, True, False)


def test_either_of_two_effects_in_no_table_may_be_placed(scoring, gap):
    case = gap.make_case("tof_bench", 1, outside=["memory", "bumped"])
    for covariate, placed in (("previous_distance_m", True), ("t_s", True), ("temperature_C", False)):
        assert scoring.score(case, "outside", answer(where=("reading_m", covariate))).place is placed


@pytest.fixture
def sure(scoring):
    """Ten names at 97 %, nine of them right, and one at 99.95 % that is wrong."""
    hits = (True,) * 9 + (False, False)
    return scoring.Score("single", "tof_bench", confidences=(0.97,) * 10 + (0.9995,), name_hits=hits, name_alike=hits)


def test_the_reliability_table_has_the_share_of_right_names_in_each_bin(sure):
    """9 of 10 is 0.596 to 0.982 by Wilson's formula."""
    reliability = importlib.import_module("reliability")
    header, *lines = reliability.reliability_table(reliability.names_of([sure]))
    assert header.split()[:2] == ["stated", "confidence"]
    assert [line.split() for line in lines] == [
        ["95", "to", "99", "%", "10", "97.0%", "9", "90.0", "%", "(59.6-98.2)", "9"],
        ["99.9", "%", "and", "over", "1", "100.0%", "0", "0.0", "%", "(0.0-79.3)", "0"],
    ]


def test_the_reliability_diagram_shows_shares_beside_confidences(sure):
    reliability = importlib.import_module("reliability")
    (axes,) = reliability.reliability_figure(reliability.names_of([sure]), "x").axes
    heights = {line.get_label(): line.get_ydata() for line in axes.lines}
    assert heights["mean stated confidence"] == pytest.approx([0.97, 0.9995])
    assert axes.containers[0].lines[0].get_ydata() == pytest.approx([0.9, 0.0])


def test_a_name_that_was_over_99_9_percent_sure_and_wrong_is_counted(sure):
    lines = importlib.import_module("figures").table([sure])
    (line,) = [line for line in lines if line.startswith("names over 99.9 % sure: wrong")]
    assert line[43:].split("(")[0].strip() == "100 % of 1"


def test_half_a_line_of_a_run_that_was_killed_is_left_out(scoring, tmp_path):
    script = importlib.import_module("hide_and_find")
    path, one = tmp_path / "cases.jsonl", scoring.Score("single", "tof_bench", truth=("range_offset",), right=True)
    script._append(path, {"case": "a", **asdict(one)})
    with path.open("a") as opened:
        opened.write('{"case": "b", "categ')
    script._append(path, {"case": "c", **asdict(one)})
    assert script.read(path) == {"a": one, "c": one}


def test_cases_that_went_wrong_in_one_run_only_are_listed(scoring):
    script = importlib.import_module("hide_and_find")
    good = scoring.Score(
        "single", "tof_bench", truth=("range_offset",), right=True, answer="range_offset", sizes=("offset_m=0.01",)
    )
    bad = replace(good, right=False, answer="nothing")
    other = replace(bad, sizes=("offset_m=0.02",))  # as of another seed
    before = {"a": good, "b": bad, "c": good, "e": good}
    lines = script.differences(before, {"a": bad, "b": good, "c": good, "d": bad, "e": other})
    assert lines == [
        "3 cases in common, 2 of them right in only one run",
        "worse a: range_offset -> nothing",
        "  before: range_offset",
        "better b: range_offset -> range_offset",
        "  before: nothing",
    ]


def test_wide_plans_are_detectable_too(gap):
    """By the true noise, and with tolerances as large as they may be."""
    cases = importlib.import_module("hidden_cases")
    case = cases.hidden_case(cases.Plan(3, "outside", "tof_bench", 0, 1, "wide_b"))
    assert gap.judge(case).nameless > gap.NAMELESS
    assert case.day.tolerance_limit == 1.5


def test_a_case_that_was_judged_before_is_made_and_scored_alike(scoring, tmp_path):
    cases, script = (importlib.import_module(name) for name in ("hidden_cases", "hide_and_find"))
    plan = cases.Plan(7, "single", "tof_bench", 3, 1, "wide_a")
    case, judged = cases.judged_case(plan, {})
    script._append(tmp_path / "verdicts.jsonl", asdict(judged))
    known = script._known(tmp_path / "verdicts.jsonl")
    again, known_judged = cases.judged_case(plan, known)
    assert again.world == case.world
    scores = [scoring.score(case, "single", answer(OFFSET), verdict=each.verdict) for each in (judged, known_judged)]
    assert scores[0] == scores[1]
    assert cases.judged_case(replace(plan, seed=2), known)[1].plan not in known


def test_what_the_day_did_is_noted_in_words(scoring, gap):
    outliers = gap.Outliers({"a": 0.03, "b": 0.0}, (5.0, 20.0), in_runs=0.5, sign=0.0, together=False)
    day = gap.Day(noise={"a": 0.7}, correlation=0.2, tolerance={"b": 1.1}, wander={"a": 0.5}, outliers=outliers)
    assert scoring.traits(gap.Day()) == ()
    assert scoring.traits(day) == (
        "over 2 % outliers",
        "outliers in runs",
        "noise over 1.3 off",
        "correlated",
        "drifting zero",
    )


def test_cases_with_and_without_something_are_counted_apart(scoring):
    right = scoring.Score("single", "tof_bench", right=True)
    scores = [right, replace(right, day=("drifting zero",)), replace(right, right=False, day=("drifting zero",))]
    (line,) = importlib.import_module("figures").by_day(scores)[1:]
    assert line.split("(")[0].split() == ["drifting", "zero", "50", "%", "of", "2"]
    assert line[34:].split(")")[1].split("(")[0].strip() == "100 % of 1"
