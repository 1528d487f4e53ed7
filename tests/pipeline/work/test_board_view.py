"""The live view of a run with a board, as text."""

import io

import pytest
from rich.console import Console

from configs.draw import draw_run
from configs.loader import load_scenario
from physics.control.base import Observation, Twist
from physics.run.controller_runner import Decision
from pipeline.work import board_view
from symolo.dataset.codes import BOARD_COLUMNS, State


class Screen:
    """What is shown, in place of a terminal."""

    def update(self, shown, *, refresh):
        assert refresh
        text = io.StringIO()
        Console(file=text, width=100).print(shown)
        self.text = text.getvalue()


@pytest.fixture
def shown(monkeypatch):
    """The view of two ticks, of which the second has these counts."""
    monkeypatch.setattr(board_view, "BETWEEN_S", 0.0)
    screen = Screen()
    view = board_view.LiveView(draw_run(load_scenario("symolo", ["board.kind=simulated"]), "CW", 1), screen)

    def show(**counts):
        seen = Observation((1.0,) * 7 + (0.0,), 2.0, 0.6, 0.3, (0.0, 0.0, 0.0))
        command = Twist(0.18, -0.3, State.RIGHT_WALL)
        for t_s, status in ((0.0, {"answered": 1}), (0.05, {"answered": 1, **counts})):
            row = tuple(status.get(name, 0) for name in BOARD_COLUMNS)
            view.show(t_s, seen, Decision(command, (5.5, 6.5), 0, row))
        return screen.text

    return show


def test_it_says_what_the_robot_sees_and_does(shown):
    text = shown()
    for part in ("CW/test_1", "1  wall following, wall on the right", "v +0.180 m/s", "left +6.50   right +5.50"):
        assert part in text
    assert f"0.600 m {10 * chr(0x2588)} " in text  # half of the 1.2 m that the sensor reaches
    assert "no target" in text  # ahead
    assert "█       " in text.split("left to right")[1], "the dark channel is the leftmost"
    assert text.splitlines()[-1].rstrip().endswith("2 of 2 answered")


def test_faults_of_the_line_are_shown(shown):
    assert "1 of 2 answered, 1 stopped, 2 damaged at board" in shown(answered=0, stopped=1, damaged_at_board=2)
