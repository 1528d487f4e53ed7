"""What the page of a trial says of the explanations that remain."""

from types import SimpleNamespace
from typing import Any

import pytest

from diagnosis.next_trial.text import _purpose


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
