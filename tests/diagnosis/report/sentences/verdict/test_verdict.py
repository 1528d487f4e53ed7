"""What the report says of a name that is not certain, and of errors of simple form."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from diagnosis.inference.gain import Gain, gain_of_sizes
from diagnosis.inference.log_score import LogScoreChange
from diagnosis.inference.naming.verdict import CaseVerdict
from diagnosis.inference.selection.rivals import FORM
from diagnosis.report.report_data import Ablation
from diagnosis.report.sentences.effects.hints import hints
from diagnosis.report.sentences.effects.named import certainty
from diagnosis.report.sentences.quantities import gain_text
from diagnosis.report.sentences.verdict.gain import _gain_clause, gain_sentences, without_effect
from diagnosis.report.sentences.verdict.headline import headline, no_effect
from diagnosis.report.sentences.verdict.unexplained import nothing_left, unexplained_sentence


def said(confidence, *others, is_whole=True, rivals=(), by_chance=30.0):
    comparison = SimpleNamespace(
        confidence=confidence,
        others=others,
        is_whole=is_whole,
        rivals=rivals,
        ambiguous_with=(),
        by_chance=by_chance,
    )
    named: Any = SimpleNamespace(comparison=comparison)
    return certainty(named)


RIVAL = SimpleNamespace(effect=SimpleNamespace(name="speed_scale"), worse=9.0)


@pytest.mark.parametrize(
    ("others", "text"),
    [
        ([("supply_sag and quadratic_drag together", 3.0)], "supply_sag and quadratic_drag together would explain the"),
        ([(FORM, 5.0)], "an error of simple form, whose cause is in no list, would explain the data nearly as well"),
        (
            [(FORM, 10.0)],
            "; the rest is shared by the closest alternative (speed_scale, with which the cost is higher by 9.0), an",
        ),
    ],
)
def test_a_name_that_is_not_certain_says_what_else_it_may_be(others, text):
    assert text in said(0.7, *others, rivals=[RIVAL])


def test_a_name_near_chance_says_where_the_rest_of_the_confidence_is():
    assert said(0.436, (FORM, 30.0), rivals=[RIVAL], by_chance=1.0) == (
        "43.6 %; the rest is shared by chance (the cost falls little more than a name needs), the closest "
        "alternative (speed_scale, with which the cost is higher by 9.0) and causes that are in no list"
    )


def test_a_name_with_an_alternative_says_how_much_worse_it_is():
    assert said(0.95, (FORM, 30.0), rivals=[RIVAL]) == (
        "95 %; the closest alternative, speed_scale, explains the data worse: the cost is higher by 9.0"
    )


def test_an_effect_that_was_tried_twice_is_one_hint():
    """A name with one number needs a fall of 19, as docs/diagnosis_report.md states."""
    effect = SimpleNamespace(name="friction_asymmetry", kind=SimpleNamespace(slot=None), coordinates=(None,))
    entries = [SimpleNamespace(effect=effect, drop=drop) for drop in (13.2, 14.1, 2.0)]
    diagnosis: Any = SimpleNamespace(selection=SimpleNamespace(refused=entries))
    assert list(hints(diagnosis)) == [("friction_asymmetry", 14.1, pytest.approx(19.0 / 14.1))]


def test_a_name_that_is_nearly_certain_says_nothing_of_what_is_far_away():
    assert said(0.97, (FORM, 30.0)) == "97 %; no other effect comes close"


def test_a_name_beside_something_unexplained_says_so():
    assert "what stays unexplained" in said(0.7, (FORM, 30.0), is_whole=False, rivals=[RIVAL])


@pytest.mark.parametrize(
    ("what", "text"),
    [
        (
            "kink, changing sign with the reading",
            "a straight line that begins at one value of commanded voltage, changing",
        ),
        ("bump", "a bump around one value of commanded voltage)"),
        ("trend, changing sign with it", "a smooth curve over commanded voltage, changing sign with it)"),
        (
            "place, with the sign of the motion",
            "an error that depends on the place, with the sign of the motion)",
        ),
        ("outliers at neighbouring values", "(outliers at neighbouring values of commanded voltage)"),
        ("runs of rows", "(successive rows that are off together)"),
        ("patch", "(motion that wheels lose or gain on a patch of the floor)"),
        ("lost counts", "(counts that an encoder loses or adds at one angle of its wheel)"),
    ],
)
def test_the_form_of_what_is_unexplained_is_said_in_words(what, text):
    structure: Any = SimpleNamespace(covariate="u_cmd_V", what=what, p=1e-5, quantities=("current_A",), size=0.5)
    assert text in unexplained_sentence(structure)


def test_a_load_of_turning_is_said_in_words_with_its_size():
    what = "torque against the turn, in proportion to its rate"
    structure: Any = SimpleNamespace(
        covariate="turn_rad_s", what=what, p=1e-13, quantities=("wheel_speed_rad_s[left]",), size=0.254
    )
    assert unexplained_sentence(structure) == (
        "The residuals of wheel_speed_rad_s[left] have structure along turn_rad_s, the rate of turning (as from a"
        " torque against the turn, in proportion to its rate). Its root mean square is 0.25 standard deviations of the"
        " noise, and the probability of it by chance is less than 1e-12."
    )


@pytest.mark.parametrize(
    ("p", "text"),
    [
        (
            0.017,
            "current_A and omega_rad_s may depend on u_cmd_V (p = 0.017), but structure counts as such only if p is",
        ),
        (
            0.4,
            "Nothing: no covariate shows more structure in the residuals than is expected by chance (smallest p-value",
        ),
        (None, "than is expected by chance."),
    ],
)
def test_what_is_left_agrees_with_the_headline(p, text):
    structures = (
        [] if p is None else [SimpleNamespace(quantities=("current_A", "omega_rad_s"), covariate="u_cmd_V", p=p)]
    )
    diagnosis: Any = SimpleNamespace(adequacy=SimpleNamespace(structures=structures))
    assert text in nothing_left(diagnosis)


@pytest.mark.parametrize(
    ("names", "conclusion", "text"),
    [
        ((), CaseVerdict.EXPLAINED, "No effect is named: none is needed to explain these data."),
        (
            (),
            CaseVerdict.UNDECIDED,
            "No effect is named: something may differ, but these data do not suffice to name it.",
        ),
        ((), CaseVerdict.UNEXPLAINED, "No effect is named: no known effect explains these data."),
        (("range_wander",), CaseVerdict.NAMED, "No other effect is named."),
    ],
)
def test_the_page_says_why_no_effect_is_named(names, conclusion, text):
    diagnosis: Any = SimpleNamespace(names=names, conclusion=conclusion)
    assert no_effect(diagnosis) == text


def test_a_scatter_is_said_of_the_readings_and_of_no_covariate():
    structure: Any = SimpleNamespace(
        observed="reading_m",
        channel="reading_m",
        covariate="distance_step_m",
        what="scatter of 1.7 times the stated noise",
        p=1e-4,
    )
    text = unexplained_sentence(structure)
    assert text.startswith("The residuals of reading_m have a scatter of 1.7 times the stated noise, and no covariate")
    assert "distance" not in text
    for nominal, noise in ((None, "the stated noise"), (object(), "the noise that nominal.yaml states")):
        verdict: Any = SimpleNamespace(
            names=(),
            unexplained=structure,
            adequacy=SimpleNamespace(leaves_only_outliers=False),
            measurement=SimpleNamespace(nominal=nominal, checks=()),
        )
        assert headline(verdict) == (
            f"The simulation is wrong in a way that has no name here: reading_m has a scatter of 1.7 times {noise}, "
            "and no known effect explains this."
        )


def test_a_warning_about_the_log_is_named_as_the_likely_cause():
    structure: Any = SimpleNamespace(observed="tof_left_m", channel="tof_m", covariate="distance_m", what="trend")
    diagnosis: Any = SimpleNamespace(
        names=(),
        unexplained=structure,
        adequacy=SimpleNamespace(leaves_only_outliers=False),
        measurement=SimpleNamespace(nominal=None, checks=("CHECK x_m and y_m: 455 of 801 poses are outside",)),
    )
    assert headline(diagnosis) == (
        "The simulation and these data do not fit together: tof_m depends on distance_m; the warning about the log "
        "names a likely cause. Correct that first."
    )


@pytest.mark.parametrize(
    ("names", "begin"),
    [
        ((), "No effect is named, but"),
        (("turn_slip",), "The real robot differs from the nominal one by turn_slip; in addition,"),
    ],
)
def test_outliers_in_successive_rows_alone_are_not_called_a_wrong_simulation(names, begin):
    structure: Any = SimpleNamespace(observed="tof_left_m", channel="tof_m", covariate="t_s", what="runs of rows")
    adequacy = SimpleNamespace(leaves_only_outliers=True)
    diagnosis: Any = SimpleNamespace(names=names, named=(), unexplained=structure, adequacy=adequacy)
    rows = "successive rows of tof_left_m are far off together, as the logger alone may cause it"
    assert headline(diagnosis) == f"{begin} {rows}."


def test_a_calibration_that_predicts_worse_gains_nothing():
    """A gain of -0.3 is an error that is 30 % larger."""
    assert _gain_clause(Gain(-0.3, -0.759, 0.714, 7.71, 10.0, ())) == (
        "makes the error on the held-out rows 30 % larger (95 % interval of the gain -75.9 % to 71.4 %)"
    )


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (LogScoreChange(0.84, 0.2, 1.5), "raises the log-likelihood of a held-out reading by 0.84 on average"),
        (LogScoreChange(-0.1, -0.3, 0.1), "lowers the log-likelihood of a held-out reading by 0.1 on average"),
    ],
)
def test_an_effect_of_the_noise_is_judged_by_the_likelihood_of_the_readings(change, text):
    gain = Gain(0.0, -0.1, 0.1, 1.2, 1.2, ())
    hypothesis = SimpleNamespace(nuisances=(), prior=lambda _: np.zeros(0))
    fit: Any = SimpleNamespace(hypothesis=hypothesis, x=None)
    ablation = Ablation("noise_scale", fit, 39.5, gain, gain, change, is_of_noise=True)
    said_of_it = without_effect(ablation, fit)
    assert text in said_of_it
    assert "gain" not in said_of_it


def fit_with(**deviations: float) -> Any:
    nuisances = [SimpleNamespace(name=name) for name in deviations]
    hypothesis = SimpleNamespace(nuisances=nuisances, prior=lambda _: np.array(list(deviations.values())))
    return SimpleNamespace(hypothesis=hypothesis, x=None)


def test_numbers_that_are_as_far_off_with_an_effect_are_not_said_to_be_so_without_it():
    gain = Gain(0.5, 0.4, 0.6, 2.0, 1.0, ())
    ablation = Ablation(
        "turn_slip", fit_with(range_offset_m=9.0, track_m=-5.0), 20.0, None, gain, None, is_of_noise=False
    )
    text = without_effect(ablation, fit_with(range_offset_m=8.9, track_m=0.5))
    assert text == "the cost rises by 20.0, and parameters leave their tolerances (track_m by 5 tolerances)"


def test_a_model_of_which_no_parameter_moved_changes_nothing():
    sizes = np.tile(np.linspace(0.1, 2.0, 250), (2, 1))
    unchanged = gain_of_sizes([(sizes, np.arange(250) // 50)])
    assert _gain_clause(unchanged) == "changes nothing on the held-out rows"
    assert gain_text(unchanged) == "0 % (no change)"


def test_held_out_rows_that_every_robot_predicts_say_nothing():
    """The rows of a robot that stands still are predicted exactly, with errors of 0 to 0 sigma."""
    nothing = Gain(0.0, -1.65, 0.0, 0.0, 0.0, ())
    data: Any = SimpleNamespace(diagnosis=SimpleNamespace(gain=nothing, calibrated=nothing))
    (sentence,) = gain_sentences(data)
    assert sentence.startswith("The held-out rows say nothing")
    assert "0 sigma" not in sentence
    hypothesis = SimpleNamespace(nuisances=(), prior=lambda _: np.zeros(0))
    fit: Any = SimpleNamespace(hypothesis=hypothesis, x=None)
    change = LogScoreChange(0.0, 0.0, 0.0)
    ablation = Ablation("friction_warmup", fit, 13.2, nothing, nothing, change, is_of_noise=False)
    assert without_effect(ablation, fit) == "the cost rises by 13.2; the held-out rows say nothing about it"


@pytest.mark.parametrize(
    ("conclusion", "gain", "follows"),
    [
        (
            CaseVerdict.EXPLAINED,
            -0.57,
            ": where nothing is wrong, such a fit only follows the noise",
        ),
        (CaseVerdict.EXPLAINED, 0.09, "."),
        (CaseVerdict.UNEXPLAINED, -0.57, "."),
    ],
)
def test_a_calibration_that_makes_things_worse_where_nothing_is_wrong_is_explained(conclusion, gain, follows):
    hypothesis = SimpleNamespace(nuisances=(), prior=lambda _: np.zeros(0))
    change = Gain(gain, gain - 0.2, gain + 0.2, 1.0, 1.0 - gain, ())
    diagnosis = SimpleNamespace(
        gain=change,
        calibrated=change,
        conclusion=conclusion,
        fitted_effects=(),
        selection=SimpleNamespace(nominal=SimpleNamespace(hypothesis=hypothesis, x=None)),
    )
    data: Any = SimpleNamespace(diagnosis=diagnosis)
    (sentence,) = gain_sentences(data)
    assert sentence.partition(")")[2].startswith(follows)
