"""Laws that are hidden in benches by their closed form, and found with the numbers that were hidden."""

import json
from collections import defaultdict
from contextlib import contextmanager
from dataclasses import replace
from math import isfinite

import numpy as np
import pytest
import yaml

from configs.effects.base import Slot
from configs.effects.registry import EFFECTS
from diagnosis.case_robot import base_robot_of, nominal_of
from diagnosis.diagnose import diagnose
from diagnosis.discovery.discover import with_law
from diagnosis.discovery.grammar import forms
from diagnosis.discovery.places import places
from diagnosis.discovery.search import FittedLaw
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import at
from diagnosis.inference.naming.file_numbers import file_numbers
from diagnosis.inference.naming.verdict import CaseVerdict
from diagnosis.predictors.motor.steady import MotorSteady
from diagnosis.report.answer import answer
from diagnosis.report.files import files
from diagnosis.report.page import page
from diagnosis.report.report_data import report_data
from diagnosis.report.summary import summary
from pipeline.cli import main
from pipeline.effects.check import load_to_fit
from pipeline.effects.contract import RULES, judged
from pipeline.effects.trial import EffectTrial

NOMINAL = """kind: tof_bench
tof:
  range_offset_m: {value: 0.0, tolerance: 0.001}
  range_scale: {value: 1.0, tolerance: 0.002}
  reference_temperature_C: 25
  resolution_m: 0.0001
  reflectance: {wood: 0.5}
noise: {polynomial_mm: [1.0, 0.0, 0.0, 0.0], polynomial_origin_m: 0.1}
"""
ROWS = 80
LAWS = {
    "threshold": lambda _distance, _lux, time: np.where(time > 90.0, 0.02, 0.0),
    "saturation": lambda _distance, lux, _time: 0.03 * lux / (lux + 400.0),
    "power": lambda _distance, lux, _time: 0.03 * (lux / 4000.0) ** 3,
    "bump": lambda distance, _lux, _time: -0.04 * np.exp(-(((distance - 0.5) / 0.15) ** 2)),
    "other bump": lambda distance, _lux, _time: 0.03 * np.exp(-(((distance - 0.7) / 0.15) ** 2)),
    "memory": lambda distance, _lux, _time: 0.05 * np.diff(distance, prepend=distance[0]) * -1.0,
    "nothing": lambda _distance, _lux, _time: 0.0,
}
"""Error [m] of a reading, by distance [m], light [lux] and time [s]."""
EXPECTED = {
    "threshold": ("range_step_over_time", {"step_m": 0.02}),
    "saturation": ("range_saturation_over_light", {"largest_m": 0.03, "half_lux": 400.0}),
    "memory": ("range_memory_over_step", {"share": 0.05}),
}


def bench(folder, name, seed=7, heldout="same"):
    """Return a bench with one law; its held-out rows may have the opposite of it."""
    noise = np.random.Generator(np.random.PCG64(seed))
    distance = noise.uniform(0.1, 1.0, ROWS).round(3)
    lux = np.exp(noise.uniform(np.log(20.0), np.log(4000.0), ROWS)).round(1)
    time = 2.0 * np.arange(ROWS)
    is_heldout = np.arange(ROWS) % 4 == 3
    sign = np.where(is_heldout & (heldout == "opposite"), -1.0, 1.0)
    reading = distance + sign * LAWS[name](distance, lux, time) + 0.001 * noise.standard_normal(ROWS)
    lines = ["row,split,t_s,distance_m,material,incidence_rad,temperature_C,ambient_lux,reading_m"]
    for row, (t, d, light, value) in enumerate(zip(time, distance, lux, reading, strict=True)):
        split = "holdout" if is_heldout[row] else "fit"
        lines.append(f"{row + 1},{split},{t},{d},,,,{light},{value:.4f}")
    (folder / "nominal.yaml").write_text(NOMINAL)
    (folder / "data.csv").write_text("\n".join(lines) + "\n")
    return read_measurement(folder, IMPORTERS)


@contextmanager
def loaded(path):
    """Have the effect of a file, until the context ends."""
    load_to_fit(path)
    try:
        yield
    finally:
        EFFECTS.unload(path)


def plain(data):
    """Return the printed text without its line breaks."""
    return " ".join(" ".join(summary(data)).split())


@pytest.fixture(scope="module")
def diagnosis_of(tmp_path_factory, diagnosed_among):
    """The diagnosis of a bench with one law, with the search for it; in two of them all effects are tried before."""
    made = {}

    def of(name):
        if name not in made:
            measured = bench(tmp_path_factory.mktemp(name), name)
            before = diagnose(measured) if name in {"saturation", "nothing"} else diagnosed_among(measured)
            made[name] = with_law(before)
            # A law that takes much of the scatter must not turn the conclusion into one that needs no law.
            assert (made[name].conclusion, made[name].scatters) == (before.conclusion, before.scatters)
        return made[name]

    return of


@pytest.mark.parametrize("name", EXPECTED)
def test_a_hidden_law_has_its_structure_and_its_numbers(diagnosis_of, name):
    law = diagnosis_of(name).law
    expected_name, numbers = EXPECTED[name]
    assert law.name == expected_name
    for number, true in numbers.items():
        assert abs(law.values[number] - true) < 3.0 * law.std[number], number
    assert law.left is None
    assert law.gain.low > 0.0
    assert law.gain.after < 1.1  # sigma: what is left is noise
    assert law.gain.before > 2.0


def test_heldout_rows_choose_no_law_but_refuse_one(tmp_path, diagnosis_of, diagnosed_among):
    opposite = with_law(diagnosed_among(bench(tmp_path, "threshold", heldout="opposite"))).discovery
    assert opposite.law is None
    assert diagnosis_of("threshold").law.form.words in opposite.reason
    assert "the cost of the held-out rows rises" in opposite.reason


def test_a_threshold_lies_between_the_rows_where_it_was_hidden(diagnosis_of):
    assert 90.0 <= diagnosis_of("threshold").law.values["edge_s"] <= 94.0


def test_a_threshold_is_as_uncertain_as_the_rows_about_it_are_apart(diagnosis_of):
    """The row between is held out: a place anywhere within 4 s, evenly, has a standard error of 4 s / sqrt(12)."""
    assert diagnosis_of("threshold").law.std["edge_s"] == pytest.approx(4.0 / np.sqrt(12.0))


def test_a_threshold_acts_in_the_rows_beyond_it(diagnosis_of):
    """Row k is at 2 k s, and every fourth row is held out."""
    law = diagnosis_of("threshold").law
    beyond = [row for row in range(ROWS) if 2.0 * row > law.values["edge_s"]]
    heldout = [row for row in beyond if row % 4 == 3]
    assert (law.active.heldout, law.active.all_heldout) == (len(heldout), 20)
    assert (law.active.fitted, law.active.all_fitted) == (len(beyond) - len(heldout), 60)
    (seen,) = law.active.ranges
    assert (seen.low, seen.high) == (2.0 * beyond[0], 158.0)


@pytest.mark.parametrize(("edge_s", "is_same"), [(95.9, True), (60.0, False)])
def test_a_threshold_at_another_row_is_another_number(diagnosis_of, edge_s, is_same):
    diagnosis = diagnosis_of("threshold")
    law = diagnosis.law
    stated = law.form.starting_at({**law.values, "edge_s": edge_s}).with_errors(law.std).candidate
    hypothesis = law.without.hypothesis.with_effect(stated)
    x = diagnosis.fit.x.copy()
    x[hypothesis.parameters(stated)] = [each.coordinate(law.values[each.name]) for each in stated.coordinates]
    fit = at(diagnosis.evidence, hypothesis, x)
    _, edge = file_numbers(diagnosis.evidence, fit, stated, fit.std(stated))
    assert (edge.name, edge.apart <= 3.0) == ("edge_s", is_same)


def test_a_power_law_has_its_exponent(diagnosis_of):
    """The light is scaled by its largest value in the data, which the closed form scales to 4000 lux."""
    law = diagnosis_of("power").law
    assert law.name == "range_power_over_light"
    assert abs(law.values["exponent"] - 3.0) < 3.0 * law.std["exponent"] < 1.0
    largest = law.form.place.covariates["ambient_lux"].high
    assert abs(law.values["largest_m"] - 0.03 * (largest / 4000.0) ** 3) < 3.0 * law.std["largest_m"]


def test_the_law_extends_the_model_and_names_nothing(diagnosis_of):
    diagnosis = diagnosis_of("saturation")
    assert diagnosis.named == ()
    assert diagnosis.conclusion is CaseVerdict.UNEXPLAINED
    assert diagnosis.extended.effects.get(diagnosis.law.effect.kind).largest_m == diagnosis.law.values["largest_m"]
    assert diagnosis.gain.after < 1.1
    assert diagnosis.calibrated.after > 2.0


def test_where_nothing_is_hidden_no_law_is_invented(diagnosis_of):
    diagnosis = diagnosis_of("nothing")
    assert diagnosis.law is None
    assert diagnosis.conclusion is CaseVerdict.EXPLAINED
    assert diagnosis.discovery.reason == "the diagnosis leaves nothing open, so that none is needed"
    assert diagnosis.extended.effects.get(diagnosis_of("power").law.effect.kind) is None
    searched = with_law(diagnosis, always=True).discovery
    assert searched.law is None
    assert "is refused" in searched.reason


def test_the_files_hold_the_law_as_an_effect_that_keeps_the_rules(diagnosis_of, tmp_path):
    diagnosis = diagnosis_of("saturation")
    contents = files(diagnosis)
    assert not EFFECTS.files  # the law is an effect only while the files are written
    result = json.loads(contents["answer.json"])
    assert result["effects"] == []
    assert result["unexplained"] is True
    assert result["discovery"]["file"] == diagnosis.law.file
    assert result["heldout_gain"] == diagnosis.gain.value
    robot = yaml.safe_load(contents["extended.yaml"])
    assert robot["effect_files"] == [diagnosis.law.file]
    assert "rays: 1  # the case has one ray along the axis; without this line" in contents["extended.yaml"].decode()
    for name, content in contents.items():
        if "/" not in name:
            (tmp_path / name).write_bytes(content)
    effect = load_to_fit(tmp_path / diagnosis.law.file)
    values = effect.start().model_dump()
    EFFECTS.unload(tmp_path / diagnosis.law.file)
    assert robot["effects"][diagnosis.law.name] == pytest.approx(values, rel=1e-5)
    page = contents["report.html"].decode()
    assert page.index("A law describes the data and names no cause") < page.index("What was compared")
    assert "plots/law.png" in contents
    assert all(isfinite(value) for value in values.values())


def test_a_law_that_is_given_is_not_written_a_second_time(diagnosis_of, monkeypatch):
    diagnosis = diagnosis_of("saturation")
    law = diagnosis.law
    best = FittedLaw(law.form, diagnosis.fit, law.fall, 0.0, law.fall)
    monkeypatch.setattr("diagnosis.discovery.discover._best", lambda _: (best, "", None))
    with law.registered():
        again = with_law(replace(diagnosis, fit=law.without, discovery=None))
    assert again.law is None
    assert again.discovery.reason.endswith(f"is that of {law.file}, which is given and is not named")


def test_a_further_bench_confirms_the_law_although_the_exact_curve_has_another_shape(
    diagnosis_of, tmp_path, diagnosed_among
):
    """The hidden error is a Gaussian, and the law is not."""
    law = diagnosis_of("bump").law
    assert law.name == "range_bump_over_distance"
    (tmp_path / law.file).write_text(law.text)
    with loaded(tmp_path / law.file):
        again = diagnosed_among(bench(tmp_path, "bump", seed=8), law.name, "range_offset", "range_scale")
        data = report_data(again)
    (named,) = again.named
    assert named.effect.name == law.name
    assert again.conclusion is CaseVerdict.NAMED
    for number in named.file_numbers:
        assert number.value == pytest.approx(law.values[number.name], rel=1e-5)
        assert number.std == pytest.approx(law.std[number.name], rel=0.06)  # two digits
        apart = abs(named.values[number.name] - number.value) / np.hypot(named.std[number.name], number.std)
        assert number.apart == pytest.approx(apart)
        assert number.apart < 3.0, number.name
    assert len(named.file_numbers) == 3
    assert 0.0 <= data.rise_with_file[law.name] < 24.0  # chi-squared of three numbers with the errors of two benches
    assert "The fitted numbers agree with those of the file" in plain(data)


def test_a_bump_of_the_other_sign_at_another_place_does_not_confirm_the_law(diagnosis_of, tmp_path):
    law = diagnosis_of("bump").law
    (tmp_path / law.file).write_text(law.text)
    with loaded(tmp_path / law.file):
        data = report_data(diagnose(bench(tmp_path, "other bump")))
    text, said, html = plain(data), answer(data), page(data, defaultdict(bytes))
    assert f"differs from the nominal one by {law.name} (the same form as in its file, with other numbers)." in text
    assert "these data do not confirm the law of the file" in text
    assert "these data do not confirm the law of the file" in html
    assert "standard errors away" in html
    of_file = said["of_files"][law.name]
    assert of_file["agree"] is False
    assert said["effects"][0]["parameters"]["peak_m"] > 0.0 > of_file["parameters"]["peak_m"]
    assert of_file["standard_errors_apart"]["peak_m"] > 3.0
    assert of_file["cost_rise_if_held"] > said["without"][law.name]["cost_rise"]


def test_data_without_the_bump_contradict_the_numbers_of_the_file(diagnosis_of, tmp_path):
    law = diagnosis_of("bump").law
    (tmp_path / law.file).write_text(law.text)
    with loaded(tmp_path / law.file):
        text = plain(report_data(diagnose(bench(tmp_path, "nothing", seed=8))))
    assert f"Its file has peak_m {law.values['peak_m']:.4f}" in text
    assert "these data contradict them" in text


def test_forms_of_windings_and_gains_keep_the_rules_of_a_text(motor_bench_case, tmp_path):
    measurement = read_measurement(motor_bench_case(tmp_path / "bench", sweeps=4), IMPORTERS)
    robot = nominal_of(measurement, base_robot_of(measurement, None))
    where = places(measurement.kind, Evidence([MotorSteady(measurement, robot)]), robot.motor)
    places_over_time = [place for place in where if place.is_factor or place.slot is Slot.WINDING_HEAT]
    shapes = {"line", "rise", "lag"}
    every = [form for place in places_over_time for form in forms(place, ()) if form.shape in shapes]
    prefixes = ("resistance", "torque_constant", "current_gain", "speed_gain")
    assert {f"{prefix}_line_over_time" for prefix in prefixes} < {form.name for form in every}
    assert "resistance_lag_over_voltage" in {form.name for form in every}
    rules = [rule for rule in RULES if rule.name in {"texts", "bounds", "units"}]
    for form in every:
        assert [v.problem for v in judged(EffectTrial(form.kind), rules) if v.problem] == [], form.name


def test_together_and_discover_are_refused(tmp_path, capsys):
    words = ["diagnose", "table-1", "table-3", "--together", "--discover", "--out", str(tmp_path / "out")]
    assert main(words) == 2
    assert "--together and --discover" in capsys.readouterr().err
