"""When a run of the render stage is finished: as its last block ends, and never one of which a frame was given up."""

import numpy as np
import pytest

from blender_scenes.render.frame_files import FrameFile, Ledger, put_in_place
from blender_scenes.render.job import FramePose
from blender_scenes.render.sampling import TracingSettings
from pipeline.run_folder.workspace import StageFolder
from pipeline.stages.render import FrameJob, RenderTask, render_runs
from pipeline.work.supervisor import FrameGivenUp, UnitFailure
from sensors.camera.response import encode_jpeg
from symolo.core.child_process import Finished
from symolo.core.progress import LineReport
from symolo.dataset.layout import frame_name

GREY = encode_jpeg(np.full((24, 32, 3), 128, np.uint8), 92)


class Blocks:
    """An executor of blocks of one frame, painted in the order of `places`; of the one at `given_up` a frame fails."""

    does_all = True

    def __init__(self, places, given_up=None, after=lambda: None):
        self._places, self._given_up, self._after = places, given_up, after

    def block_frames(self, frames, runs):
        assert (frames, runs) == (2, 2)
        return 1

    def threads(self, units):
        return units // units

    def mine(self, unit):
        return bool(unit.numbers)

    def do(self, units, on_event):
        failures = []
        for place in self._places:
            unit, name = units[place], frame_name(units[place].numbers[0])
            digest = put_in_place(GREY, unit.folder / name, 32, 24)
            Ledger(unit.folder, f"job of {unit.name}").add(FrameFile(unit.numbers[0], name, digest, len(GREY), 0.0))
            if place == self._given_up:
                on_event(unit, FrameGivenUp("given up"))
                failures.append(UnitFailure(unit, "given up"))
            on_event(unit, Finished())
            self._after()
        return failures


@pytest.fixture
def frame_jobs(tmp_path):
    frames = tuple(FramePose(number, 0.0, 0.0, 0.0, 0.0) for number in (1, 2))
    sampling = TracingSettings(seed=1, samples=1, denoise=False)
    tasks = [
        RenderTask(run, StageFolder(tmp_path / run), f"job of {run}", frames, sampling) for run in ("CW/1", "CW/2")
    ]
    return [FrameJob(task, "{}") for task in tasks]


def test_a_run_is_whole_as_its_last_block_ends_while_others_are_made(frame_jobs):
    whole, seen = [], []
    executor = Blocks((0, 2, 1, 3), after=lambda: seen.append([*whole]))
    assert render_runs(frame_jobs, executor, LineReport(), on_complete=whole.append) == []
    assert seen == [[], [], ["CW/1"], ["CW/1", "CW/2"]]
    again = []
    assert render_runs(frame_jobs, executor, LineReport(), on_complete=again.append) == []
    assert again == ["CW/1", "CW/2"]  # they were there
    assert len(seen) == 4


def test_a_run_of_which_a_frame_was_given_up_is_not_whole_though_its_files_are_there(frame_jobs):
    whole = []
    failed = render_runs(frame_jobs, Blocks(range(4), given_up=0), LineReport(), on_complete=whole.append)
    assert [(one.run, one.problem) for one in failed] == [("CW/1", "given up")]
    assert whole == ["CW/2"]
    assert not frame_jobs[0].task.folder.is_done(frame_jobs[0].task.key)
