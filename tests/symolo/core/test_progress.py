import re

import pytest

from symolo.core import progress
from symolo.core.progress import LineReport, time_left


@pytest.mark.parametrize(("total", "line"), [(1, "export: 1 of 1 file in "), (2, "export: 2 of 2 files in ")])
def test_a_line_counts_one_thing_and_several(capsys, total, line):
    with LineReport().stage("export", total, "files") as stage:
        stage.update("a", total)
    assert capsys.readouterr().err.startswith(line)


def test_no_line_says_that_no_time_is_left_once_all_is_done(capsys, monkeypatch):
    monkeypatch.setattr(progress, "SECONDS_BETWEEN_LINES", 0.0)
    with LineReport().stage("diagnose", 1, "cases") as stage:
        stage.update("a", 0.9)
        stage.update("a", 1.0)
    between, end = capsys.readouterr().err.splitlines()
    assert re.fullmatch(r"diagnose: 0 of 1 case, about \d\.\d s left", between)
    assert end.startswith("diagnose: 1 of 1 case in ")


@pytest.mark.parametrize(
    ("since_s", "share", "text"),
    [(3.0, 0.25, "9.0 s"), (60.0, 0.5, "1 min 00 s"), (5.0, 1.0, ""), (0.1, 0.01, "")],
)
def test_the_time_left_follows_from_the_time_since_the_start_once_enough_is_done(since_s, share, text):
    assert time_left(since_s, share) == text
