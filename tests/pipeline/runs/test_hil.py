"""A board in the loop: laps by the firmware beside laps by the controller in Python, and what a dataset says of it."""

import functools
import io
import itertools
import json
import os
import pty

import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from hil.board_runner import build_for
from hil.links.lockstep import LockstepLink
from hil.links.pty_board import PtyBoard
from hil.loop import LoopSettings
from physics.run.controller_runner import InProcessRunner
from pipeline.run_folder.first_stage import read_recording
from pipeline.stages.simulate import simulate
from pipeline.stages.simulate_runs import read_outcome, simulate_into
from symolo.core.errors import RunFailed
from symolo.core.random_streams import stream

pytestmark = pytest.mark.board

BOARD = "board.kind=simulated"
ONE_RUN = "routes=[{name: CW, start: {x_m: 0.55, y_m: -0.2, yaw_deg: 90}}]"
STATES = {"CW": [0, 1, 5, 1, 2, 4, 2, 0, 5, 0], "CCW": [0, 5, 0, 1, 3, 1, 2, 6, 2, 0]}
"""State order of SPEC section 4."""


@pytest.fixture(autouse=True)
def _programs_kept_with_the_tests(pytestconfig, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(pytestconfig.cache.mkdir("hil")))


def spec_of(route, *overrides):
    return draw_run(load_scenario("symolo", overrides), route, 1)


def driven(folder, spec, **options):
    simulate_into(spec.model_dump_json(), folder, "key", lambda _share: None, **options)
    return read_outcome(folder), read_recording(folder)


@pytest.mark.parametrize("route", STATES)
def test_the_firmware_drives_the_lap_of_the_controller_in_python(route, tmp_path):
    outcome, recording = driven(tmp_path / "run", spec_of(route, BOARD))
    built_in = simulate(spec_of(route))
    assert outcome.problems == ()
    assert outcome.events == ()
    assert [state for state, _ in itertools.groupby(recording.trajectory.state.tolist())] == STATES[route]
    assert outcome.lap_time_s == pytest.approx(built_in.lap_time_s, rel=0.02)
    paths = [found.trajectory.pose[:, :2] for found in (recording, built_in.recording)]
    for one, other in (paths, paths[::-1]):
        assert max(np.hypot(*(other - point).T).min() for point in one) < 0.015


@pytest.mark.parametrize("framing", ["framed", "simtwo"])
def test_two_drives_are_the_same_bytes(framing, tmp_path):
    spec = spec_of("CW", BOARD, f"board.framing={framing}", "stop.lap=false", "stop.time_limit_s=2")
    saved = []
    for number in range(2):
        file = io.BytesIO()
        driven(tmp_path / str(number), spec)[1].save(file)
        saved.append(file.getvalue())
    assert saved[0] == saved[1]


@pytest.mark.usefixtures("hands")
def test_a_release_with_a_board_says_so_and_is_verified(symolo, tmp_path):
    settings = ("stop.time_limit_s=0.2", "render.width_px=32", "render.height_px=24", "render.samples=1", ONE_RUN)
    asked = ["hil", "smoke", "--simulated", "--out", tmp_path / "data", *(f"--set={setting}" for setting in settings)]
    made = symolo(*asked)
    assert (made.code, symolo("verify", tmp_path / "data").code) == (0, 0), made.err
    metadata = json.loads((tmp_path / "data/metadata.json").read_text())
    record = metadata["runs"][0]["board"]
    assert len(record["firmware_id"]) == 16
    assert (record["rows_unanswered"], record["events"]) == (0, {})
    table = np.loadtxt(tmp_path / "data/CW/test_1/side/board.csv", delimiter=",", skiprows=1)
    assert table[:, 0].tolist() == [50.0 * row for row in range(5)]
    assert table[:, 1].tolist() == [1.0] * 5
    assert "1 of 1 run done before" in symolo(*asked).err


class LostBoard:
    """A runner whose board is gone at its fifth tick."""

    def __init__(self, runner):
        self._runner, self._left = runner, 4

    def decide(self, seen):
        if not self._left:
            raise RunFailed("the board is gone")
        self._left -= 1
        return self._runner.decide(seen)


def test_a_board_that_is_gone_ends_the_run_and_what_was_driven_is_kept():
    spec = spec_of("CW")
    outcome = simulate(spec, runner=LostBoard(InProcessRunner.from_robot(spec.robot, spec.rates.control_hz, stream(1))))
    assert outcome.problems == ("the board is gone",)
    assert not outcome.finished
    assert len(outcome.recording.trajectory.t_s) == 4


def test_a_port_is_driven_in_real_time(tmp_path):
    spec = spec_of("CW", "board.kind=serial", "stop.lap=false", "stop.time_limit_s=0.5")
    with PtyBoard(build_for(spec.robot, spec.board).elf, spec.board.bits_per_s) as board:
        outcome, recording = driven(tmp_path / "run", spec, port=board.port)
    assert outcome.problems == ()
    assert outcome.board.rows_unanswered <= 2
    assert len(recording.trajectory.t_s) == 11


@pytest.mark.parametrize(
    ("command", "options", "message"),
    [
        ("hil", ["--port", "/dev/none"], "--port /dev/none: there is no such port"),
        ("hil", [], "either --port PORT or --simulated"),
        ("hil", ["--simulated", "--port", "/dev/none"], "either --port PORT or --simulated"),
        ("hil", ["--simulated", "--baud", "9600"], "baud: got 9600"),
        ("release", ["--set", "board.kind=serial"], "symolo hil --port PORT"),
    ],
)
def test_what_cannot_be_reached_is_reported_before_anything_is_written(command, options, message, symolo, tmp_path):
    ended = symolo(command, "smoke", *options, "--out", tmp_path / "data")
    assert ended.code == 2
    assert message in ended.err
    assert ended.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_sketch_is_written_once(symolo, tmp_path):
    made = symolo("firmware", "--out", tmp_path / "lap")
    assert made.code == 0
    assert {"lap.ino", "student.c", "settings.h", "paths.h"} <= {path.name for path in (tmp_path / "lap").iterdir()}
    assert symolo("firmware", "--out", tmp_path / "lap").code == 2


class _Silent:
    """Somebody at the other end of a pty who never says a word."""

    def __enter__(self):
        self._ends = pty.openpty()
        return os.ttyname(self._ends[1])

    def __exit__(self, *_):
        for end in self._ends:
            os.close(end)


def test_a_port_at_which_nobody_answers_is_a_run_that_failed(symolo, tmp_path, monkeypatch):
    monkeypatch.setattr("hil.board_runner.LoopSettings", functools.partial(LoopSettings, hello_s=0.2))
    with _Silent() as port:
        ended = symolo("hil", "smoke", "--port", port, "--out", tmp_path / "data", f"--set={ONE_RUN}")
    assert ended.code == 3
    assert "failed: CW/test_1: simulate: no answer from" in ended.err


def test_a_board_that_reboots_ends_the_run_and_the_outcome_says_what_happened(tmp_path, monkeypatch):
    begin, ticks = LockstepLink.start_tick, itertools.count()

    def pressed_once(link, tick_s):
        if next(ticks) == 10:
            link.reset()
        return begin(link, tick_s)

    monkeypatch.setattr(LockstepLink, "start_tick", pressed_once)
    outcome, recording = driven(tmp_path / "run", spec_of("CW", BOARD, "stop.time_limit_s=2"))
    assert not outcome.finished
    assert any("re-booted" in problem for problem in outcome.problems)
    assert any("re-boot" in event for event in outcome.events)
    assert outcome.board.events["rebooted"] == 1
    assert "1 rebooted" in outcome.warnings[0]
    assert 0 < len(recording.trajectory.t_s) < 15
