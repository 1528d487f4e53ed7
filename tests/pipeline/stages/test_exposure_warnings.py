"""What the render stage and the dataset make of images on which little can be seen."""

import json
import weakref
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from blender_scenes.render.devices import DeviceKind
from blender_scenes.render.frame_files import FrameFile, Ledger, put_in_place
from blender_scenes.render.job import FramePose
from blender_scenes.render.job_file import job_path, job_sha256, read_job
from blender_scenes.render.sampling import TracingSettings
from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.assembly.description import markdown
from pipeline.executors.local import Local
from pipeline.run_folder.workspace import StageFolder
from pipeline.stages.render import FrameJob, RenderTask, render_runs
from pipeline.stages.rendering_facts import FRAMES, Rendered
from pipeline.work.units import RenderUnit
from sensors.camera.response import encode_jpeg
from symolo.core.errors import RunFailed
from symolo.core.progress import LineReport
from symolo.dataset.documents.metadata import FailedRun, RunRecord, describe
from symolo.dataset.layout import frame_name
from symolo.dataset.tables.rows import Rows

SAMPLING = TracingSettings(seed=1, samples=1, denoise=False)


def put_grey(folder: Path, job_sha256: str, number: int, grey: int) -> None:
    """One image in place and in the journal, as the renderer leaves it."""
    data = encode_jpeg(np.full((24, 32, 3), grey, np.uint8), 92)
    name = frame_name(number)
    sha256 = put_in_place(data, folder / name, 32, 24)
    Ledger(folder, job_sha256).add(FrameFile(number, name, sha256, len(data), 0.0))


@pytest.fixture
def render(tmp_path, monkeypatch):
    """Renders a run of images of one grey each, with hands of its own in place of Blender's."""

    def rendered(*greys: int, device: DeviceKind = "CPU") -> tuple[RenderTask, list[FailedRun]]:
        frames = tuple(FramePose(number, 0.0, 0.0, 0.0, 0.0) for number in range(1, len(greys) + 1))
        task = RenderTask("CW/test_1", StageFolder(tmp_path), "of a job", frames, replace(SAMPLING, device=device))

        def paint(*_: object, **__: object) -> list[object]:
            for frame, grey in zip(frames, greys, strict=True):
                put_grey(task.files, "of a job", frame.number, grey)
            return []

        monkeypatch.setattr("pipeline.executors.local.run_units", paint)
        return task, render_runs([FrameJob(task, "{}")], Local(1), LineReport())

    return rendered


def test_a_black_image_among_others_is_a_warning_that_is_reported_and_kept(render, capsys):
    task, failed = render(128, 0)
    assert failed == []
    assert task.folder.is_done(task.key)
    (warning,) = Rendered.read(task.folder.path).warnings
    assert "1 of 2 images are black" in warning
    assert "the worst, 000002.jpg, in 100%" in warning
    assert f"render: CW/test_1: {warning}" in capsys.readouterr().err
    shares = [frame["black_share"] for frame in json.loads((task.folder.path / FRAMES).read_text())["frames"]]
    assert shares == [0.0, 1.0]


def test_what_rendered_the_images_is_recorded(render):
    task, _ = render(128, device="HIP")
    assert Rendered.read(task.folder.path).device == "HIP"


def test_a_run_of_black_images_alone_has_failed(render):
    task, (failed,) = render(0, 1)
    assert (failed.run, failed.stage) == ("CW/test_1", "render")
    assert "all 2 images are black: raise look.camera.compensation_ev" in failed.problem
    assert not task.folder.is_done(task.key)


def test_of_a_thousand_jobs_no_more_than_two_are_held_at_a_time(tmp_path, monkeypatch):
    """Each is some megabytes; it is written before the next one but one is made."""
    frames, made = (FramePose(1, 0.0, 0.0, 0.0, 0.0),), []

    def frame_jobs() -> Iterator[FrameJob]:
        for number in range(1, 7):
            folder = StageFolder(tmp_path / str(number))
            frame_job = FrameJob(RenderTask(f"CW/test_{number}", folder, "", frames, SAMPLING), "{}")
            made.append(weakref.ref(frame_job))
            yield frame_job
            del frame_job
            assert sum(one() is not None for one in made) <= 2

    def stop(*_: object, **__: object) -> None:
        raise RunFailed("no more is asked for")

    monkeypatch.setattr("pipeline.executors.local.run_units", stop)
    with pytest.raises(RunFailed):
        render_runs(frame_jobs(), Local(1), LineReport())
    assert len(made) == 6
    assert all(read_job(job_path(tmp_path / f"{number}")) == b"{}" for number in range(1, 7))


@pytest.mark.parametrize("black", [("CW/test_1",), ("CW/test_1", "CCW/test_1")])
def test_stage_by_stage_a_run_of_black_images_has_failed_as_in_a_release(
    dataset, copy_of, symolo, tiny, monkeypatch, black
):
    out = copy_of(dataset, stages=True)

    def paint(units: list[RenderUnit], *_: object, **__: object) -> list[object]:
        for unit in units:
            job = job_sha256(unit.job)
            for number in unit.numbers:
                put_grey(unit.folder, job, number, 0 if unit.name in black else 128)
        return []

    monkeypatch.setattr("pipeline.executors.local.run_units", paint)
    arguments = ("smoke", "--out", out, *tiny, "--set", "look.camera.brightness=0.3")
    replacing = ("assemble", "--replace")  # the runs were released before
    for command in (("render",), ("render",), replacing, replacing):
        ended = symolo(*command, *arguments)
        assert ended.code == 3, ended.err
        failures = [line for line in ended.err.splitlines() if line.startswith("failed: ")]
        assert [line.split(": ")[1] for line in failures] == list(black)
        assert all("render: all 6 images are black" in line for line in failures)
    assert [run for run in ("CW/test_1", "CCW/test_1") if not (out / run).exists()] == list(black)
    assert (out / "metadata.json").exists() == (len(black) < 2)
    # What comes of another look is not known yet.
    refused = symolo("assemble", *arguments, "--set", "look.camera.brightness=0.4")
    assert (refused.code, refused.err.count("\n")) == (2, 1)
    assert "symolo render" in refused.err


def test_the_dataset_passes_the_warning_on():
    loaded = load_scenario("smoke")
    spec = draw_run(loaded, "CW", 1)
    rows = Rows.from_table(np.column_stack([[0.0, 50.0], np.zeros((2, 17)), [1, 0]]))
    records = [
        RunRecord.from_specification(spec, rows, None, ["1 of 9 images are burnt"]),
        RunRecord.from_specification(spec, rows, None),
    ]
    metadata = describe(loaded.tree, [spec], records, [])
    assert json.loads(metadata.to_json())["runs"][0]["warnings"] == ["1 of 9 images are burnt"]
    assert "## Warnings" in markdown(metadata, spec).decode()
    assert "## Warnings" not in markdown(metadata.model_copy(update={"runs": records[1:]}), spec).decode()


def test_an_image_that_changes_after_it_was_recorded_is_not_listed(render, monkeypatch):
    """Such as by a renderer of an earlier command that was slow to end."""
    recorded = Ledger.add

    def overwritten(ledger: Ledger, frame: FrameFile) -> None:
        recorded(ledger, frame)
        if frame.number == 2:
            path = ledger._images_dir / frame.file
            path.write_bytes(encode_jpeg(np.full((24, 32, 3), 99, np.uint8), 92))

    monkeypatch.setattr(Ledger, "add", overwritten)
    task, (failed,) = render(128, 128)
    assert failed.problem == "000002.jpg is not on the disk as it was written; run the same command again"
    assert not task.folder.is_done(task.key)
    assert not (task.folder.path / FRAMES).exists()
