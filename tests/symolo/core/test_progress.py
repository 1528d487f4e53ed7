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
    with LineReport().stage("render", 1, "runs") as stage:
        stage.update("a", 0.9)
        stage.update("a", 1.0)
    between, end = capsys.readouterr().err.splitlines()
    assert re.fullmatch(r"render: 0 of 1 run, about \d\.\d s left", between)
    assert end.startswith("render: 1 of 1 run in ")


def test_the_last_line_counts_what_failed(capsys):
    with LineReport().stage("simulate", 2, "runs") as stage:
        stage.update("a", 2)
        stage.fail(1)
    assert re.fullmatch(r"simulate: 2 of 2 runs in \d\.\d s; 1 failed\n", capsys.readouterr().err)


@pytest.mark.parametrize(
    ("since_s", "share", "text"),
    [(3.0, 0.25, "9.0 s"), (60.0, 0.5, "1 min 00 s"), (5.0, 1.0, ""), (0.1, 0.01, "")],
)
def test_the_time_left_follows_from_the_time_since_the_start_once_enough_is_done(since_s, share, text):
    assert time_left(since_s, share) == text


class FakeTime:
    def __init__(self, monkeypatch):
        self.now_s = 100.0
        monkeypatch.setattr(progress.time, "monotonic", lambda: self.now_s)


def test_the_time_left_of_parts_that_advance_unevenly_falls_or_is_not_known(capsys, monkeypatch):
    """Two of three parts take 10 s each, so that the third one is expected to end after 30 s; it takes 60 s."""
    monkeypatch.setattr(progress, "SECONDS_BETWEEN_LINES", 0.0)
    clock = FakeTime(monkeypatch)
    with LineReport().stage("diagnose", 3, "cases", is_even=False) as stage:
        for seconds, name, share in (
            (5, "a", 0.6),
            (10, "a", 1.0),
            (15, "b", 0.7),
            (20, "b", 1.0),
            (26, "c", 0.6),
            (29, "c", 0.61),
            (55, "c", 0.9),
        ):
            clock.now_s = 100.0 + seconds
            stage.update(name, share)
    *between, _ = capsys.readouterr().err.splitlines()
    assert [line.partition("cases, ")[2] for line in between] == [
        "time left not known",
        "about 20.0 s left",
        "about 15.0 s left",
        "about 10.0 s left",
        "about 4.0 s left",
        "about 1.0 s left",
        "time left not known",
    ]


def test_no_line_is_printed_twice_in_succession(capsys, monkeypatch):
    monkeypatch.setattr(progress, "SECONDS_BETWEEN_LINES", 0.0)
    with LineReport().stage("diagnose", 2, "cases", is_even=False) as stage:
        for share in (0.1, 0.2, 0.3):
            stage.update("a", share)
    assert capsys.readouterr().err.count("time left not known") == 1


def test_a_single_case_whose_end_is_not_known_has_no_line_before_its_end(capsys, monkeypatch):
    monkeypatch.setattr(progress, "SECONDS_BETWEEN_LINES", 0.0)
    with LineReport().stage("diagnose", 1, "cases", is_even=False) as stage:
        stage.update("a", 0.5)
        stage.update("a", 1.0)
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("diagnose: 1 of 1 case in ")
