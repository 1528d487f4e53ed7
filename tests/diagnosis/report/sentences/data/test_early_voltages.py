"""What the report says of voltages that act before their row."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from diagnosis.inference.evidence.early_voltages import EarlyPart
from diagnosis.report.sentences.data.early_voltages import early_voltage_sentences


def sentences(early):
    trial = SimpleNamespace(t_s=0.05 * np.arange(100))
    diagnosis: Any = SimpleNamespace(early_voltages=early, measurement=SimpleNamespace(trials=[trial]))
    return early_voltage_sentences(diagnosis)


@pytest.mark.parametrize(("part", "time"), [(EarlyPart(0.5, 0.3), "25 ms"), (EarlyPart(0.013, 0.02), "1 ms")])
def test_wrong_times_of_the_rows_are_another_reason(part, time):
    """A part of a row of 50 ms."""
    text = sentences(part)
    assert f"Times of the rows that are wrong by about {time} look the same." in text
    assert text.endswith("or one with exact times, if only these are wrong.")


def test_voltages_that_act_as_logged_need_no_sentence():
    assert sentences(None) == ""
