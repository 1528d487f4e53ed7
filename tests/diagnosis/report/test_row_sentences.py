from pathlib import Path

import pytest

from configs.effects.registry import EFFECTS
from diagnosis.diagnose import NamedEffect, diagnose
from diagnosis.importers.paper import IMPORTER
from diagnosis.report.row_sentences import row_sentences, too_large


@pytest.fixture(scope="module")
def table_1():
    return diagnose(IMPORTER.read(Path("table-1")))


def numbers(text, unit):
    """That stand before a unit."""
    words = text.replace(",", "").split()
    return [float(words[k - 1]) for k, word in enumerate(words) if word.rstrip(".") == unit]


def test_the_row_of_table_1_that_stands_still_and_rows_left_out(table_1):
    """The paper's row at 0.25 V has no speed; leave-one-out errors of speed of a straight line and of a parabola
    through the rows that move are 0.101 and 0.061 rad/s.
    """
    stuck, _, speed = list(row_sentences(table_1))
    assert stuck.startswith("In row 2 the motor does not turn at 0.25 V")
    before, after = numbers(speed, "rad/s")
    assert before == pytest.approx(0.101, abs=0.006)
    assert after == pytest.approx(0.061, abs=0.006)


def test_a_size_that_no_robot_has_is_said(table_1):
    (named,) = table_1.named
    (effect,) = (effect for effect in EFFECTS.classes() if effect.name == "supply_sag")
    assert named.effect.kind is effect
    assert too_large(named) == []  # 1.87 +- 0.38 ohm may still be less than 1
    surer = NamedEffect(named.effect, {"source_resistance_ohm": 20.0}, {"source_resistance_ohm": 2.0}, named.comparison)
    (text,) = too_large(surer)
    assert text.startswith("source_resistance_ohm 20 +- 2 is beyond 1")
