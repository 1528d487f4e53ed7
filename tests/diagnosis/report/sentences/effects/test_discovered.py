"""Sentences about a proposed law."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from diagnosis.discovery.active_samples import ActiveSamples
from diagnosis.inference.gain import Gain
from diagnosis.inference.naming.seen_range import SeenRange
from diagnosis.report.sentences.effects.discovered import sentences

NUMBER = SimpleNamespace(name="step_m", unit="m")


ACTIVE = ActiveSamples(33, 178, 5, 60, (SeenRange("x_m", 0.65, 1.15), SeenRange("y_m", 0.2, 0.5)))


def texts(heldout_fall, active=None):
    gain = Gain(0.008, -0.001, 0.02, before=3.8, after=3.77, by_quantity=())
    form = SimpleNamespace(words="a step of the range", numbers=(NUMBER,))
    law: Any = SimpleNamespace(
        form=form, file="law.py", is_curve=False, values={"step_m": 0.02}, std={"step_m": 0.001}, fall=80.0,
        heldout_fall=heldout_fall, gain=gain, chance=1 / 200, forms_tried=44, ranges={}, rivals=(), left=None,
        active=active,
    )  # fmt: skip
    discovery: Any = SimpleNamespace(law=law)
    return list(sentences(discovery))


def evidence(heldout_fall, active=None):
    return next(text for text in texts(heldout_fall, active) if text.startswith("The cost falls"))


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


def test_where_a_law_acts_is_stated_with_the_number_of_samples():
    text = "It acts in 33 of 178 fitted samples and 5 of 60 held-out ones: x_m from 0.65 to 1.15, y_m from 0.2 to 0.5."
    assert text in texts(362.0, ACTIVE)
    everywhere = ActiveSamples(178, 178, 60, 60, ACTIVE.ranges)
    assert not any(text.startswith("It acts in") for text in texts(362.0, everywhere))


def test_held_out_samples_that_miss_the_place_of_a_law_do_not_test_it():
    missed = replace(ACTIVE, heldout=0)
    text = evidence(11.2, missed)
    assert "; it acts in no held-out sample, so that these do not test it. " in text
    assert "outliers" not in text
    assert "and none of 60 held-out ones" in "".join(texts(11.2, missed))
