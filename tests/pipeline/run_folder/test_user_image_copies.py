"""Images of the user's own in the stages: copied once, known by content, not looked for elsewhere."""

import hashlib
import json
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest

from blender_scenes.render.job_file import job_path, read_job
from configs.draw import draw_look
from configs.loader import load_section
from pipeline.executors.local import Local
from pipeline.importing.imported_runs import ImportRequest
from pipeline.rerendering.rerender import Rerendering, RerenderRequest, make_release, prepare
from pipeline.rerendering.sources import read_sources
from pipeline.run_folder.user_image_copies import copy_user_images
from pipeline.run_folder.workspace import StageFolder, Workspace
from pipeline.stages import render_specs
from pipeline.stages.cameras import cameras_of
from pipeline.stages.render import RenderTask
from pipeline.work import batch
from symolo.core.errors import InputError
from symolo.core.progress import LineReport
from symolo.dataset.folder_kind import Kind

RED = cv2.imencode(".png", np.full((4, 6, 3), (30, 30, 220), np.uint8))[1].tobytes()
BLUE = cv2.imencode(".png", np.full((4, 6, 3), (220, 30, 30), np.uint8))[1].tobytes()
HALL = cv2.imencode(".hdr", np.full((4, 8, 3), 0.5, np.float32))[1].tobytes()
LOOK = """\
extends: lab
name: own
assets: photos
floor: {material: image, dirt: 0, image: {file: floor.png}}
sky: {panorama: hall.hdr}
"""


def sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


@pytest.fixture
def own(tmp_path: Path) -> Path:
    """A look with its folder `photos` beside it."""
    (tmp_path / "photos").mkdir()
    (tmp_path / "photos/floor.png").write_bytes(RED)
    (tmp_path / "photos/hall.hdr").write_bytes(HALL)
    (tmp_path / "own.yaml").write_text(LOOK)
    return tmp_path / "own.yaml"


def rendering(run: Path, look: Path, camera_hz: float | None = None) -> Rerendering:
    return prepare(
        read_sources((run,), None, ImportRequest((run,))), RerenderRequest((str(look),), camera_hz=camera_hz)
    )


def test_what_was_begun_is_rendered_although_the_folder_is_gone(dataset, own, tmp_path):
    """As after an interruption: from the copies alone."""
    begun = rendering(dataset / "CW/test_1", own, camera_hz=1)
    workspace = Workspace(tmp_path / "out", Kind.RERENDERED)
    kept, look = workspace.user_files, begun.runs[0].spec.look
    copy_user_images((look,), begun.assets, kept)
    assert {path.name: path.read_bytes() for path in kept.iterdir()} == {sha256(RED): RED, sha256(HALL): HALL}
    written = {path: path.stat().st_mtime_ns for path in kept.iterdir()}
    shutil.rmtree(tmp_path / "photos")
    assert make_release(begun, workspace.out, Local(1), LineReport()) == []
    assert {path: path.stat().st_mtime_ns for path in kept.iterdir()} == written
    blue, _, red = (
        cv2.imread(str(workspace.out / "CW/test_1/images/000001.jpg")).astype(float).mean(axis=(0, 1)).tolist()
    )
    assert red > 1.5 * blue
    spec = json.loads((workspace.out / "CW/test_1/side/spec.json").read_text())
    recorded = spec["look"]["floor"]["image"]["file"]
    assert (recorded["name"], recorded["sha256"]) == ("floor.png", sha256(RED))
    texts = [(workspace.out / name).read_text() for name in ("metadata.json", "CW/test_1/side/spec.json")]
    texts.append(read_job(job_path(workspace.render("CW/test_1").path)).decode())
    assert all(str(tmp_path) not in text for text in texts)


def test_a_changed_picture_is_another_job_and_a_renamed_one_is_not(dataset, own, tmp_path):
    def key() -> str:
        rerendering = rendering(dataset / "CW/test_1", own)
        (run,), folder = rerendering.runs, StageFolder(tmp_path / "out")
        return RenderTask.of_camera(cameras_of(run.spec)[0], run.rows, folder).task.key

    before = key()
    (tmp_path / "photos/floor.png").rename(tmp_path / "photos/parquet.png")
    own.write_text(LOOK.replace("floor.png", "parquet.png"))
    assert key() == before
    (tmp_path / "photos/parquet.png").write_bytes(BLUE)
    assert key() != before


def test_a_folder_that_is_gone_is_reported_before_anything_is_made(dataset, own, tmp_path, symolo):
    shutil.rmtree(tmp_path / "photos")
    ended = symolo("rerender", dataset / "CW/test_1", "--look", own, "--out", tmp_path / "out")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert "own.yaml:3: look.assets: no such folder" in ended.err
    assert not (tmp_path / "out").exists()


def test_a_release_hands_its_renderers_the_copies(copy_of, dataset, own, tiny, symolo, monkeypatch):
    seen = []
    monkeypatch.setattr(render_specs, "render_runs", lambda frame_jobs, *_, **__: seen.extend(frame_jobs) or [])
    out = copy_of(dataset, stages=True)
    assert symolo("render", "smoke", "--out", out, *tiny, "--set", f"look={own}").code == 0
    assert len(seen) == 2
    for frame_job in seen:
        assert frame_job.task.user_files == out / ".stages/assets"
        assert sha256(RED) in frame_job.job_text
    assert {path.name for path in (out / ".stages/assets").iterdir()} == {sha256(RED), sha256(HALL)}


def test_a_release_copies_them_before_it_simulates(own, tmp_path, tiny, symolo, monkeypatch):
    def begin(workspace: Workspace, *_: object) -> list:
        assert {path.name for path in workspace.user_files.iterdir()} == {sha256(RED), sha256(HALL)}
        raise InputError("simulated")

    monkeypatch.setattr(batch, "simulate_runs", begin)
    ended = symolo("release", "smoke", "--out", tmp_path / "out", *tiny, "--set", f"look={own}")
    assert (ended.code, ended.err.strip().splitlines()[-1]) == (2, "symolo: simulated")


def test_a_damaged_copy_is_made_again_and_a_file_that_changes_meanwhile_is_refused(own, tmp_path):
    section = load_section("look", str(own))
    look, _ = draw_look(section, 1, "CW", 1)
    kept = tmp_path / "kept"
    copy_user_images((look,), section.assets, kept)
    (kept / sha256(RED)).write_bytes(RED[:-1])
    copy_user_images((look,), section.assets, kept)
    assert (kept / sha256(RED)).read_bytes() == RED
    (kept / sha256(RED)).unlink()
    (tmp_path / "photos/floor.png").write_bytes(BLUE)
    with pytest.raises(InputError, match=r"photos/floor\.png: has changed since it was read"):
        copy_user_images((look,), section.assets, kept)
    (tmp_path / "photos/floor.png").unlink()
    with pytest.raises(InputError, match=r"photos/floor\.png: has disappeared since it was read; put it back"):
        copy_user_images((look,), section.assets, kept)
    assert not (kept / sha256(RED)).exists()


def test_draws_of_a_choice_take_different_pictures(dataset, own, tmp_path):
    (tmp_path / "photos/blue.png").write_bytes(BLUE)
    choice = "look.floor.image.file={choice: [floor.png, blue.png]}"
    request = RerenderRequest((str(own),), 12, overrides=(choice,), option="--looks")
    run = dataset / "CW/test_1"
    drawn = prepare(read_sources((run,), None, ImportRequest((run,))), request)
    looks = [each.spec.look for each in drawn.runs]
    images = [look.floor.image for look in looks]
    assert {image.file.sha256 for image in images if image.file} == {sha256(RED), sha256(BLUE)}
    assert all({file.sha256 for file in look.files} <= set(drawn.assets) for look in looks)


def test_a_flat_preview_shows_them(own, tmp_path, symolo):
    out = tmp_path / "sheet.png"
    arguments = ("preview", "smoke", "--engine", "flat", "--look", own, "-n", 1, "--width-px", 32)
    assert symolo(*arguments, "--out", out).code == 0
    blue, _, red = cv2.imread(str(out))[12:24].astype(float).mean(axis=(0, 1)).tolist()
    assert red > 1.5 * blue
