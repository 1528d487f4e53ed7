"""Parameters that the fit leaves far outside their tolerances are stated, whatever is named."""

from collections import defaultdict
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from diagnosis.nuisances import command_timing
from diagnosis.report.answer import answer
from diagnosis.report.page import page
from diagnosis.report.sentences.verdict.headline import headline
from diagnosis.report.sentences.verdict.no_name import why_no_name
from diagnosis.report.sentences.verdict.parameters_off import furthest_by_chance, off_sentences, parameters_off
from diagnosis.report.summary import summary


def moved(diagnosis, tolerances):
    """Return the diagnosis as if the fit had moved parameters by these numbers of tolerances."""
    names = [nuisance.name for nuisance in diagnosis.fit.hypothesis.nuisances]
    x = diagnosis.fit.x.copy()
    x[: len(names)] = [tolerances.get(name, 0.0) for name in names]
    return replace(diagnosis, fit=replace(diagnosis.fit, x=x))


@pytest.mark.parametrize("count", [1, 4, 10])
def test_a_robot_within_its_tolerances_has_such_a_parameter_in_1_percent_of_cases(count):
    limit = furthest_by_chance(count)
    assert 1.0 - (1.0 - 2.0 * norm.sf(limit)) ** count == pytest.approx(0.01, rel=0.01)


@pytest.mark.parametrize("name", ["plain", "weak"])
def test_a_fit_within_the_tolerances_has_no_such_parameter(name, diagnosis_of):
    assert off_sentences(diagnosis_of(name)) == ""


def test_a_parameter_beside_a_name_is_stated_with_both_values_and_its_unit(diagnosis_of):
    diagnosis = moved(diagnosis_of("weak"), {"winding_resistance_ohm": 4.0, "viscous_friction_N_m_s": 0.5})
    (off,) = parameters_off(diagnosis.fit)
    (nuisance,) = [each for each in diagnosis.fit.hypothesis.nuisances if each.name == "winding_resistance_ohm"]
    assert off.fitted == pytest.approx(nuisance.value * np.exp(4.0 * nuisance.tolerance / nuisance.value))
    text = off_sentences(diagnosis)
    assert text.startswith(
        "A number of the nominal robot seems to be wrong by more than the tolerance, beside what is named: "
    )
    assert f" ohm, not {nuisance.value:.4g} ohm (+4.0 tolerances of {nuisance.tolerance:.2g} ohm)." in text
    three = replace(diagnosis, named=3 * diagnosis.named)
    assert off_sentences(three).endswith("At most 3 effects are named, so that it has no name here.")


def test_where_something_is_unexplained_a_number_may_only_stand_in_for_it(diagnosis_of):
    text = off_sentences(moved(diagnosis_of("bumped"), {"winding_resistance_ohm": 4.0}))
    assert text.endswith("What stays unexplained may be the cause.")


def test_every_file_of_the_answer_has_it(findings_of):
    data = findings_of("plain")
    data = replace(data, diagnosis=moved(data.diagnosis, {"winding_resistance_ohm": -5.0}))
    assert headline(data.diagnosis) == (
        "No effect is needed to explain these data, but numbers of the nominal robot seem to be wrong."
    )
    (entry,) = answer(data)["parameters_off"]
    assert (entry["name"], entry["unit"], entry["tolerances"]) == ("winding_resistance_ohm", "ohm", -5.0)
    assert "winding_resistance_ohm is " in " ".join(summary(data))
    plots = defaultdict(bytes)
    html = page(data, plots)
    assert html.count("winding_resistance_ohm is ") == 2
    assert "<p>Beside these numbers, nothing" in html


def test_without_such_a_parameter_nothing_is_off(findings_of):
    assert answer(findings_of("plain"))["parameters_off"] == []


def test_a_number_that_no_file_states_is_explained(diagnosis_of):
    plain = diagnosis_of("plain")
    hypothesis = replace(plain.fit.hypothesis, nuisances=(command_timing(), *plain.fit.hypothesis.nuisances[1:]))
    diagnosis = moved(replace(plain, fit=replace(plain.fit, hypothesis=hypothesis)), {"command_timing_s": 4.0})
    text = off_sentences(diagnosis)
    assert text.startswith(
        "A number of the log seems to be wrong by more than the tolerance: command_timing_s, the time"
    )
    assert "(no nominal.yaml has it; its tolerance is assumed), is 0.0020" in text
    assert "nominal.yaml with smaller tolerances" not in why_no_name(diagnosis)
    assert "command_timing_s by +4.0 tolerances of 0.0005 s" in why_no_name(diagnosis)
