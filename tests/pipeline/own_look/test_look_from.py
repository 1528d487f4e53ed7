"""The command `symolo look from`."""

import cv2
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.cli import main
from tests.known_photographs import FLOOR, LINE, photograph


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
def look(photos, base, tmp_path_factory):
    out = tmp_path_factory.mktemp("look") / "my look"
    files, chosen = sorted(map(str, photos.glob("*.png"))), ["--base", str(base), "--floor", "linoleum"]
    assert main(["look", "from", *files, "--out", str(out), *chosen, "--no-render"]) == 0
    return out


def refused(capsys, *arguments):
    assert main(["look", "from", *map(str, arguments)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    return line


def test_the_look_can_be_used_and_has_the_camera_of_the_photographs(look):
    loaded = load_scenario("smoke", (f"look={look / 'look.yaml'}",))
    drawn = draw_run(loaded, "CW", 1).look
    assert (drawn.name, drawn.floor.material, drawn.line) == ("my_look", "linoleum", "tape")
    assert drawn.camera.lens_blur_px == pytest.approx(1.2, rel=0.1)
    assert drawn.camera.vignetting == pytest.approx(0.3, abs=0.04)
    assert drawn.camera.defocus_share == 0  # a part of lens_blur_px, other than in the base look
    assert drawn.tape.paint.reflectance / drawn.floor.linoleum.paint.reflectance < 2 * LINE / FLOOR


def test_the_files_say_what_set_each_value(look):
    text = (look / "look.yaml").read_text()
    assert "lens_blur_px" in text
    assert "# width of the line's edge, 10 to 90 %" in text
    assert "3 photographs: 0.png, 1.png, 2.png" in text
    page = (look / "report.html").read_text()
    assert "width of the line" in page
    assert page.count("data:image/png") == 2


def test_a_dry_run_prints_the_same_look_and_writes_nothing(photos, base, look, tmp_path, capsys):
    out, chosen = tmp_path / "my look", ["--base", str(base), "--floor", "linoleum", "--dry-run"]
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


def test_an_unknown_floor_or_base_is_refused(photos, tmp_path, capsys):
    files = sorted(photos.glob("*.png"))
    assert "linoleum" in refused(capsys, *files, "--out", tmp_path / "out", "--floor", "lino")
    assert "--base" in refused(capsys, *files, "--out", tmp_path / "out", "--base", "labb")
