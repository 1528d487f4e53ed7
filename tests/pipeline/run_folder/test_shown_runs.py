"""What can be looked at: releases, runs, folders with several runs, and runs that are simulated only."""

import json
import shutil
from fractions import Fraction

import cv2
import pytest

from pipeline.run_folder.shown_runs import checked_runs, shown_runs
from symolo.core.errors import InputError
from symolo.pages.sheet import LINE_PX
from symolo.reader.dataset import load
from symolo.video.build import Video, VideoSettings


@pytest.fixture(scope="module")
def simulated(dataset, tmp_path_factory):
    """The release before its images were rendered: an output folder of `symolo simulate`."""
    root = tmp_path_factory.mktemp("simulated") / "data"
    shutil.copytree(dataset / ".stages/simulate", root / ".stages/simulate")
    return root


def names(path, pattern=None):
    with shown_runs(path, pattern) as data:
        return [run.name for run in data]


def test_each_kind_of_folder_has_its_runs(dataset, simulated, tmp_path):
    both = ["CW/test_1", "CCW/test_1"]
    assert names(dataset) == both
    assert sorted(names(simulated)) == sorted(both)
    assert names(dataset / "CW/test_1") == ["CW/test_1"]
    assert names(dataset / "CW/test_1/data.csv") == ["CW/test_1"]
    assert names(simulated / ".stages/simulate/CCW/test_1") == ["CCW/test_1"]
    assert names(dataset, "CCW/*") == names(simulated, "CCW/*") == ["CCW/test_1"]
    for draw in ("lab_1", "lab_2"):
        shutil.copytree(dataset / "CW/test_1", tmp_path / "looks" / draw)
    assert names(tmp_path / "looks") == ["lab_1", "lab_2"]


def test_a_simulated_run_has_the_tables_of_its_release_and_no_images(dataset, simulated):
    released = load(dataset)
    with shown_runs(simulated) as data:
        for run in data:
            before = released[run.name]
            assert run.images == ()
            assert run.rows.drop(columns="img").equals(before.rows.drop(columns="img"))
            for name in ("wheels", "tof"):
                assert run.side(name).equals(before.side(name))
            assert run.spec == before.spec
        folder = data.root
    assert not folder.exists(), "the tables were in a temporary folder"


def test_images_that_are_rendered_so_far_are_shown(dataset, simulated, tmp_path):
    root = shutil.copytree(simulated, tmp_path / "begun")
    images = root / ".stages/render/CW/test_1/images"
    images.mkdir(parents=True)
    for number in (1, 2, 5):
        shutil.copy(dataset / f"CW/test_1/images/{number:06d}.jpg", images)
    released = load(dataset)["CW/test_1"]
    with shown_runs(root) as data:
        run = data["CW/test_1"]
        assert run.numbers == (1, 2, 5)
        assert [image.t_s for image in run.images] == [released.image(number).t_s for number in (1, 2, 5)]
        assert (run.images[2].pixels() == released.image(5).pixels()).all()
        assert data["CCW/test_1"].numbers == ()


def test_a_run_that_failed_is_shown_with_its_problem(simulated, tmp_path):
    root = shutil.copytree(simulated, tmp_path / "failed")
    outcome = root / ".stages/simulate/CW/test_1/outcome.json"
    outcome.write_text(json.dumps(json.loads(outcome.read_text()) | {"problems": ["hit the wall A2 at 0.9 s"]}))
    with shown_runs(root) as data:
        warnings = {record.run: record.warnings for record in data.metadata.runs}
    assert warnings == {"CW/test_1": ["hit the wall A2 at 0.9 s"], "CCW/test_1": []}


def test_what_shows_a_run_that_failed_states_why(simulated, symolo, tmp_path):
    root = shutil.copytree(simulated, tmp_path / "failed")
    outcome = root / ".stages/simulate/CW/test_1/outcome.json"
    outcome.write_text(json.dumps(json.loads(outcome.read_text()) | {"problems": ["hit the wall A2 at 0.9 s"]}))
    page, sheet = tmp_path / "page.html", tmp_path / "sheet.png"
    ended = symolo("view", root, "--out", page)
    assert ended.out.endswith("CW/test_1 failed: hit the wall A2 at 0.9 s\n")
    assert page.read_text().count('"failure":"hit the wall A2 at 0.9 s"') == 1
    assert symolo("contact-sheet", root, "--out", sheet, "--per-run", 2).out.endswith("wall A2 at 0.9 s\n")
    plain = tmp_path / "plain.png"
    assert symolo("contact-sheet", simulated, "--out", plain, "--per-run", 2).code == 0
    # The row of the failed run is one line of text higher.
    assert cv2.imread(str(sheet)).shape[0] == cv2.imread(str(plain)).shape[0] + LINE_PX
    with shown_runs(root) as data:
        titles = {scene.run.name: scene.title for scene in Video(data, VideoSettings(320, Fraction(1), 1.0, 9))._scenes}
    assert titles["CW/test_1"].endswith("CW/test_1, failed: hit the wall A2 at 0.9 s")
    assert titles["CCW/test_1"].endswith("CCW/test_1")


def test_failed_runs_of_a_release_are_named_by_what_shows_its_runs(dataset, copy_of, symolo, tmp_path):
    root = copy_of(dataset)
    path = root / "metadata.json"
    content = json.loads(path.read_text())
    path.write_text(
        json.dumps(
            content | {"failed_runs": [{"run": "CW/test_2", "stage": "simulate", "problem": "touched A1 at 2.40 s"}]}
        )
    )
    for command, out in (("view", "page.html"), ("contact-sheet", "sheet.jpg"), ("video", "film.gif")):
        note = f"not shown, because failed runs are not released: CW/test_2; see `symolo status {root}`\n"
        for folder, is_named in ((root, True), (dataset, False)):
            options = ("--max-runs", 1, "--fps", 1, "--width-px", 320) if command == "video" else ()
            ended = symolo(command, folder, "--out", tmp_path / f"{folder.parent.name}-{out}", *options)
            assert (ended.code, ended.out.endswith(note)) == (0, is_named), ended.err


def test_a_folder_above_a_simulated_run_is_refused_with_both_places(simulated, symolo, tmp_path):
    place = simulated / ".stages/simulate"
    ended = symolo("view", place, "--out", tmp_path / "view.html")
    assert f"{place}: is no simulated run; name {simulated}, or a run such as {place}/CCW/test_1" in ended.err


def test_a_report_takes_checked_releases_and_simulated_runs_only(dataset, simulated, copy_of, symolo, tmp_path):
    damaged = copy_of(dataset)
    (damaged / "CW/test_1/data.csv").write_text("")
    with pytest.raises(InputError, match="was changed"), checked_runs(damaged, None):
        pass
    out = tmp_path / "report.html"
    assert symolo("report", simulated, "--out", out, "--detail", "0").code == 0
    html = out.read_text()
    assert "This is no release yet: the runs have trajectories, and no image is rendered." in " ".join(html.split())
    assert "SHA-256 of the manifest" not in html
    assert "<th>Licence" not in html


def test_what_holds_no_run_is_refused(tmp_path, symolo):
    out = tmp_path / "out"
    (out / ".stages/simulate").mkdir(parents=True)
    for folder, what in (
        (out, "holds no simulated run"),
        (tmp_path / "none", "no such folder"),
        (out / ".stages/simulate", f"is no simulated run; name {out}"),
        (out / ".stages/render/CW/test_1", f"is no simulated run; name {out}"),
        (out / ".stages/simulate/CW/test_1", "cannot be read"),
    ):
        ended = symolo("view", folder, "--out", tmp_path / "view.html")
        assert (ended.code, ended.err.count("\n")) == (2, 1)
        assert what in ended.err
    assert not (tmp_path / "view.html").exists()
