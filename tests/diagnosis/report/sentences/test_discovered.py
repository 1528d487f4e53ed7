"""Sentences about a proposed law."""

from types import SimpleNamespace
from typing import Any

import pytest

from diagnosis.inference.gain import Gain
from diagnosis.report.sentences.discovered import sentences

NUMBER = SimpleNamespace(name="step_m", unit="m")


def evidence(heldout_fall):
    gain = Gain(0.008, -0.001, 0.02, before=3.8, after=3.77, by_quantity=())
    form = SimpleNamespace(words="a step of the range", numbers=(NUMBER,))
    law: Any = SimpleNamespace(
        form=form, file="law.py", is_curve=False, values={"step_m": 0.02}, std={"step_m": 0.001}, fall=80.0,
        heldout_fall=heldout_fall, gain=gain, chance=1 / 200, forms_tried=44, ranges={}, rivals=(), left=None,
    )  # fmt: skip
    discovery: Any = SimpleNamespace(law=law)
    return next(text for text in sentences(discovery) if text.startswith("The cost falls"))


@pytest.mark.parametrize(
    ("heldout_fall", "text"),
    [
        (3.0, "so that the held-out rows alone do not show it"),
        (362.0, "which outliers hide, or the law matters in few of these rows"),
    ],
)
def test_a_gain_that_may_be_none_is_explained_by_what_the_cost_of_the_same_rows_shows(heldout_fall, text):
    """The cost takes rows far off for outliers; the root mean square does not."""
    assert text in evidence(heldout_fall)
