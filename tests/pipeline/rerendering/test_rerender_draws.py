"""Several draws of several looks for existing trajectories."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import cv2
import pytest

from blender_scenes.render.job_file import job_path, job_sha256
from configs.schema.splits import Splits
from pipeline.importing.imported_runs import ImportRequest
from pipeline.rerendering.rerender import RerenderRequest, draw_seed, prepare
from pipeline.rerendering.sources import read_sources
from symolo.core.errors import InputError


@pytest.fixture(scope="module")
def run(dataset):
    return dataset / "CW/test_1"


@pytest.mark.usefixtures("hands")
def test_the_first_draw_is_the_runs_own_and_each_draw_has_a_route(dataset, run, tmp_path, symolo):
    """The job for Blender is that of the run, whose images are thus the same bytes (`test_rerender.py`)."""
    out = tmp_path / "looks"
    arguments = ("rerender", run, "--looks", "classroom", "--draws", 2, "--out", out, "--workers", 1)
    ended = symolo(*arguments)
    assert ended.code == 0
    assert f"rerender: 2 of 2 runs, in {out}" in ended.out
    assert symolo("verify", out).code == 0
    first, second = out / "CW-classroom_1/test_1", out / "CW-classroom_2/test_1"
    jobs = [job_path(folder) for folder in (dataset / ".stages/render/CW/test_1", *_rendered(out))]
    own_job, first_job, second_job = map(job_sha256, jobs)
    assert first_job == own_job != second_job
    own, *specs = (json.loads((folder / "side/spec.json").read_text()) for folder in (run, first, second))
    drawn = [{key: value for key, value in spec["drawn"].items() if key.startswith("look.")} for spec in (own, *specs)]
    assert (specs[0]["seed"], drawn[1]) == (own["seed"], drawn[0])
    assert specs[1]["seed"] == draw_seed(own["seed"], 2)
    assert drawn[2].keys() == drawn[0].keys()
    assert specs[1]["look"]["room"]["height_m"] == drawn[2]["look.room.height_m"]
    records = json.loads((out / "metadata.json").read_text())["runs"]
    assert [record["origin"]["release"]["run"] for record in records] == ["CW/test_1", "CW/test_1"]
    _continues_and_is_looked_at(out, arguments, symolo, tmp_path / "sheet.png")


def _rendered(out):
    return [out / f".stages/render/CW-classroom_{draw}/test_1" for draw in (1, 2)]


def _continues_and_is_looked_at(out, arguments, symolo, sheet):
    images = "CW-classroom_2/test_1/images"
    times = {path: path.stat().st_mtime_ns for path in out.rglob("*.jpg")}
    (out / images / "000002.jpg").write_bytes(b"damaged")
    assert symolo(*arguments).code == 0
    kept = {path: path.stat().st_mtime_ns for path in out.rglob("*.jpg") if path.parent != out / images}
    assert kept.items() <= times.items()
    assert cv2.imread(str(out / images / "000002.jpg")).shape == (24, 32, 3)
    assert symolo("contact-sheet", out, "--out", sheet, "--per-run", 3, "--width-px", 32).code == 0
    assert cv2.imread(str(sheet)).shape == (2 * (24 + 18), 3 * 32, 3)


@pytest.mark.usefixtures("hands")
def test_without_out_the_folder_is_named_by_run_and_looks(dataset, run, tmp_path, symolo, monkeypatch):
    """A run by route and number, a dataset by its name, what comes from elsewhere by its file or folder."""
    foreign = tmp_path / "elsewhere/data.csv"
    foreign.parent.mkdir()
    foreign.write_bytes((run / "data.csv").read_bytes())
    shutil.copy(foreign, tmp_path / "drive.csv")
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    small = "--set", "render.width_px=32", "--set", "render.height_px=24"
    for source, looks, name in (
        (run, ("--looks", "classroom,night", "--draws", 2), "CW-test_1-classroom-night"),
        (run / "data.csv", ("--look", "lab"), "CW-test_1-lab"),
        (dataset, ("--look", "lab"), "smoke-lab"),
        (foreign, ("--look", "lab"), "elsewhere-lab"),
        ("../drive.csv", ("--look", "lab"), "drive-lab"),
    ):
        ended = symolo("rerender", source, *looks, *small)
        assert (ended.code, ended.out.splitlines()[-1].split(", in ")[-1]) == (0, name), ended.err
        assert Path(name).is_dir()
        shutil.rmtree(name)
    assert list(Path().iterdir()) == []
    Path("CW-test_1-lab").write_text("of the user")
    ended = symolo("rerender", run, "--look", "lab")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert "--out CW-test_1-lab: is a file" in ended.err


@pytest.mark.usefixtures("hands")
@pytest.mark.parametrize("option", ["--look", "--looks"])
def test_a_folder_without_out_is_continued_but_not_replaced(run, tmp_path, symolo, monkeypatch, option):
    monkeypatch.chdir(tmp_path)
    command = ("rerender", run, option, "lab", "--set", "render.width_px=32", "--set", "render.height_px=24")
    assert symolo(*command).code == symolo(*command).code == 0
    before = {path: path.read_bytes() for path in Path("CW-test_1-lab").rglob("*.jpg")}
    ended = symolo(*command, "--seed", 77)
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert (
        "contains images of a different trajectory or a different draw of the look; name a folder with --out"
        in ended.err
    )
    assert before
    assert before == {path: path.read_bytes() for path in Path("CW-test_1-lab").rglob("*.jpg")}


def test_fields_of_a_look_may_be_set_all_at_once(run, prepared):
    """As a mapping that is laid over it; only another name or `extends` would be another look."""
    (one,) = prepared(run, RerenderRequest(("lab",), overrides=("look={sun: {elevation_deg: 31}}",)))
    assert (one.spec.key, one.spec.look.sun.elevation_deg) == ("CW/test_1", 31)


def test_a_draws_seed_gives_it_again_alone(run, prepared):
    """What metadata.json says is enough: the same look, light, stains and noise by --look and --seed."""
    draws = prepared(run, RerenderRequest(("classroom", "lab"), 2, option="--looks"))
    assert [draw.spec.route for draw in draws] == [f"CW-{look}_{k}" for look in ("classroom", "lab") for k in (1, 2)]
    for draw in draws:
        (alone,) = prepared(run, RerenderRequest((draw.spec.look.name,), seed=draw.spec.seed))
        assert alone.spec.look == draw.spec.look
        assert alone.spec.seed == draw.spec.seed


def test_draws_differ_in_their_looks_alone(run, prepared):
    draws = prepared(run, RerenderRequest(("classroom",), 20, option="--looks"))
    assert len({draw.spec.look.sun.elevation_deg for draw in draws}) == 20
    assert len({draw.spec.seed for draw in draws}) == 20
    assert len({draw.spec.look.floor.material for draw in draws}) > 3
    first = draws[0].spec
    for draw in draws:
        same = draw.spec
        assert (same.arena, same.robot, same.render) == (first.arena, first.robot, first.render)


def test_a_foreign_trajectory_has_one_arena_in_all_draws(run, tmp_path, prepared):
    """Though it is drawn itself, for which the seed of a look is not asked."""
    shutil.copy(run / "data.csv", tmp_path / "data.csv")
    request = RerenderRequest(("lab",), 3, arena="random", camera_hz=1.0, option="--looks")
    draws = prepared(tmp_path / "data.csv", request)
    assert len({draw.spec.arena for draw in draws}) == 1  # pyright: ignore[reportUnhashable] - it is frozen


def test_more_draws_leave_the_first_ones_as_they_are(run, prepared):
    few = prepared(run, RerenderRequest(("classroom",), 2, option="--looks"))
    more = prepared(run, RerenderRequest(("classroom",), 5, option="--looks"))
    assert [each.spec for each in few] == [each.spec for each in more[:2]]


def test_a_route_of_too_long_a_name_is_refused(run, tmp_path, prepared):
    look = tmp_path / "look.yaml"
    look.write_text(f"extends: lab\nname: {'l' * 62}\n")
    with pytest.raises(InputError, match="shorten the name of the look"):
        prepared(run, RerenderRequest((str(look),), option="--looks"))


def test_each_trajectory_stays_in_its_split_under_all_looks(dataset):
    request = RerenderRequest(("lab", "night"), 2, option="--looks")
    sources = read_sources((dataset,), None, ImportRequest((dataset,)))
    assert "splits" not in prepare(sources, request).tree
    split_of = {"CW/test_1": "train", "CCW/test_1": "test"}
    runs = prepare(replace(sources, split_of=split_of), request).tree["splits"]["runs"]
    assert runs == {
        "train": ["CW-lab_1/test_1", "CW-lab_2/test_1", "CW-night_1/test_1", "CW-night_2/test_1"],
        "test": ["CCW-lab_1/test_1", "CCW-lab_2/test_1", "CCW-night_1/test_1", "CCW-night_2/test_1"],
    }
    assert Splits.model_validate({"runs": runs}).runs is not None
