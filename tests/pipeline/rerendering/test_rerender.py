"""Images for existing trajectories: the same ones again, other looks, all runs of a dataset, and foreign files."""

import json
import re
import shutil
import sys

import cv2
import numpy as np
import pytest

import symolo as symolo_reader
from blender_scenes.render.job_file import job_path, read_job
from pipeline.cli import main
from pipeline.rerendering.rerender import RerenderRequest
from pipeline.run_folder.workspace import Workspace
from pipeline.stages.cameras import cameras_of
from symolo.dataset.folder_kind import Kind

RUN, OTHER = "CW/test_1", "CCW/test_1"
TOP = {"README.md", "bag-info.txt", "manifest-sha256.txt", "metadata.json", "tagmanifest-sha256.txt"}
SIDE = ("side/camera.csv", "side/intrinsics.json", "side/scene.json")
"""Of the images themselves."""
SMALL = ("--set", "render.width_px=32", "--set", "render.height_px=24", "--set", "render.samples=1")
ALONE = ("--workers", "1")
"""One process of Python and one of Blender, where a test is not about several."""


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
    assert main(["rerender", str(dataset / RUN), "--look", "classroom", "--out", str(out), *ALONE]) == 0
    return out


@pytest.fixture(scope="module")
def elsewhere(dataset, tmp_path_factory):
    """Both runs under another look, read only; made where folders have the names of the program's packages."""
    here = tmp_path_factory.mktemp("a folder of the user")
    for package in ("configs", "blender_scenes", "pipeline"):
        (here / package).mkdir(parents=True)
        (here / package / "__init__.py").write_text("raise SystemExit('not ours')\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(here)
        assert main(["rerender", str(dataset), "--look", "lab", "--out", "out", *SMALL, *ALONE]) == 0
    return here / "out"


def made(out):
    return {path.name for path in out.iterdir() if not path.name.startswith(".")}


def test_the_same_look_gives_the_same_run_again(dataset, again, symolo):
    """Every file of the run, but for its specification, which says where the trajectory comes from."""
    assert made(again) == TOP | {"CW"}
    files = {path.relative_to(dataset / RUN) for path in (dataset / RUN).rglob("*") if path.is_file()}
    assert files == {path.relative_to(again / RUN) for path in (again / RUN).rglob("*") if path.is_file()}
    for name in files:
        if name.as_posix() != "side/spec.json":
            assert (again / RUN / name).read_bytes() == (dataset / RUN / name).read_bytes(), name
    assert symolo("verify", again).code == 0
    old, new = (json.loads((root / RUN / "side/spec.json").read_text()) for root in (dataset, again))
    origin = new.pop("origin")["release"]
    assert (origin["name"], origin["run"], len(origin["manifest_sha256"])) == ("smoke", RUN, 64)
    assert {key for key in old if old[key] != new[key]} == {"scenario"}


def test_all_runs_of_a_dataset_become_a_release_like_any_other(dataset, elsewhere, tmp_path, symolo):
    assert made(elsewhere) == TOP | {"CW", "CCW"}
    assert symolo("verify", elsewhere).code == 0
    data, source = symolo_reader.load(elsewhere), symolo_reader.load(dataset)
    assert {run.name for run in data} == {RUN, OTHER}
    for run in data:
        np.testing.assert_array_equal(run.rows.to_numpy(), source[run.name].rows.to_numpy())
        assert run.side("wheels").equals(source[run.name].side("wheels"))
        assert run.images[0].pixels().shape == (24, 32, 3)
        assert run.spec.origin.text == f"taken from {run.name} of smoke"
    metadata = json.loads((elsewhere / "metadata.json").read_text())
    assert (metadata["name"], metadata["licence"]) == ("smoke-lab", "CC-BY-4.0")
    assert {record["origin"]["release"]["run"] for record in metadata["runs"]} == {RUN, OTHER}
    assert symolo("report", elsewhere, "--out", tmp_path / "report.html").code == 0
    assert f"taken from {RUN} of smoke" in (tmp_path / "report.html").read_text()
    assert symolo("export", elsewhere, "--format", "kitti,parquet", "--out", tmp_path / "exported").code == 0
    assert f"{RUN}: trajectory taken from {RUN} of smoke" in symolo("status", elsewhere).out


def test_a_dry_run_prints_the_runs_and_writes_nothing(dataset, tmp_path, symolo):
    out = tmp_path / "out"
    ended = symolo("rerender", dataset, "--looks", "lab,night", "--out", out, "--dry-run")
    assert ended.code == 0
    first, *_, cost, last = ended.out.splitlines()
    assert re.fullmatch(r"CW-lab_1/test_1: look lab, \d+ images?", first)
    assert re.fullmatch(r".*/out: 4 runs, \d+ images; nothing was rendered", last)
    assert re.fullmatch(r"on one core without a graphics card about \d.*; disk about \d+ MB, stages included", cost)
    assert not out.exists()


def test_a_dry_run_counts_the_images_of_all_cameras(dataset, tmp_path, symolo):
    """Runs of a second have two images of a camera of 1 Hz."""
    rear = "robot.sensors.rear={kind: camera, z_m: 0.1, rate_hz: 1, width_px: 32, height_px: 24}"
    counts = []
    for settings in ((), ("--set", rear)):
        ended = symolo("rerender", dataset, "--look", "lab", *settings, "--out", tmp_path / "out", "--dry-run")
        counts.append([int(text) for text in re.findall(r"look lab, (\d+) image", ended.out)])
    without, both = np.array(counts)
    assert (both - without).tolist() == [2, 2]


def test_a_part_of_the_runs_is_chosen_by_a_pattern(dataset, prepared):
    (one,) = prepared(dataset, RerenderRequest(("lab",)), "CCW/*")
    assert one.spec.key == OTHER


@pytest.mark.usefixtures("hands")
def test_a_run_that_is_simulated_only_is_rendered(dataset, tmp_path, symolo):
    out = tmp_path / "other"
    arguments = ("rerender", dataset / ".stages/simulate/CW/test_1", "--look", "lab", *SMALL, *ALONE)
    arguments = (*arguments, "--out", out)
    assert symolo(*arguments, "--set", "render.annotations=[semantic]").code == 0
    assert symolo("verify", out).code == 0
    assert cv2.imread(str(out / RUN / "annotations/semantic/000006.png")).shape == (24, 32, 3)
    assert (out / RUN / "data.csv").read_bytes() == (dataset / RUN / "data.csv").read_bytes()
    images = {path: path.stat().st_mtime_ns for path in (out / ".stages").rglob("*.jpg")}
    assert "annotations (semantic) would be lost" in symolo(*arguments).err
    assert symolo(*arguments, "--replace").code == 0
    assert not (out / RUN / "annotations").exists()
    assert {path: path.stat().st_mtime_ns for path in (out / ".stages").rglob("*.jpg")} == images


@pytest.mark.parametrize("name", [RUN, f"{OTHER}/data.csv"])
def test_an_arena_drawn_at_random_has_its_line_where_the_trajectory_begins(dataset, name, prepared):
    (run,) = prepared(dataset / name, RerenderRequest(("lab",), arena="random"))
    first = run.spec.arena.line.pieces[0]
    yaw_deg = -90 if name.startswith("CW/") else 90
    along = np.subtract(first.end, first.start)
    assert np.degrees(np.arctan2(along[1], along[0])) == pytest.approx(yaw_deg, abs=1.0)
    start = np.genfromtxt(dataset / "/".join(name.split("/")[:2]) / "data.csv", delimiter=",", names=True)[0]
    to_start = np.subtract((start["x"], start["y"]), first.start)
    assert along[0] * to_start[1] - along[1] * to_start[0] == pytest.approx(0, abs=1e-6)
    assert any("the readings are those of the arena symolo" in text for text in run.outcome.suspicions)


@pytest.mark.usefixtures("hands")
def test_a_foreign_data_csv_is_enough(dataset, tmp_path, symolo):
    """No image is numbered in it, times jitter, digits are others; the last row is beyond the third period."""
    header, *rows = (dataset / OTHER / "data.csv").read_text().splitlines()
    cells = [row.split(",") for row in rows[:10]]
    for i, row in enumerate(cells):
        row[0], row[1], row[-1] = str(50 * i + i % 3), f"{float(row[1]):.9f}", "0"
    foreign = tmp_path / "elsewhere.csv"
    foreign.write_text("\n".join([header, *(",".join(row) for row in cells)]) + "\n")
    out = tmp_path / "out"
    arguments = ("rerender", foreign, "--look", "classroom", "--camera-hz", 5, "--out", out, *SMALL, *ALONE)
    assert symolo(*arguments).code == 0
    assert symolo("verify", out).code == 0
    run = out / "imported/test_1"
    assert sorted(path.name for path in (run / "images").iterdir()) == ["000001.jpg", "000002.jpg", "000003.jpg"]
    table = np.genfromtxt(run / "data.csv", delimiter=",", names=True)
    np.testing.assert_array_equal(table["img"], [1, 0, 0, 0, 2, 0, 0, 0, 3, 0])
    positions = np.genfromtxt(run / "image_positions.txt", names=True)
    np.testing.assert_array_equal(positions["img"], [1, 2, 3])
    taken = table[table["img"] > 0]
    for name in ("x", "y", "theta"):
        np.testing.assert_array_equal(positions[name], taken[name])
    before = {path: path.stat().st_mtime_ns for path in (out / ".stages").rglob("*.jpg")}
    assert symolo(*arguments).code == 0
    assert {path: path.stat().st_mtime_ns for path in (out / ".stages").rglob("*.jpg")} == before


def test_a_log_of_another_program_is_rendered_without_an_import_before(tmp_path, prepared):
    """Poses on a circle in the format of TUM: 6 s of them, so 30 images at the default 5 Hz."""
    t_s = 0.1 * np.arange(60)
    yaw = 0.5 * t_s + 0.5 * np.pi
    none = np.zeros_like(t_s)
    place = 0.6 * np.stack([np.sin(yaw), -np.cos(yaw)])
    np.savetxt(tmp_path / "log.txt", np.column_stack([t_s, *place, none, none, none, np.sin(yaw / 2), np.cos(yaw / 2)]))
    runs = prepared(tmp_path / "log.txt", RerenderRequest(("classroom", "lab"), option="--looks"))
    assert [run.spec.key for run in runs] == ["imported-classroom_1/test_1", "imported-lab_1/test_1"]
    assert [int(np.count_nonzero(run.rows.image)) for run in runs] == [30, 30]
    assert {run.spec.origin.log.format for run in runs} == {"tum"}


def test_a_damaged_trajectory_is_one_clear_line(dataset, copy_of, tmp_path, symolo):
    run = copy_of(dataset, stages=True) / ".stages/simulate/CW/test_1"
    (run / "trajectory.npz").write_bytes((run / "trajectory.npz").read_bytes()[:500])
    ended = symolo("rerender", run, "--look", "lab", "--out", tmp_path / "out")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert "trajectory.npz: cannot be read" in ended.err
    assert not (tmp_path / "out").exists()


def test_a_damaged_dataset_is_refused_before_anything_is_made(dataset, copy_of, tmp_path, symolo):
    root = copy_of(dataset)
    data = root / RUN / "data.csv"
    data.write_bytes(data.read_bytes().replace(b"\n50,", b"\n51,", 1))
    ended = symolo("rerender", root, "--look", "lab", "--out", tmp_path / "out")
    assert (ended.code, ended.err.count("\n"), "data.csv" in ended.err) == (2, 1, True), ended.err
    assert not (tmp_path / "out").exists()


def _shorter(run):
    lines = (run / "data.csv").read_text().splitlines(keepends=True)
    (run / "data.csv").write_text("".join(lines[:10]))


def _edited(run):
    path = run / "side/wheels.csv"
    head, first, *others = path.read_text().splitlines(keepends=True)
    path.write_text("".join([head, first.replace("0.0", "0.1", 1), *others]))


@pytest.mark.parametrize(
    ("damage", "is_alone", "message"),
    [
        (_shorter, True, "side/wheels.csv: column t is not that of data.csv; make the run again"),
        (_shorter, False, "side/wheels.csv: column t is not that of data.csv; restore it with `symolo repair "),
        (_edited, False, "side/wheels.csv: its SHA-256 is not that of manifest-sha256.txt; restore it with `symolo "),
    ],
)
def test_a_damaged_run_is_refused_before_anything_is_made(dataset, tmp_path, symolo, damage, is_alone, message):
    """The rows that are left are well-formed, so only other files show that some are missing."""
    run = tmp_path / "copy" / RUN
    if is_alone:
        shutil.copytree(dataset / RUN, run)
    else:
        shutil.copytree(dataset, tmp_path / "copy", ignore=shutil.ignore_patterns(".stages"))
    damage(run)
    ended = symolo("rerender", run, "--look", "lab", "--out", tmp_path / "out")
    assert (ended.code, ended.err.count("\n"), message in ended.err) == (2, 1, True), ended.err
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
    ended = symolo("rerender", dataset / RUN, "--look", "lab", "--out", out)
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert "holds the output of `symolo release`" in ended.err
    assert {path: path.stat().st_mtime_ns for path in out.rglob("*")} == before


def test_re_rendered_images_are_no_place_for_a_dataset(tmp_path, symolo, tiny):
    out = tmp_path / "images"
    with Workspace(out, Kind.RERENDERED).locked():
        pass
    ended = symolo("release", "smoke", "--out", out, *tiny)
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert "holds the output of `symolo rerender`" in ended.err


@pytest.mark.parametrize(
    ("part", "command"), [(RUN, "verify"), ("CW", "verify"), (f"{RUN}/images", "verify"), (RUN, "export")]
)
def test_a_part_of_a_dataset_is_answered_by_what_to_type(dataset, tmp_path, symolo, part, command):
    rest = ("--format", "tum", "--out", tmp_path / "out") if command == "export" else ()
    ended = symolo(command, dataset / part, *rest)
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    cure = f"name {dataset}, and choose the run with --runs 'CW/test_1'" if rest else f"`symolo verify {dataset}`"
    assert cure in ended.err


def test_every_piece_of_furniture_is_recorded_as_it_was_rendered(dataset, again):
    """side/scene.json against the meshes of the job; what furniture there can be by the look's own fields."""
    scene = json.loads((again / RUN / "side/scene.json").read_text())
    job = json.loads(read_job(job_path(again / ".stages/render" / RUN)))
    meshes = {mesh["name"]: mesh for mesh in job["scene"]["meshes"]}
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
    others = [(dataset / run / "side/scene.json").read_bytes() for run in (RUN, OTHER)]
    assert others[0] != others[1]


@pytest.mark.usefixtures("hands")
def test_the_camera_is_recorded_as_in_a_release(dataset, tmp_path, symolo):
    """Another robot, look and size than the run's; numbers from docs/looks.md and the robot's file."""
    settings = ("robot.camera.pitch_down_deg=25", "robot.camera.read_out_s=0.016", "look.camera.exposure_time_s=0.008")
    settings += ("render.width_px=32", "render.height_px=24")
    chosen = ("--look", "lab", "--robot", "nominal", *(f"--set={setting}" for setting in settings))
    out = tmp_path / "out"
    assert symolo("rerender", dataset / RUN, *chosen, "--out", out).code == 0
    model = json.loads((out / RUN / "side/intrinsics.json").read_text())
    assert (model["width_px"], model["height_px"], model["exposure_s"], model["read_out_s"]) == (32, 24, 0.008, 0.016)
    assert [row[2] for row in model["K"]] == [15.5, 11.5, 1.0]
    cameras = np.genfromtxt(out / RUN / "side/camera.csv", delimiter=",", names=True)
    positions = np.genfromtxt(out / RUN / "image_positions.txt", names=True)
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


def test_the_robot_of_a_simulation_keeps_what_its_readings_came_from(dataset, prepared):
    """Only the camera and the body may be other ones; the option for all others says what to do."""
    request = RerenderRequest(("lab",), overrides=("robot.camera.pitch_down_deg=25",))
    (run,) = prepared(dataset / RUN, request)
    own = json.loads((dataset / RUN / "side/spec.json").read_text())["robot"]
    robot = json.loads(run.spec.robot.model_dump_json())
    assert (robot["camera"]["pitch_down_deg"], robot["motor"], robot["tof"]) == (25, own["motor"], own["tof"])
    (run,) = prepared(dataset / RUN, RerenderRequest(("lab",), robot="classroom"))
    robot = json.loads(run.spec.robot.model_dump_json())
    assert (robot["name"], robot["motor"], robot["controller"]) == ("classroom", own["motor"], own["controller"])
    for setting in ("robot.tof.max_range_m=1", "robot.drive.wheel_radius_m=0.02", "robot.sensors.imu={}"):
        with pytest.raises(symolo_reader.InputError, match="simulate again"):
            prepared(dataset / RUN, RerenderRequest(("lab",), overrides=(setting,)))


def test_images_have_any_rate(dataset, prepared):
    """Rows come 20 times per second; a rate that does not divide this has images between rows too."""
    (run,) = prepared(dataset / RUN, RerenderRequest(("lab",), camera_hz=10))
    assert np.flatnonzero(run.rows.image)[:3].tolist() == [0, 2, 4]
    assert run.spec.rates.camera_hz == 10
    (run,) = prepared(dataset / RUN, RerenderRequest(("lab",), camera_hz=3))
    images = cameras_of(run.spec)[0].rows(run.rows)
    assert images.t_ms[:4].tolist() == [0, 333, 667, 1000]
    assert np.flatnonzero(run.rows.image)[:4].tolist() == [0, 7, 13, 20]
    assert run.outcome.images == len(images.t_ms)
    (run,) = prepared(dataset / RUN, RerenderRequest(("lab",), camera_hz=0.5))
    assert np.flatnonzero(run.rows.image)[:2].tolist() == [0, 40][: run.outcome.images]
    assert run.spec.model_dump(mode="json")["rates"]["camera_hz"] == 0.5


def test_finished_images_are_left_alone_and_damaged_ones_put_back(dataset, again, copy_of, symolo, release_of):
    out = copy_of(again, stages=True)
    arguments = ("rerender", dataset / RUN, "--look", "classroom", "--out", out)
    times = {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.is_file()}
    assert symolo(*arguments).code == 0
    assert {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.is_file()} == times
    before = release_of(out)
    for name in ("images/000002.jpg", *SIDE):
        (out / RUN / name).write_bytes(b"damaged")
        assert symolo(*arguments).code == 0
        assert release_of(out) == before


def test_render_settings_are_drawn_with_the_key_of_the_request(dataset, prepared):
    """As a look's values are: others for another run or another seed, the same ones for the same."""

    def samples(run, **options):
        request = RerenderRequest(("lab",), overrides=("render.samples={uniform: [1, 4096]}",), **options)
        (one,) = prepared(dataset / run, request)
        return one.spec.render.samples

    assert samples(RUN) == samples(RUN)
    assert len({samples(RUN), samples(OTHER), samples(RUN, seed=7)}) == 3


def test_a_rerendered_dataset_is_rendered_again_and_keeps_its_first_origin(dataset, elsewhere, prepared):
    (run,) = prepared(elsewhere, RerenderRequest(("night",)), "CW/*")
    assert run.spec.origin.release.name == "smoke"
    assert (run.rows.to_csv(), set(run.side)) == (
        (dataset / RUN / "data.csv").read_bytes(),
        {"side/wheels.csv", "side/tof.csv"},
    )


def test_a_run_that_was_taken_from_elsewhere_is_repaired_as_far_as_it_can_be(again, copy_of, symolo, release_of):
    """From its stages wholly; without them, the readings cannot be simulated again, which is said."""
    out = copy_of(again, stages=True)
    before = release_of(out)
    (out / RUN / "images/000003.jpg").unlink()
    (out / RUN / "side/wheels.csv").write_text("")
    ended = symolo("repair", out)
    assert (ended.code, release_of(out) == before) == (0, True), ended.out + ended.err
    shutil.rmtree(out / ".stages")
    (out / RUN / "side/wheels.csv").write_text("")
    ended = symolo("repair", out)
    assert ended.code == 4
    assert "was not simulated here" in ended.out + ended.err
