"""The report of drawing: none for few runs, one step for each of many."""

from contextlib import contextmanager

import pytest

from configs.loader import load_scenario
from pipeline.planning.drawing import draw_reported


class Heard:
    """A report that is remembered."""

    def __init__(self):
        self.stages, self.done = [], []

    def say(self, text):
        pass

    def update(self, name, done):
        self.done.append((name, done))

    @contextmanager
    def stage(self, name, total, unit):
        self.stages.append((name, total, unit))
        yield self


@pytest.mark.parametrize(("runs", "stages"), [(2, []), (3, [("draw", 3, "runs")])])
def test_many_runs_are_a_stage_of_their_own(monkeypatch, runs, stages):
    monkeypatch.setattr("pipeline.planning.drawing.MANY_RUNS", 3)
    loaded, heard = load_scenario("smoke", [f"routes.0.runs={runs - 1}"]), Heard()
    specs = draw_reported(loaded, heard)
    assert heard.stages == stages
    assert heard.done == [("all", done) for _, total, _ in stages for done in range(1, total + 1)]
    assert [spec.key for spec in specs] == [*(f"CW/test_{run}" for run in range(1, runs)), "CCW/test_1"]
