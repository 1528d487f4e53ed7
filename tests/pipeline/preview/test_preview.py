"""The preview: places on the way round an arena, runs as a release draws them, and a sheet by either engine."""

import tempfile
from pathlib import Path

import cv2
import numpy as np
import pytest

import configs
from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.commands.options import look_names
from pipeline.preview.engines import usual_columns
from pipeline.preview.path import PreviewPath
from pipeline.preview.views import views
from symolo.arena.geometry import Arena
from symolo.pages.sheet import LINE_PX

SHARES = np.linspace(0.0, 1.0, 60)


def way_of(scenario: str, route: str) -> tuple[PreviewPath, Arena]:
    spec = draw_run(load_scenario(scenario), route, 1)
    arena = Arena.from_config(spec.arena)
    return PreviewPath.from_spec(spec, arena), arena


def distance_m(point, start, end) -> float:
    """Of a point from a straight piece between two others."""
    p, a, b = (np.array(q) for q in (point, start, end))
    share = np.clip((p - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
    return float(np.linalg.norm(p - a - share * (b - a)))


@pytest.mark.parametrize(("route", "sense"), [("CW", -1), ("CCW", 1)])
def test_places_are_on_the_line_or_beside_the_walls_clear_of_everything_and_face_round_the_arena(route, sense):
    way, arena = way_of("symolo", route)
    config = draw_run(load_scenario("symolo"), route, 1).arena
    poses = [way.place(share, 0.0) for share in SHARES]
    beside = {"A1": 0, "A2": 0, "B": 0}
    for x, y, yaw in poses:
        walls = {wall.name: distance_m((x, y), wall.start, wall.end) for wall in config.walls}
        near = [name for name, away in walls.items() if away == pytest.approx(0.15, abs=1e-6)]  # 0.12 m and the mount
        beside.update({name: beside[name] + 1 for name in near})
        assert near or arena.line.covers(np.array([[x, y]]))[0]
        for box in arena.boxes:
            outline = box.footprint()
            sides = zip(outline, np.roll(outline, -1, axis=0), strict=True)
            assert min(distance_m((x, y), a, b) for a, b in sides) >= 0.085  # half of the chassis' width
        if near or abs(x - 0.55) < 1e-9:  # the far legs; about the arena's middle, (0, 0) by its drawing
            assert sense * (x * np.sin(yaw) - y * np.cos(yaw)) > 0
    assert min(beside.values()) > 0
    headings = {round(np.degrees(yaw)) for x, y, yaw in poses if x == pytest.approx(0.55, abs=1e-9)}
    assert headings == {90 * sense}


@pytest.mark.parametrize("scenario", ["classroom", "random_arenas"])
def test_where_the_line_is_closed_every_place_is_on_it(scenario):
    way, arena = way_of(scenario, load_scenario(scenario).routes[0].name)
    places = np.array([way.place(share, 0.0)[:2] for share in SHARES])
    assert arena.line.covers(places).all()


def test_a_place_without_room_is_left_backwards_so_that_the_obstacle_stands_ahead():
    """O2 stands on the line, its face at y = 0.11; the robot turns aside 0.2 m before, by a sensor 0.085 m before R."""
    way, _ = way_of("symolo", "CCW")
    behind = 0.11 - 0.2 - 0.085
    first = next(leg.piece for leg in way.legs)
    length_m = sum(leg.piece.length_m for leg in way.legs)
    x, y, yaw = way.place((0.15 - first.start[1]) / length_m, 0.0)
    assert (x, np.degrees(yaw)) == (pytest.approx(0.55), pytest.approx(90))
    assert behind - 0.02 <= y <= behind


def test_single_images_are_rendered_in_full_whatever_the_scenario_says(tmp_path):
    file = tmp_path / "in_parts.yaml"
    file.write_text("extends: smoke\nname: in_hybrid\nrender: {method: hybrid}\n")
    loaded = load_scenario(str(file))
    assert draw_run(loaded, loaded.routes[0].name, 1).render.method == "hybrid"
    loaded = load_scenario(str(file))
    assert draw_run(loaded, loaded.routes[0].name, 1).render.method == "hybrid"
    (one,) = views(str(file), (), (), 1, 160)
    assert one.appearance.render.method == "full"


def test_an_arena_with_nothing_to_follow_is_seen_from_the_start():
    spec = draw_run(load_scenario("smoke"), "CCW", 1)
    bare = spec.arena.model_copy(update={"walls": (), "line": spec.arena.line.model_copy(update={"pieces": ()})})
    spec = spec.model_copy(update={"arena": bare})
    start = (spec.start.x_m, spec.start.y_m, np.radians(spec.start.yaw_deg))
    assert PreviewPath.from_spec(spec, Arena.from_config(bare)).place(0.5, 0.0) == pytest.approx(start)


def test_images_are_of_runs_as_a_release_draws_them_whatever_their_number():
    few, more = (list(views("symolo", ("render.samples=1",), (), count, 40)) for count in (2, 5))
    assert [view.job() for view in few] == [view.job() for view in more[:2]]
    runs = [f"{route}/test_{number}" for number in (1, 2, 3) for route in ("CW", "CCW")]
    assert [view.lines[0].split(",")[0] for view in more] == runs[:5]
    spec = draw_run(load_scenario("symolo"), "CCW", 2)
    shown = more[3]
    assert f"seed {spec.seed}, {spec.look.name}" in shown.lines[0]
    assert shown.lines[1].startswith(f"{spec.look.floor.material}, ")
    assert f"lamps {spec.look.lamps.color_temperature_K:.0f} K" in shown.lines[3]
    job = shown.job()
    assert job.sampling.samples == 1
    assert (job.camera.width_px, job.camera.height_px) == (40, 30)
    places = {(view.frame.x_m, view.frame.y_m) for view in more}
    assert len(places) == 5


def test_several_looks_show_the_same_run_from_the_same_place():
    shown = list(views("symolo", (), ("classroom", "lab"), 3, 40))
    first_lines = [view.lines[0] for view in shown[:2]]
    assert first_lines == [f"CW/test_1, seed 2025, {name}" for name in ("classroom", "lab")]
    one, other, later = (view.job() for view in shown)
    assert one.frames[0].X_WC == other.frames[0].X_WC != later.frames[0].X_WC
    assert one.scene.panels != other.scene.panels


def test_all_shipped_looks_are_one_word():
    shipped = sorted(path.stem for path in (Path(configs.__file__).parent / "looks").glob("*.yaml"))
    assert list(look_names("all")) == shipped
    assert look_names("lab,night") == ("lab", "night")


def test_without_out_the_sheet_is_named_by_its_scenario(tmp_path, symolo, monkeypatch):
    (tmp_path / "own").mkdir()
    (tmp_path / "own/study.yaml").write_text("extends: smoke\nname: other\n")
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    for scenario, name in (("smoke", "smoke-preview.jpg"), ("../own/study.yaml", "study-preview.jpg")):
        ended = symolo("preview", scenario, "--engine", "flat", "-n", 2, "--width-px", 64)
        assert (ended.code, ended.out) == (0, f"{name}: 2 of 2 images\n")
    assert sorted(path.name for path in Path().iterdir()) == ["smoke-preview.jpg", "study-preview.jpg"]
    assert cv2.imread("smoke-preview.jpg").shape[1] == 2 * 64
    Path("smoke-preview.jpg").unlink()
    Path("smoke-preview.jpg").mkdir()
    ended = symolo("preview", "smoke", "--engine", "flat", "-n", 2, "--width-px", 64)
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert "--out: got 'smoke-preview.jpg'" in ended.err


def test_a_flat_preview_is_one_file_and_the_same_bytes_again(tmp_path, symolo):
    sheets = []
    for name in ("one.png", "two.png"):
        arguments = ("preview", "smoke", "--engine", "flat", "-n", 3, "--columns", 2, "--width-px", 64)
        ended = symolo(*arguments, "--out", tmp_path / name)
        assert ended.code == 0
        assert "3 of 3 images" in ended.out
        assert "preview: 3 of 3 images" in ended.err
        sheets.append((tmp_path / name).read_bytes())
    assert sheets[0] == sheets[1]
    sheet = cv2.imread(str(tmp_path / "one.png"))
    assert sheet.shape == (2 * (48 + 4 * 18), 2 * 64, 3)
    assert sheet[:48, :64].std() > 5
    assert sheet[48:120, :64].max() > 200  # the text
    assert sheet[120:, 64:].max() == 0  # no fourth image
    assert sorted(path.name for path in tmp_path.iterdir()) == ["one.png", "two.png"]


def test_cycles_previews_what_the_flat_one_does_and_leaves_nothing_behind(tmp_path, symolo, monkeypatch):
    """From the same place: the darkest part, the line or what is black there, is dark in both."""
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(scratch))
    sheets = []
    for engine in ("cycles", "flat"):
        out = tmp_path / f"{engine}.png"
        small = ("-n", 2, "--width-px", 48, "--set", "render.samples=1", "--workers", 1)
        assert symolo("preview", "smoke", "--engine", engine, *small, "--out", out).code == 0
        sheets.append(cv2.imread(str(out), cv2.IMREAD_GRAYSCALE)[:36].astype(float))
    traced, flat = sheets
    assert traced.shape == flat.shape == (36, 96)
    darkest = flat < np.quantile(flat, 0.02)
    assert traced[darkest].mean() < traced[~darkest].mean() - 15
    assert list(scratch.iterdir()) == []


def test_an_image_that_fails_is_reported_and_the_others_are_shown(tmp_path, symolo, monkeypatch):
    def picture(_self, view):
        if view.number == 2:
            raise ValueError("the picture is black")
        return np.full((48, 64, 3), 100, np.uint8)

    monkeypatch.setattr("blender_scenes.preview.renderer.FlatRenderer.image", picture)
    arguments = ("preview", "smoke", "--engine", "flat", "--columns", 3, "--width-px", 64)
    ended = symolo(*arguments, "-n", 3, "--out", tmp_path / "sheet.png")
    assert ended.code == 3
    assert "failed: image 2 (CCW/test_1, classroom): the picture is black" in ended.err
    assert "2 of 3 images" in ended.out
    assert cv2.imread(str(tmp_path / "sheet.png")).shape == (48 + 4 * 18, 2 * 64, 3)


@pytest.mark.parametrize(("count", "columns"), [(5, 5), (7, 4), (8, 4), (9, 3), (10, 5), (12, 6), (24, 6)])
def test_a_sheet_has_as_few_empty_places_as_possible(count, columns):
    assert usual_columns(count) == columns


LEFT = "robot.sensors.left={kind: camera, yaw_deg: 90, width_px: 80, height_px: 40, field_of_view_deg: 100}"


def test_a_further_camera_is_shown_by_its_name(symolo, tmp_path):
    """Its images are twice as wide as high, and those of data.csv 4 to 3; below each are four lines of text."""
    options = ("--engine", "flat", "-n", 1, "--width-px", 80, "--set", LEFT)
    ended = symolo("preview", "smoke", *options, "--out", tmp_path / "front.png")
    assert ended.out.endswith("not shown: the cameras left; see one of them with --camera NAME\n")
    ended = symolo("preview", "smoke", *options, "--camera", "left", "--out", tmp_path / "left.png")
    assert "not shown" not in ended.out
    front, left = (cv2.imread(str(tmp_path / f"{name}.png")) for name in ("front", "left"))
    assert (front.shape[0] - 60, left.shape[0] - 40) == (4 * LINE_PX, 4 * LINE_PX)
    refused = symolo("preview", "smoke", *options, "--camera", "lft", "--out", tmp_path / "other.png")
    assert refused.code == 2
    assert "--camera: got 'lft', allowed: one of left; did you mean left" in refused.err
    refused = symolo("preview", "smoke", *options[:-2], "--camera", "left", "--out", tmp_path / "other.png")
    assert "the robot has no further camera" in refused.err


def test_looks_that_do_not_fit_on_the_sheet_are_named(symolo, tmp_path):
    options = ("--engine", "flat", "-n", 2, "--width-px", 64, "--look", "lab,night,garage")
    ended = symolo("preview", "smoke", *options, "--out", tmp_path / "sheet.png")
    assert "not shown, because -n is smaller than the number of looks: garage\n" in ended.out
