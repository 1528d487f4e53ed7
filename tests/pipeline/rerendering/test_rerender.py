"""Images for a stored trajectory: the same ones again, other looks, and a SyMoLo data.csv with nothing beside it."""

import json
import re
import shutil
import sys

import cv2
import numpy as np
import pytest

import symolo as symolo_reader
from pipeline.cli import main
from pipeline.rerendering.rerender import RerenderRequest, prepare
from pipeline.run_folder.workspace import Workspace
from symolo.dataset.folder_kind import Kind

RUN = "CW/test_1"
OUTPUT = {"data.csv", "image_positions.txt", "images", "side", "job.json", "look.json", "frames.json"}
SIDE = ("side/camera.csv", "side/intrinsics.json", "side/scene.json")
"""Of the images themselves; the same files as a release has."""


@pytest.fixture(autouse=True, scope="module")
def without_pybullet(dataset, tmp_path_factory):
    """Any process that imports pybullet, child or not, fails."""
    assert dataset.is_dir(), "it is made before, with pybullet"
    folder = tmp_path_factory.mktemp("poison")
    (folder / "pybullet.py").write_text("raise SystemExit('pybullet was imported')\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", str(folder))
        patch.delitem(sys.modules, "pybullet", raising=False)
        patch.syspath_prepend(str(folder))
        yield


@pytest.fixture(scope="module")
def again(dataset, tmp_path_factory):
    """CW/test_1 under its own look, read only."""
    out = tmp_path_factory.mktemp("again") / "out"
    assert main(["rerender", str(dataset / RUN), "--look", "classroom", "--out", str(out)]) == 0
    return out


@pytest.fixture(scope="module")
def elsewhere(dataset, tmp_path_factory, tiny):
    """CW/test_1 under another look, read only; made where folders have the names of the program's packages."""
    here = tmp_path_factory.mktemp("a folder of the user")
    for package in ("configs", "blender_scenes", "pipeline"):
        (here / package).mkdir(parents=True)
        (here / package / "__init__.py").write_text("raise SystemExit('not ours')\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(here)
        small = [setting for setting in tiny if "render" in setting]
        assert main(["rerender", str(dataset / RUN / "data.csv"), "--look", "lab", "--out", "out", *small]) == 0
    return here / "out"


def made(out):
    return {path.name for path in out.iterdir() if not path.name.startswith(".")}


def test_the_same_look_gives_the_same_images_and_another_one_others(dataset, again, tmp_path, symolo):
    run, other = dataset / RUN, tmp_path / "other"
    assert made(again) == OUTPUT
    for name in ("data.csv", "image_positions.txt", *SIDE, *(f"images/{i:06d}.jpg" for i in range(1, 7))):
        assert (again / name).read_bytes() == (run / name).read_bytes(), name
    arguments = ("--look", "lab", "--set", "render.width_px=48", "--set", "render.height_px=36", "--workers", 1)
    arguments = ("rerender", dataset / ".stages/simulate/CW/test_1", *arguments, "--out", other)
    assert symolo(*arguments, "--set", "render.annotations=[semantic]").code == 0
    assert made(other) == OUTPUT | {"annotations"}
    assert cv2.imread(str(other / "annotations/semantic/000006.png")).shape == (36, 48, 3)
    assert cv2.imread(str(other / "images/000001.jpg")).shape == (36, 48, 3)
    assert (other / "data.csv").read_bytes() == (run / "data.csv").read_bytes()
    pictures = {path: path.stat().st_mtime_ns for path in (other / ".stages").rglob("*.jpg")}
    assert symolo(*arguments).code == 0
    assert made(other) == OUTPUT
    assert {path: path.stat().st_mtime_ns for path in (other / ".stages").rglob("*.jpg")} == pictures


@pytest.mark.parametrize("name", ["CW/test_1", "CCW/test_1/data.csv"])
def test_an_arena_drawn_at_random_has_its_line_where_the_trajectory_begins(dataset, name):
    _, (draw,) = prepare(dataset / name, RerenderRequest(("lab",), arena="random"))
    first = draw.appearance.arena.line.pieces[0]
    yaw_deg = -90 if name.startswith("CW/") else 90
    along = np.subtract(first.end, first.start)
    assert np.degrees(np.arctan2(along[1], along[0])) == pytest.approx(yaw_deg, abs=1.0)
    start = np.genfromtxt(dataset / "/".join(name.split("/")[:2]) / "data.csv", delimiter=",", names=True)[0]
    to_start = np.subtract((start["x"], start["y"]), first.start)
    assert along[0] * to_start[1] - along[1] * to_start[0] == pytest.approx(0, abs=1e-6)


def test_packages_of_the_same_name_where_the_user_stands_are_not_ours(elsewhere):
    """A folder `configs` is nothing unusual; no child process may take it for the program's."""
    assert made(elsewhere) == OUTPUT


def test_a_foreign_data_csv_is_enough(dataset, tmp_path, symolo, tiny):
    """No image is numbered in it, times jitter, digits are others; the last row is beyond the third period."""
    header, *rows = (dataset / "CCW/test_1/data.csv").read_text().splitlines()
    cells = [row.split(",") for row in rows[:10]]
    for i, row in enumerate(cells):
        row[0], row[1], row[-1] = str(50 * i + i % 3), f"{float(row[1]):.9f}", "0"
    foreign = tmp_path / "elsewhere.csv"
    foreign.write_text("\n".join([header, *(",".join(row) for row in cells)]) + "\n")
    out = tmp_path / "out"
    small = [setting for setting in tiny if "render" in setting]
    arguments = ("rerender", foreign, "--look", "classroom", "--camera-hz", 5, "--out", out, *small)
    assert symolo(*arguments).code == 0
    assert made(out) == OUTPUT
    assert sorted(path.name for path in (out / "images").iterdir()) == ["000001.jpg", "000002.jpg", "000003.jpg"]
    table = np.genfromtxt(out / "data.csv", delimiter=",", names=True)
    np.testing.assert_array_equal(table["img"], [1, 0, 0, 0, 2, 0, 0, 0, 3, 0])
    positions = np.genfromtxt(out / "image_positions.txt", names=True)
    np.testing.assert_array_equal(positions["img"], [1, 2, 3])
    taken = table[table["img"] > 0]
    for name in ("x", "y", "theta"):
        np.testing.assert_array_equal(positions[name], taken[name])
    before = {path: path.stat().st_mtime_ns for path in (out / ".stages").rglob("*.jpg")}
    assert symolo(*arguments).code == 0
    assert {path: path.stat().st_mtime_ns for path in (out / ".stages").rglob("*.jpg")} == before


def test_a_damaged_trajectory_is_one_clear_line(dataset, copy_of, tmp_path, symolo):
    run = copy_of(dataset, stages=True) / ".stages/simulate/CW/test_1"
    (run / "trajectory.npz").write_bytes((run / "trajectory.npz").read_bytes()[:500])
    ended = symolo("rerender", run, "--look", "lab", "--out", tmp_path / "out")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert "trajectory.npz: cannot be read" in ended.err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("array", "row", "number", "message"),
    [
        ("pose", 0, np.nan, "pose: nan at row 0"),
        ("pose", 3, np.nan, "pose: nan at row 3"),  # no image is taken there, but the path leads through
        ("t_s", 2, np.nan, "t_s: nan at row 2"),
        ("t_s", 2, 0.0, "trajectory: time is not strictly increasing"),
        ("series/line/1/values", 5, np.inf, "series/line/1/values: inf at row 5"),
    ],
)
def test_a_trajectory_with_a_number_that_cannot_be_is_one_clear_line(
    dataset, copy_of, tmp_path, symolo, array, row, number, message
):
    run = copy_of(dataset, stages=True) / ".stages/simulate/CW/test_1"
    with np.load(run / "trajectory.npz") as archive:
        arrays = {name: archive[name] for name in archive.files}
    arrays[array][(row, *(0,) * (arrays[array].ndim - 1))] = number
    np.savez_compressed(run / "trajectory.npz", **arrays)
    ended = symolo("rerender", run, "--look", "lab", "--out", tmp_path / "out")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert f"trajectory.npz: cannot be read: {message}" in ended.err
    assert "simulate again" in ended.err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("whole", "damaged", "message"),
    [
        ('"mass_kg":', '"mass_kg":"much","_":', "robot.chassis.mass_kg: Input should be a valid number"),
        ('"mass_kg":', '"mass":', "robot.chassis.mass_kg: Field required"),
        ("{", "", "Invalid JSON"),
    ],
)
def test_a_damaged_specification_is_reported_by_its_field(dataset, copy_of, tmp_path, symolo, whole, damaged, message):
    path = copy_of(dataset) / RUN / "side/spec.json"
    path.write_text(re.sub(f"{whole}\\s*", damaged, path.read_text(), count=1))
    ended = symolo("rerender", path.parents[1], "--look", "lab", "--out", tmp_path / "out")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert f"spec.json: cannot be read: {message}" in ended.err


@pytest.mark.parametrize("stages", [True, False])
def test_a_dataset_is_no_place_for_re_rendered_images(dataset, copy_of, symolo, stages):
    out = copy_of(dataset, stages=stages)
    before = {path: path.stat().st_mtime_ns for path in out.rglob("*")}
    ended = symolo("rerender", dataset / "CW/test_1", "--look", "lab", "--out", out)
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert "holds the output of `symolo release`" in ended.err
    assert {path: path.stat().st_mtime_ns for path in out.rglob("*")} == before


def test_re_rendered_images_are_no_place_for_a_dataset(tmp_path, symolo, tiny):
    out = tmp_path / "pictures"
    with Workspace(out, Kind.PICTURES).locked():
        pass
    ended = symolo("release", "smoke", "--out", out, *tiny)
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert "holds the output of `symolo rerender --look`" in ended.err


def test_an_interrupted_change_of_the_images_is_not_taken_for_finished(
    dataset, again, elsewhere, copy_of, symolo, release_of, monkeypatch
):
    """frames.json, the list of the images, comes last; the old one goes before the first image does."""
    out = copy_of(again, stages=True)
    shutil.rmtree(out / ".stages/render")  # rendered already are those of the other look
    shutil.copytree(elsewhere / ".stages/render", out / ".stages/render")
    arguments = ("rerender", dataset / RUN, "--look", "lab", "--out", out)

    def killed(_new, _path):
        raise KeyboardInterrupt

    monkeypatch.setattr("pipeline.rerendering.rerender.replace_folder", killed)
    assert symolo(*arguments).code == 130
    monkeypatch.undo()
    assert not (out / "frames.json").exists()
    assert symolo(*arguments).code == 0
    assert release_of(out) == release_of(elsewhere)


def test_every_piece_of_furniture_is_recorded_as_it_was_rendered(dataset, again):
    """side/scene.json against the meshes of the job; what furniture there can be by the look's own fields."""
    scene = json.loads((again / "side/scene.json").read_text())
    meshes = {mesh["name"]: mesh for mesh in json.loads((again / "job.json").read_text())["scene"]["meshes"]}
    sides = "east|north|west|south|window"
    of_the_room = rf"(?:blinds|ceiling|floor|(?:{sides}|desk_lamp|lamp|tape|paint|wall|obstacle)_.*)"
    names = [piece["name"] for piece in scene["furniture"]]
    assert set(names) == {name for name in meshes if not re.fullmatch(of_the_room, name)}
    assert {"table_0", "chair_0", "shelf_0"} <= set(names)
    for piece in scene["furniture"]:
        x, y, z = np.array(meshes[piece["name"]]["vertices"]).T
        c, s = np.cos(piece["yaw_rad"]), np.sin(piece["yaw_rad"])
        along, across = c * (x - piece["x_m"]) + s * (y - piece["y_m"]), c * (y - piece["y_m"]) - s * (x - piece["x_m"])
        assert 2 * np.abs([along, across]).max(axis=1) == pytest.approx(piece["size_m"], abs=1e-4)
        assert (z.min(), z.max()) == pytest.approx(piece["z_m"], abs=1e-5)
    table = next(piece for piece in scene["furniture"] if piece["name"] == "table_0")
    assert table["numbers"]["size_m"] == pytest.approx([*table["size_m"], table["z_m"][1]], abs=1e-6)
    assert table["numbers"]["top"].keys() == {"reflectance", "hue_deg", "saturation"}
    others = [(dataset / run / "side/scene.json").read_bytes() for run in (RUN, "CCW/test_1")]
    assert others[0] != others[1]


@pytest.mark.usefixtures("hands")
def test_the_camera_is_recorded_as_in_a_release(dataset, tmp_path, symolo):
    """Another robot, look and size than the run's; numbers from docs/looks.md and the robot's file."""
    settings = ("robot.camera.pitch_down_deg=25", "robot.camera.read_out_s=0.016", "look.camera.exposure_time_s=0.008")
    settings += ("render.width_px=32", "render.height_px=24")
    chosen = ("--look", "lab", "--robot", "nominal", *(f"--set={setting}" for setting in settings))
    out = tmp_path / "out"
    assert symolo("rerender", dataset / RUN, *chosen, "--out", out).code == 0
    model = json.loads((out / "side/intrinsics.json").read_text())
    assert (model["width_px"], model["height_px"], model["exposure_s"], model["read_out_s"]) == (32, 24, 0.008, 0.016)
    assert [row[2] for row in model["K"]] == [15.5, 11.5, 1.0]
    cameras = np.genfromtxt(out / "side/camera.csv", delimiter=",", names=True)
    positions = np.genfromtxt(out / "image_positions.txt", names=True)
    np.testing.assert_array_equal(cameras["img"], positions["img"])
    yaw, pitch = positions["theta"], np.radians(25)
    # The axis, third column of X_WC: ahead by the heading, down by the pitch.
    for name, expected in (
        ("r13", np.cos(yaw) * np.cos(pitch)),
        ("r23", np.sin(yaw) * np.cos(pitch)),
        ("r33", np.full(6, -np.sin(pitch))),
    ):
        np.testing.assert_allclose(cameras[name], expected, rtol=0, atol=1e-8)
    np.testing.assert_allclose(cameras["exposure_start"], cameras["t"] - 4 - 8 + 8 / 24, rtol=0, atol=1e-3)


def test_a_folder_of_a_version_without_side_is_filled_again_and_nothing_is_rendered(
    again, dataset, copy_of, symolo, release_of
):
    out = copy_of(again, stages=True)
    shutil.rmtree(out / "side")
    marker = out / ".stages/assemble/rerender/done.json"
    done = json.loads(marker.read_text())
    files = {name: digest for name, digest in done["files"].items() if name not in SIDE}
    assert len(files) == len(done["files"]) - len(SIDE)
    marker.write_text(json.dumps({"key": "of another version", "files": files}))
    rendered = {path: path.stat().st_mtime_ns for path in (out / ".stages/render").rglob("*")}
    assert symolo("rerender", dataset / RUN, "--look", "classroom", "--out", out).code == 0
    assert release_of(out) == release_of(again)
    assert {path: path.stat().st_mtime_ns for path in (out / ".stages/render").rglob("*")} == rendered


def test_finished_images_are_left_alone_and_damaged_ones_put_back(dataset, again, copy_of, symolo, release_of):
    out = copy_of(again, stages=True)
    arguments = ("rerender", dataset / RUN, "--look", "classroom", "--out", out)
    times = {path: path.stat().st_mtime_ns for path in out.rglob("*")}
    assert symolo(*arguments).code == 0
    assert {path: path.stat().st_mtime_ns for path in out.rglob("*")} == times
    before = release_of(out)
    for name in ("images/000002.jpg", *SIDE):
        (out / name).write_bytes(b"damaged")
        assert symolo(*arguments).code == 0
        assert release_of(out) == before


def test_render_settings_are_drawn_with_the_key_of_the_request(dataset):
    """As a look's values are: others for another run or another seed, the same ones for the same."""

    def samples(run, **options):
        request = RerenderRequest(("lab",), overrides=("render.samples={uniform: [1, 4096]}",), **options)
        _, (draw,) = prepare(dataset / run, request)
        return draw.appearance.render.samples

    assert samples("CW/test_1") == samples("CW/test_1")
    assert len({samples("CW/test_1"), samples("CCW/test_1"), samples("CW/test_1", seed=7)}) == 3


def test_the_reader_takes_the_images_with_the_poses_and_camera_of_the_run(dataset, again):
    run, pictures = symolo_reader.load(dataset)[RUN], symolo_reader.load(again).runs[0]
    np.testing.assert_allclose(pictures.X_WC, run.X_WC, rtol=0, atol=1e-6)
    told, true = pictures.camera, run.camera
    for name in ("K", "D", "X_RC", "X_CB"):
        np.testing.assert_allclose(getattr(told, name), getattr(true, name), rtol=0, atol=1e-8)
    sizes = [(one.width_px, one.height_px, one.exposure_s, one.read_out_s) for one in (told, true)]
    assert sizes[0] == sizes[1]
    for one, other in zip(pictures, run, strict=True):
        np.testing.assert_array_equal(one.pixels(), other.pixels())
        assert (one.t_s, one.pose.tolist()) == (other.t_s, other.pose.tolist())


def test_what_re_rendered_images_lack_is_named_with_where_it_is(again, tmp_path, symolo, copy_of):
    pictures = symolo_reader.load(again).runs[0]
    assert pictures.side_names == ("camera",)
    assert pictures.side("camera")["img"].tolist() == [*pictures.numbers]
    for ask in (lambda: pictures.side("wheels"), lambda: pictures.spec):
        with pytest.raises(symolo_reader.InputError, match="those of the run that the images were made from"):
            ask()
    refused = symolo("export", again, "--format", "kitti", "--out", tmp_path / "out")
    assert (refused.code, refused.err.count("\n")) == (2, 1)
    assert "export the release whose run was rendered" in refused.err
    draws = tmp_path / "draws"
    shutil.copytree(again, draws / "classroom_1", ignore=shutil.ignore_patterns(".stages"))
    with pytest.raises(symolo_reader.InputError, match=r"holds draws of .*name the folder of one, such as classroom_1"):
        symolo_reader.load(draws)
    damaged = copy_of(again)
    (damaged / "side/intrinsics.json").write_text("{}")
    with pytest.raises(symolo_reader.InputError, match=r"intrinsics\.json: is damaged"):
        _ = symolo_reader.load(damaged).runs[0].camera
