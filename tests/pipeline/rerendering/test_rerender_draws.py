"""Several draws of several looks for one stored trajectory."""

import json
import shutil
from pathlib import Path

import cv2
import pytest

from pipeline.rerendering.rerender import RerenderRequest, draw_seed, prepare


@pytest.fixture(scope="module")
def run(dataset):
    return dataset / "CW/test_1"


def test_the_first_draw_is_the_runs_own_and_every_draw_a_folder_like_a_single_one(run, tmp_path, symolo):
    out = tmp_path / "looks"
    arguments = ("rerender", run, "--looks", "classroom", "--draws", 2, "--out", out)
    ended = symolo(*arguments)
    assert ended.code == 0
    assert f"rerender: 2 of 2 draws, in {out}" in ended.out
    assert sorted(path.name for path in out.iterdir()) == [".stages", "classroom_1", "classroom_2"]
    first, second = out / "classroom_1", out / "classroom_2"
    for image in sorted((run / "images").iterdir()):
        assert (first / "images" / image.name).read_bytes() == image.read_bytes()
        assert (second / "images" / image.name).read_bytes() != image.read_bytes()
    names = {"data.csv", "image_positions.txt", "images", "side", "job.json", "look.json", "frames.json", ".stages"}
    assert {path.name for path in first.iterdir()} == {path.name for path in second.iterdir()} == names
    records = [json.loads((folder / "look.json").read_text()) for folder in (first, second)]
    own = json.loads((run / "side/spec.json").read_text())
    drawn = {path: value for path, value in own["drawn"].items() if path.startswith("look.")}
    assert (records[0]["draw"], records[0]["seed"], records[0]["drawn"]) == (1, own["seed"], drawn)
    assert (records[1]["draw"], records[1]["seed"]) == (2, draw_seed(own["seed"], 2))
    assert records[1]["drawn"].keys() == drawn.keys()
    assert records[1]["look"]["room"]["height_m"] == records[1]["drawn"]["look.room.height_m"]
    _continues_and_is_looked_at(out, arguments, symolo, tmp_path / "sheet.png")


def _continues_and_is_looked_at(out, arguments, symolo, sheet):
    times = {path: path.stat().st_mtime_ns for path in out.rglob("*.jpg")}
    (out / "classroom_2/images/000002.jpg").write_bytes(b"damaged")
    assert symolo(*arguments).code == 0
    kept = {path: path.stat().st_mtime_ns for path in out.rglob("*.jpg") if path.parent != out / "classroom_2/images"}
    assert kept.items() <= times.items()
    assert cv2.imread(str(out / "classroom_2/images/000002.jpg")).shape == (24, 32, 3)
    assert symolo("contact-sheet", out, "--out", sheet, "--per-run", 3, "--width-px", 32).code == 0
    assert cv2.imread(str(sheet)).shape == (2 * (24 + 18), 3 * 32, 3)
    refused = symolo("rerender", *arguments[1:2], "--look", "classroom", "--out", out)
    assert (refused.code, refused.err.count("\n")) == (2, 1)
    assert "holds the output of `symolo rerender --looks`" in refused.err


def test_no_other_command_works_in_the_folder_of_a_draw(run, tmp_path, symolo):
    kind = tmp_path / "looks/.stages/kind"
    kind.parent.mkdir(parents=True)
    kind.write_text("looks\n")
    refused = symolo("rerender", run, "--look", "classroom", "--out", tmp_path / "looks/classroom_1")
    assert (refused.code, refused.err.count("\n")) == (2, 1)
    assert "belongs to the output of `symolo rerender --looks`" in refused.err
    assert not (tmp_path / "looks/classroom_1").exists()


@pytest.mark.usefixtures("hands")
def test_without_out_the_folder_is_named_by_run_and_looks(run, tmp_path, symolo, monkeypatch):
    """As the project describes its use; one of our runs by route and number, what comes from elsewhere by its file."""
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
        (foreign, ("--look", "lab"), "elsewhere-lab"),
        ("../elsewhere", ("--look", "classroom"), "elsewhere-classroom"),
        ("../drive.csv", ("--look", "lab"), "drive-lab"),
    ):
        ended = symolo("rerender", source, *looks, *small)
        assert (ended.code, ended.out.split(", in ")[-1]) == (0, f"{name}\n")
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


def test_fields_of_a_look_may_be_set_all_at_once(run):
    """As a mapping that is laid over it; only another name or `extends` would be another look."""
    _, (draw,) = prepare(run, RerenderRequest(("lab",), overrides=("look={sun: {elevation_deg: 31}}",)))
    assert (draw.name, draw.appearance.look.sun.elevation_deg) == ("lab_1", 31)


def test_a_draws_seed_gives_it_again_alone(run):
    """What look.json says is enough: the same look, light, stains and noise by --look and --seed."""
    _, draws = prepare(run, RerenderRequest(("classroom", "lab"), 2))
    assert [draw.name for draw in draws] == [f"{look}_{k}" for look in ("classroom", "lab") for k in (1, 2)]
    for draw in draws:
        look, seed = draw.name.rpartition("_")[0], json.loads(draw.record)["seed"]
        _, (alone,) = prepare(run, RerenderRequest((look,), seed=seed))
        assert alone.appearance == draw.appearance


def test_draws_differ_in_their_looks_alone(run):
    _, draws = prepare(run, RerenderRequest(("classroom",), 20))
    assert len({draw.appearance.look.sun.elevation_deg for draw in draws}) == 20
    assert len({draw.appearance.seed for draw in draws}) == 20
    assert len({draw.appearance.look.floor.material for draw in draws}) > 3
    first = draws[0].appearance
    for draw in draws:
        same = draw.appearance
        assert (same.arena, same.robot, same.render) == (first.arena, first.robot, first.render)


def test_a_foreign_trajectory_has_one_arena_in_all_draws(run):
    """Though it is drawn itself, for which the seed of a look is not asked."""
    arguments = {"arena": "random", "camera_hz": 1.0}
    _, draws = prepare(run / "data.csv", RerenderRequest(("lab",), 3, **arguments))
    assert len({draw.appearance.arena for draw in draws}) == 1  # pyright: ignore[reportUnhashable] - it is frozen


def test_more_draws_leave_the_first_ones_as_they_are(run):
    _, few = prepare(run, RerenderRequest(("classroom",), 2))
    _, more = prepare(run, RerenderRequest(("classroom",), 5))
    assert few == more[:2]
