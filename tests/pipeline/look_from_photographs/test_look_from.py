"""The command `symolo look from`."""

import io
import math
from contextlib import redirect_stdout

import cv2
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.cli import main
from pipeline.look_from_photographs.scenario import shadow_below_deg, view_begins_m
from pipeline.look_from_photographs.views import ViewGeometry
from tests.known_photographs import FLOOR, LINE, photograph

VIEW = ["--line-width-mm", "18", "--pitch-down-deg", "60", "--field-of-view-deg", "50"]


@pytest.fixture(scope="module")
def photos(tmp_path_factory):
    folder = tmp_path_factory.mktemp("photos")
    for k in range(3):
        cv2.imwrite(str(folder / f"{k}.png"), photograph(k, shot=0.012, read=0.004))
    return folder


@pytest.fixture(scope="module")
def base(tmp_path_factory):
    """A look with distributions in the places of numbers, and a lens out of focus."""
    file = tmp_path_factory.mktemp("base") / "base.yaml"
    file.write_text("{extends: classroom, name: base, camera: {defocus_share: 0.004}}")
    return file


@pytest.fixture(scope="module")
def made(photos, base, tmp_path_factory):
    """The folder of a look, and what the command printed."""
    out, printed = tmp_path_factory.mktemp("look") / "my look", io.StringIO()
    files, chosen = sorted(map(str, photos.glob("*.png"))), ["--base", str(base), *VIEW, "--no-render"]
    with redirect_stdout(printed):
        assert main(["look", "from", *files, "--out", str(out), *chosen]) == 0
    return out, printed.getvalue()


@pytest.fixture(scope="module")
def look(made):
    return made[0]


def refused(capsys, *arguments):
    assert main(["look", "from", *map(str, arguments)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    return line


def test_the_look_can_be_used_and_has_the_camera_of_the_photographs(look):
    loaded = load_scenario("smoke", (f"look={look / 'look.yaml'}",))
    drawn = draw_run(loaded, "CW", 1).look
    assert (drawn.name, drawn.floor.material, drawn.line) == ("my_look", "image", "tape")
    assert drawn.camera.lens_blur_px == pytest.approx(1.2, rel=0.1)
    assert drawn.camera.vignetting == pytest.approx(0.3, abs=0.04)
    assert drawn.camera.defocus_share == 0  # a part of lens_blur_px, other than in the base look
    # The photographs have an even floor and no sheets. Their tone curve has a contrast of 1, which nobody knows; with
    # that of the look, the line returns (LINE / FLOOR) ** (1 / contrast) of the light.
    assert drawn.line_sheets.width_m == 0
    floor = drawn.floor.image.white_reflectance * sum(drawn.floor.image.file.mean_rgb) / 3
    assert floor == pytest.approx(0.45, rel=0.03)
    assert drawn.tape.paint.reflectance == pytest.approx(floor * (LINE / FLOOR) ** (1 / drawn.camera.contrast), rel=0.1)


def test_the_scenario_shows_the_line_as_wide_as_the_photographs(look):
    """The line is 36 px wide in images of 160 px: 18 mm are seen at 0.5 mm a pixel."""
    spec = draw_run(load_scenario(str(look / "scenario.yaml")), "CW", 1)
    camera, base_m = spec.robot.camera, spec.robot.chassis.base_height_m
    assert (spec.render.width_px, spec.render.height_px, spec.arena.line.width_m) == (160, 120, 0.018)
    assert camera.pitch_down_deg == 60
    across = math.degrees(2 * math.atan(0.5 * camera.sensor_width_mm / camera.focal_length_mm))
    assert across == pytest.approx(50)
    # 160 px of 0.5 mm, 80 mm, are seen across 50 degrees from the distance d: 40 mm = d tan(25 degrees).
    distance_m = (camera.height_above_base_m + base_m) / math.sin(math.radians(60))
    assert distance_m == pytest.approx(0.040 / math.tan(math.radians(25)), rel=0.04)


def test_every_file_is_named(made):
    look, printed = made
    assert {f.name for f in look.iterdir()} == {"look.yaml", "floor.png", "scenario.yaml", "report.html"}
    assert all(str(f) in printed for f in look.iterdir())


def test_the_shadow_of_the_robot_in_the_image_is_warned_of(made):
    assert (
        "warning: images show the shadow of the robot where a lamp or the sun stands behind it, lower than" in made[1]
    )


def test_the_view_of_a_camera_begins_where_the_lower_border_of_its_image_meets_the_floor():
    """60 degrees down and 30 degrees half a view: straight below. 45 and 15 degrees: 60 degrees down."""
    half_deg = math.degrees(math.atan(math.tan(math.radians(30)) * 4 / 3))
    assert view_begins_m(0.1, ViewGeometry(0.02, 60, 2 * half_deg), (160, 120)) == pytest.approx(0.0, abs=1e-9)
    half_deg = math.degrees(math.atan(math.tan(math.radians(15)) * 4 / 3))
    begins_m = view_begins_m(0.1, ViewGeometry(0.02, 45, 2 * half_deg), (160, 120))
    assert begins_m == pytest.approx(0.1 / math.tan(math.radians(60)))


def test_a_shadow_is_as_long_as_the_height_of_the_body_under_45_degrees():
    """The front of the plate is 90 mm ahead and 50 mm high; the front range sensor is 85 mm ahead and ends at 81 mm."""
    robot = draw_run(load_scenario("smoke"), "CW", 1).robot
    assert shadow_below_deg(robot, 0.085 + 0.081) == pytest.approx(45.0)
    assert shadow_below_deg(robot, 0.09) == pytest.approx(90.0)


def test_the_files_say_what_set_each_value(look, photos):
    text = (look / "look.yaml").read_text()
    assert "lens_blur_px" in text
    assert "# width of the line's edge, 10 to 90 %" in text
    assert f"3 photographs in {photos}: 0.png, 1.png, 2.png" in text
    page = (look / "report.html").read_text()
    assert "width of the line" in page
    assert page.count("data:image/png") == 2


def test_a_dry_run_prints_the_same_look_and_writes_nothing(photos, base, look, tmp_path, capsys):
    out, chosen = tmp_path / "my look", ["--base", str(base), *VIEW, "--dry-run"]
    assert main(["look", "from", *sorted(map(str, photos.glob("*.png"))), "--out", str(out), *chosen]) == 0
    assert (look / "look.yaml").read_text() in capsys.readouterr().out
    assert not out.exists()


def test_a_file_that_is_no_image_is_refused_with_its_name(photos, tmp_path, capsys):
    (tmp_path / "notes.png").write_text("no image")
    line = refused(capsys, photos / "0.png", photos / "1.png", tmp_path / "notes.png", "--out", tmp_path / "out")
    assert "notes.png: is no complete image, or too large" in line
    assert not (tmp_path / "out").exists()


def test_two_photographs_are_too_few(photos, tmp_path, capsys):
    assert "3 to 30" in refused(capsys, photos / "0.png", photos / "1.png", "--out", tmp_path / "out")


def test_the_same_photograph_twice_is_refused(photos, tmp_path, capsys):
    files = [photos / "0.png", photos / "1.png", photos / "0.png"]
    assert "is the same image as" in refused(capsys, *files, "--out", tmp_path / "out")


def test_photographs_without_a_line_are_refused(tmp_path, capsys):
    for k in range(3):
        cv2.imwrite(str(tmp_path / f"{k}.png"), photograph(k, line=FLOOR, shot=0.01))
    line = refused(capsys, *tmp_path.glob("*.png"), "--out", tmp_path / "out")
    assert "a line with floor on both sides is visible in 0 photographs of 3" in line


def test_photographs_of_two_sizes_are_refused(photos, tmp_path, capsys):
    cv2.imwrite(str(tmp_path / "small.png"), photograph(4)[:100])
    line = refused(capsys, photos / "0.png", photos / "1.png", tmp_path / "small.png", "--out", tmp_path / "out")
    assert "160 x 100 px" in line
    assert "160 x 120 px" in line


def test_a_base_with_images_of_its_own_is_refused_before_any_work(photos, tmp_path, capsys):
    cv2.imwrite(str(tmp_path / "wall.png"), photograph(1))
    base = tmp_path / "walls.yaml"
    base.write_text("{extends: lab, name: walls, assets: ., images: {white_board: {file: wall.png}}}")
    line = refused(capsys, *sorted(photos.glob("*.png")), "--out", tmp_path / "out", "--base", base)
    assert "--floor concrete" in line


def test_a_camera_that_would_be_metres_above_the_floor_is_refused_before_rendering(photos, tmp_path, capsys):
    """A line of 100 mm that is 36 px wide in images of 160 px: 222 mm = d tan(5 degrees)."""
    view = ["--line-width-mm", "100", "--field-of-view-deg", "10"]
    line = refused(capsys, *sorted(photos.glob("*.png")), "--out", tmp_path / "out", *view)
    assert "2.5 m above the floor" in line or "2.6 m above the floor" in line


def test_an_unknown_floor_or_base_is_refused(photos, tmp_path, capsys):
    files = sorted(photos.glob("*.png"))
    assert "linoleum" in refused(capsys, *files, "--out", tmp_path / "out", "--floor", "lino")
    assert "--base" in refused(capsys, *files, "--out", tmp_path / "out", "--base", "labb")
