"""What the page of a trial says of the explanations that remain."""

from types import SimpleNamespace
from typing import Any

import pytest

from diagnosis.next_trial import text
from diagnosis.next_trial.text import _purpose, hindrance_lines


@pytest.mark.parametrize(
    ("name", "begin"),
    [
        ("turn_slip", "Only turn_slip remains. This trial determines its parameters as"),
        (
            "pose_time_offset and turn_slip and supply_sag",
            "Only pose_time_offset, turn_slip and supply_sag remain. This trial determines their parameters as",
        ),
    ],
)
def test_effects_of_the_only_model_are_listed_as_a_sentence(name, begin):
    design: Any = SimpleNamespace(models=[SimpleNamespace(name=name)])
    assert _purpose(design).startswith(begin)


def test_a_number_to_measure_comes_before_a_trial_that_separates_little(monkeypatch):
    """The diagnosis knows that an ohmmeter would decide; the rows of the trial would not."""
    decides = "A nominal.yaml with smaller tolerances would decide: measure winding_resistance_ohm with an ohmmeter."
    monkeypatch.setattr(text, "why_no_name", lambda _diagnosis: decides)
    smallest = SimpleNamespace(separation=0.3, truth="no effect", rival="current_sensor_gain")
    design: Any = SimpleNamespace(diagnosis=None, expected=SimpleNamespace(smallest=smallest), hindrances=(), models=())
    lines = list(hindrance_lines(design))
    assert lines[:2] == [decides, ""]
    assert lines[2].startswith("No trial within the limits distinguishes no effect from current_sensor_gain")
    smallest.separation = 5.0
    assert list(hindrance_lines(design)) == []
