"""Why a difference that the parameters of the nominal robot account for has no name."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.selection.stepwise import Entry
from diagnosis.report.sentences.verdict.no_name import why_no_name
from physics.effects.motor_and_gearbox.winding_resistance_scale import WindingResistanceScale


@pytest.fixture
def moved(diagnosis_of):
    """The bench without any effect, as if the fit had moved its parameters, and an effect had been refused."""

    def of(tolerances, drop=0.0):
        plain = diagnosis_of("plain")
        names = [nuisance.name for nuisance in plain.fit.hypothesis.nuisances]
        x = np.array([tolerances.get(name, 0.0) for name in names])
        entries = [Entry(CandidateEffect(WindingResistanceScale), drop, accepted=False, reason="")] if drop else []
        selection = replace(plain.selection, entries=tuple(entries))
        return replace(plain, fit=replace(plain.fit, x=x), selection=selection)

    return of


def test_parameters_that_took_the_place_of_an_effect_are_listed_the_furthest_first(moved):
    diagnosis = moved({"coulomb_friction_N_m": -1.2, "winding_resistance_ohm": 2.0}, drop=4.5)
    numbers = {n.name: 100.0 * n.tolerance / n.value for n in diagnosis.fit.hypothesis.nuisances}
    text = why_no_name(diagnosis)
    assert text.startswith("Parameters of the nominal robot, which are known only to their tolerances, account for")
    # Two tolerances of a logarithm.
    values = {n.name: n.value for n in diagnosis.fit.hypothesis.nuisances}
    resistance = 100.0 * np.expm1(0.02 * numbers["winding_resistance_ohm"])
    ohm = values["winding_resistance_ohm"] * (1.0 + 0.01 * resistance)
    how_far = f"2.0 tolerances of {numbers['winding_resistance_ohm']:.2g} %"
    assert f"winding_resistance_ohm by {resistance:+.2g} % to {ohm:.4g} ohm ({how_far}) and coulomb_friction" in text
    assert "winding_resistance_scale would lower the cost by 4.5 only, and a name needs 19." in text


def test_the_instrument_that_would_decide_is_named(moved):
    text = why_no_name(moved({"winding_resistance_ohm": 2.0}))
    assert text.endswith(
        "A nominal.yaml with smaller tolerances would decide: measure winding_resistance_ohm with an ohmmeter."
    )
    text = why_no_name(moved({"rotor_inertia_kg_m2": 2.0, "coulomb_friction_N_m": -1.2}))
    assert text.endswith("A nominal.yaml with smaller tolerances would decide, if some numbers are known better.")


def test_what_the_headline_leaves_open_is_not_repeated(moved):
    text = why_no_name(moved({"winding_resistance_ohm": 2.0}, drop=13.5))
    assert "account for a part of the difference: the fit moves winding_resistance_ohm by" in text
    assert "winding_resistance_scale" not in text


def test_a_fit_within_a_tolerance_needs_no_sentence(moved):
    assert why_no_name(moved({"winding_resistance_ohm": 0.9}, drop=4.5)) == ""


def test_beside_a_name_or_something_unexplained_there_is_no_such_sentence(diagnosis_of):
    assert [why_no_name(diagnosis_of(name)) for name in ("weak", "bumped")] == ["", ""]
