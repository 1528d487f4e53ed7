"""The page of a release that is being made: how far it is, and the last image with its place."""

import base64
import os
import re
import shutil
import xml.etree.ElementTree as ET

import pytest

from pipeline.importing.imported_runs import ImportRequest
from pipeline.release_view.follow import follow
from pipeline.release_view.page import release_page
from pipeline.release_view.snapshot import snapshot
from pipeline.rerendering.rerender import RerenderRequest, prepare
from pipeline.rerendering.sources import read_sources
from pipeline.run_folder.workspace import Workspace
from pipeline.stages.run_tables import write_external_run
from symolo.core.files.file_locks import locked
from symolo.dataset.folder_kind import Kind

NOW_S = 1_800_000_000.0


@pytest.fixture
def begun(dataset, tmp_path):
    """A release of which the first three images of one run are rendered, 10 s one after the other."""
    out = tmp_path / "data"
    shutil.copytree(dataset / ".stages/simulate", out / ".stages/simulate")
    images = out / ".stages/render/CW/test_1/images"
    images.mkdir(parents=True)
    for number in (1, 2, 3):
        place = images / f"{number:06d}.jpg"
        shutil.copy(dataset / f"CW/test_1/images/{number:06d}.jpg", place)
        os.utime(place, (NOW_S - 10.0 * (3 - number), NOW_S - 10.0 * (3 - number)))
    (images / ".000004.jpg.0a0b.tmp").write_bytes(b"half an image")
    return out


def words(html):
    return " ".join(re.sub(r"<style>.*?</style>|<[^>]*>", " ", html, flags=re.DOTALL).split())


def test_how_far_it_is(begun):
    progress = snapshot(begun, NOW_S)
    assert {run.run: (len(run.images), run.planned) for run in progress.runs} == {
        "CW/test_1": (3, 6),
        "CCW/test_1": (0, 6),
    }
    assert (progress.rendered, progress.planned, progress.finished, progress.working) == (3, 12, False, False)
    assert (progress.newest.run, progress.newest.number) == ("CW/test_1", 3)
    # Three images in the 20 s since the first of them: 9 more take 60 s.
    assert progress.left_s == pytest.approx(60.0)
    with locked(begun / ".stages"):
        assert snapshot(begun, NOW_S).working


def test_the_page_shows_the_last_image_and_loads_itself_again(begun, dataset):
    html = release_page("data", snapshot(begun, NOW_S), 3.0).decode()
    tree = ET.fromstring(html.removeprefix("<!DOCTYPE html>\n"))  # noqa: S314 - our own page
    (refresh,) = (meta for meta in tree.iter("meta") if meta.get("http-equiv") == "refresh")
    assert refresh.get("content") == "3"
    text = words(html)
    assert "Stopped after 3 of 12 images" in text
    assert "about 1 min 00 s left" in text
    assert "CW/test_1, image 3 of 6, 0.4 s, state 0 line" in text
    shown = [base64.b64decode(data) for data in re.findall(r'src="data:image/jpeg;base64,([^"]*)"', html)]
    assert shown == [(dataset / f"CW/test_1/images/{number:06d}.jpg").read_bytes() for number in (3, 2, 1)]


@pytest.mark.parametrize("is_log", [False, True], ids=["of a dataset", "of a log"])
def test_images_that_are_rendered_again_are_shown_too(is_log, dataset, tmp_path):
    source = dataset / "CW/test_1"
    if is_log:
        source = tmp_path / "log.csv"
        source.write_text("t_s,x_m,y_m,theta_rad\n" + "".join(f"{0.1 * i:.1f},{0.01 * i},0,0\n" for i in range(12)))
    request = RerenderRequest(("lab",), camera_hz=5.0, overrides=("render.width_px=32", "render.height_px=24"))
    workspace = Workspace(tmp_path / "data", Kind.RERENDERED)
    (run,) = prepare(read_sources([source], None, ImportRequest((source,))), request).runs
    write_external_run(run, workspace.simulate(run.spec.key))
    images = workspace.render(run.spec.key).path / "images"
    images.mkdir(parents=True)
    shutil.copy(dataset / "CW/test_1/images/000001.jpg", images / "000002.jpg")
    progress = snapshot(tmp_path / "data", NOW_S)
    assert (progress.rendered, progress.planned) == (1, 6)
    text = words(release_page("data", progress, 3.0).decode())
    assert f"{run.spec.key}, image 2 of 6, 0.2 s{' Runs' if is_log else ', state 0 line'}" in text


def test_a_finished_release_is_loaded_no_more(dataset, tmp_path, symolo):
    out = tmp_path / "live.html"
    ended = symolo("view", dataset, "--follow", "--out", out)
    assert (ended.code, ended.out.splitlines()[-1]) == (0, f"{out}: the release is finished")
    html = out.read_text()
    assert 'http-equiv="refresh"' not in html
    assert "Finished, 2 runs and 12 images" in words(html)


def test_it_is_written_again_until_the_release_is_finished(begun, dataset, tmp_path, monkeypatch):
    pauses = []

    def finish(pause_s):
        pauses.append(pause_s)
        if len(pauses) == 2:
            shutil.copy(dataset / "tagmanifest-sha256.txt", begun)

    monkeypatch.setattr("pipeline.release_view.follow.time.sleep", finish)
    written = []
    page = tmp_path / "live.html"
    follow(begun, page, 3.0, lambda: written.append(page.read_bytes()))
    assert pauses == [3.0, 3.0]
    assert len(written) == 1
    assert 'http-equiv="refresh"' in written[0].decode()
    assert 'http-equiv="refresh"' not in page.read_text()


def test_a_run_that_failed_is_marked(begun):
    outcome = begun / ".stages/simulate/CCW/test_1/outcome.json"
    outcome.write_text(re.sub(r'"problems":\s*\[\]', '"problems": ["hit the wall A2 at 0.9 s"]', outcome.read_text()))
    progress = snapshot(begun, NOW_S)
    assert progress.planned == 6, "it has no images to come"
    assert "hit the wall A2 at 0.9 s" in words(release_page("data", progress, 3.0).decode())


def test_an_empty_folder_is_waited_for_and_another_one_is_refused(tmp_path, symolo):
    html = release_page("data", snapshot(tmp_path, NOW_S), 3.0).decode()
    assert "No run is simulated" in words(html)
    (tmp_path / "other").mkdir()
    (tmp_path / "other/file.txt").write_text("")
    for name in ("other", "none"):
        ended = symolo("view", tmp_path / name, "--follow", "--out", tmp_path / "live.html")
        assert (ended.code, "is no output folder of release" in ended.err) == (2, True)
