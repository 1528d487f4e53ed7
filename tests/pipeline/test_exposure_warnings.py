"""What the render stage and the dataset make of pictures on which little can be seen."""

import json

import cv2
import numpy as np
import pytest

from blender_scenes.job import FramePose
from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.dataset.description import markdown
from pipeline.dataset.metadata import FailedRun, RunRecord, describe
from pipeline.dataset.rows import Rows
from pipeline.progress import LineReport
from pipeline.stages.render import FRAMES, RenderTask, picture_warnings, render_runs
from pipeline.workspace import StageFolder


@pytest.fixture
def render(tmp_path, monkeypatch):
    """Renders a run of pictures of one grey each, with hands of its own in place of Blender's."""

    def rendered(*greys: int) -> tuple[RenderTask, list[FailedRun]]:
        frames = tuple(FramePose(number, 0.0, 0.0, 0.0, 0.0) for number in range(1, len(greys) + 1))
        task = RenderTask("CW/test_1", StageFolder(tmp_path), "{}", frames)

        def paint(*_: object) -> list[object]:
            for frame, grey in zip(frames, greys, strict=True):
                cv2.imwrite(str(task.files / f"{frame.number:06d}.jpg"), np.full((24, 32, 3), grey, np.uint8))
            return []

        monkeypatch.setattr("pipeline.stages.render.run_units", paint)
        return task, render_runs([task], 1, LineReport())

    return rendered


def test_a_black_image_among_others_is_a_warning_told_and_kept(render, capsys):
    task, failed = render(128, 0)
    assert failed == []
    assert task.folder.is_done(task.key)
    (warning,) = picture_warnings(task.folder.path)
    assert "1 of 2 images are black" in warning
    assert "the worst, 000002.jpg, in 100%" in warning
    assert f"render: CW/test_1: {warning}" in capsys.readouterr().err
    shares = [frame["black_share"] for frame in json.loads((task.folder.path / FRAMES).read_text())["frames"]]
    assert shares == [0.0, 1.0]


def test_a_run_of_black_images_alone_has_failed(render):
    task, (failed,) = render(0, 1)
    assert (failed.run, failed.stage) == ("CW/test_1", "render")
    assert "all 2 images are black: raise look.camera.compensation_ev" in failed.problem
    assert not task.folder.is_done(task.key)


def test_the_dataset_passes_the_warning_on():
    loaded = load_scenario("smoke")
    spec = draw_run(loaded, "CW", 1)
    rows = Rows.from_table(np.column_stack([[0.0, 50.0], np.zeros((2, 17)), [1, 0]]))
    records = [RunRecord.of(spec, rows, None, ["1 of 9 images are burnt"]), RunRecord.of(spec, rows, None)]
    metadata = describe(loaded.tree, [spec], records, [])
    assert json.loads(metadata.to_json())["runs"][0]["warnings"] == ["1 of 9 images are burnt"]
    assert "## Warnings" in markdown(metadata, spec).decode()
    assert "## Warnings" not in markdown(metadata.model_copy(update={"runs": records[1:]}), spec).decode()
