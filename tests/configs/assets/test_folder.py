"""Files that a look names: where they are looked for, how they are known, and how the bad ones are refused."""

import hashlib
import json
import os
from pathlib import Path

import cv2
import numpy as np
import pytest
from pydantic import ValidationError

import configs
from configs.draw import draw_all, draw_look
from configs.loader import load_scenario, load_section
from configs.schema.appearance.look import LookConfig
from configs.schema.scenario import RunSpec
from symolo.core.errors import InputError

GREY = cv2.imencode(".png", np.full((2, 3, 3), 188, np.uint8))[1].tobytes()
WHITE = cv2.imencode(".png", np.full((4, 4, 3), 255, np.uint8))[1].tobytes()
HALL = cv2.imencode(".hdr", np.full((4, 8, 3), 0.5, np.float32))[1].tobytes()

LOOK = """\
extends: classroom
name: mine
assets: photos
floor:
  material: image
  image: {file: grey.png, width_m: {uniform: [1, 2]}}
sky: {panorama: sub/hall.hdr}
"""


@pytest.fixture
def photos(here: Path) -> Path:
    """A folder beside a look that names it, both in a folder beside the scenario."""
    folder = here / "looks/photos"
    (folder / "sub").mkdir(parents=True)
    (folder / "grey.png").write_bytes(GREY)
    (folder / "white.png").write_bytes(WHITE)
    (folder / "sub/hall.hdr").write_bytes(HALL)
    (here / "looks/mine.yaml").write_text(LOOK)
    (here / "own.yaml").write_text("extends: trial.yaml\nlook: looks/mine.yaml\n")
    return folder


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


@pytest.mark.usefixtures("photos")
def test_a_file_is_known_by_name_and_content_in_the_run_and_by_name_among_what_was_drawn(here: Path):
    choice = "look.floor.image.file={choice: [grey.png, white.png]}"
    specs = draw_all(load_scenario("own.yaml", [choice, "routes.CW.runs=8"]))
    taken = {spec.drawn["look.floor.image.file"]: spec.look.floor.image.file for spec in specs}
    assert {name: asset.sha256 for name, asset in taken.items()} == {
        "grey.png": _sha256(GREY),
        "white.png": _sha256(WHITE),
    }
    grey, white = taken["grey.png"], taken["white.png"]
    assert (grey.name, grey.width_px, grey.height_px) == ("grey.png", 3, 2)
    assert grey.mean_rgb == pytest.approx((0.502886,) * 3)  # sRGB's 188 (IEC 61966-2-1)
    assert white.mean_rgb == (1, 1, 1)
    for spec in specs:
        assert spec.look.sky.panorama.sha256 == _sha256(HALL)
        assert spec.look.sky.panorama.mean_rgb == pytest.approx((0.5,) * 3)
        assert RunSpec.model_validate_json(spec.model_dump_json()) == spec
        assert str(here) not in spec.model_dump_json()


@pytest.mark.usefixtures("photos")
def test_what_a_dataset_states_of_the_scenario_holds_the_files_and_no_place(here: Path):
    loaded = load_scenario("own.yaml")
    sha256_of = {asset["name"]: asset["sha256"] for asset in loaded.tree["look"]["assets"]}
    assert sha256_of == {"grey.png": _sha256(GREY), "sub/hall.hdr": _sha256(HALL)}
    assert str(here) not in json.dumps(loaded.tree)
    assert {place.name for place in loaded.assets.values()} == {"grey.png", "hall.hdr"}


def test_another_content_under_the_same_name_is_another_run(photos: Path):
    before = draw_all(load_scenario("own.yaml"))[0]
    (photos / "grey.png").write_bytes(WHITE)
    after = draw_all(load_scenario("own.yaml"))[0]
    assert before.drawn == after.drawn
    assert before.look.floor.image.file.sha256 != after.look.floor.image.file.sha256


@pytest.mark.usefixtures("photos")
def test_a_folder_is_distinguished_from_the_file_that_names_it_however_it_is_reached(here: Path, monkeypatch):
    (here / "top.yaml").write_text("extends: own.yaml\nlook: {floor: {image: {file: white.png}}}\n")
    expected = _sha256(WHITE)
    for name in ("top.yaml", str(here / "top.yaml")):
        assert expected in load_scenario(name).assets
    monkeypatch.chdir(here / "looks")
    assert expected in load_scenario("../top.yaml").assets
    assert expected in load_section("look", "mine.yaml", ["look.floor.image.file=white.png"]).assets
    monkeypatch.chdir(here / "looks/photos")
    assert expected in load_scenario("../../top.yaml", ["look.assets=."]).assets


def test_a_folder_on_the_command_line_is_relative_to_the_working_directory(photos: Path, monkeypatch):
    monkeypatch.chdir(photos.parent)
    settings = ["look.assets=photos", "look.floor.material=image", "look.floor.image.file=grey.png"]
    look, _ = draw_look(load_section("look", "classroom", settings), 1, "CW", 1)
    assert look.floor.image.file.sha256 == _sha256(GREY)
    assert [asset.name for asset in look.files] == ["grey.png"]


@pytest.mark.usefixtures("photos")
def test_a_look_that_names_no_file_needs_no_folder_and_a_folder_no_file():
    assert load_scenario("trial.yaml").assets == {}
    settings = ["look.assets=looks", "look.sky.panorama=city", "look.floor={material: concrete, image: {file: null}}"]
    loaded = load_scenario("own.yaml", settings)
    assert loaded.assets == {}
    assert "assets" not in loaded.tree["look"]


REFUSED = {
    "missing": (
        "look.floor.image.file=gray.png",
        "no such file in looks/photos: got 'gray.png'; did you mean grey.png",
    ),
    "misspelt sky": ("look.sky.panorama=couryard", "no such file in looks/photos", "did you mean courtyard"),
    "upwards": ("look.floor.image.file=../mine.yaml", "leads out of the folder"),
    "upwards later": ("look.floor.image.file=sub/../../mine.yaml", "leads out of the folder"),
    "absolute": ("look.floor.image.file=/dev/zero", "leads out of the folder"),
    "the folder": ("look.floor.image.file=.", "is no name of a file"),
    "folder inside": ("look.floor.image.file=sub", "is no file"),
    "nothing": ("look.floor.image.file=''", "is no name of a file"),
    "zero byte": ('look.floor.image.file="a\\0.png"', "is no name of a file"),
    "long": (f"look.floor.image.file={'x' * 300}", "is no name of a file"),
    "link outwards": ("look.floor.image.file=outside.png", "is a link that leads out of the folder"),
    "link to nothing": ("look.floor.image.file=broken.png", "no such file"),
    "link to itself": ("look.floor.image.file=loop.png", "no such file"),
    "pipe": ("look.floor.image.file=pipe", "is no file"),
    "empty": ("look.floor.image.file=empty.png", "is neither a PNG nor a JPEG image", "save it again"),
    "cut short": ("look.floor.image.file=cut.png", "is cut short: the PNG has no end"),
    "sky as image": ("look.floor.image.file=sub/hall.hdr", "is neither a PNG nor a JPEG image"),
    "image as sky": ("look.sky.panorama=grey.png", "is neither a Radiance (.hdr) nor an OpenEXR file"),
    "one of a choice": ("look.sky.panorama={choice: [city, sub/hall.hdr, lost.hdr]}", "no such file", "got 'lost.hdr'"),
    "number": ("look.floor.image.file=7", "look.floor.image.file: got 7, allowed: the name of a file"),
    "list": ("look.floor.image.file=[grey.png]", "look.floor.image.file"),
    "range": ("look.floor.image.file={uniform: [1, 2]}", "only {choice: [...]} may draw it"),
    "none for an image": ("look.floor.image.file=null", "missing, because the floor is an image"),
    "no such folder": ("look.assets=nowhere", "look.assets: no such folder: got 'nowhere'"),
    "a file for a folder": ("look.assets=trial.yaml", "look.assets: no such folder: got 'trial.yaml'"),
    "no folder": (
        "look.assets=null",
        "got 'grey.png', allowed: a file in the folder that look.assets names",
        "assets:",
    ),
    "a number for a folder": ("look.assets=3", "look.assets: got 3, allowed: the path of a folder"),
    "a mapping for a folder": ("look.assets={a: b}", "look.assets"),
    "drawn folder": ("look.assets={choice: [photos, sub]}", "look.assets"),
}


@pytest.mark.parametrize("case", REFUSED.values(), ids=REFUSED.keys())
def test_a_file_that_cannot_be_used_is_refused_in_one_line_at_its_field(photos: Path, case: tuple[str, ...]):
    (photos.parent / "outside.png").write_bytes(GREY)
    (photos / "outside.png").symlink_to(photos.parent / "outside.png")
    (photos / "broken.png").symlink_to(photos / "nothing.png")
    (photos / "loop.png").symlink_to(photos / "loop.png")
    os.mkfifo(photos / "pipe")
    (photos / "empty.png").write_bytes(b"")
    (photos / "cut.png").write_bytes(GREY[:-20])
    setting, *parts = case
    with pytest.raises(InputError) as caught:
        load_section("look", "looks/mine.yaml", [setting])
    text = str(caught.value)
    field = setting.partition("=")[0]
    assert text.startswith(f"--set {field}: " if setting != "look.assets=null" else "looks/mine.yaml:6: look.floor")
    assert text.count(field) == 1
    assert all(part in text for part in parts), text
    assert len(text.splitlines()) == 1


def test_a_link_inside_the_folder_and_a_folder_that_is_a_link_are_followed(photos: Path):
    (photos / "again.png").symlink_to("grey.png")
    (photos.parent / "linked").symlink_to(photos)
    loaded = load_section("look", "looks/mine.yaml", ["look.floor.image.file=again.png", "look.assets=looks/linked"])
    assert _sha256(GREY) in loaded.assets


def test_a_file_that_is_too_large_is_not_read(photos: Path, monkeypatch):
    monkeypatch.setattr("configs.assets.images.MAX_BYTES", 1 << 20)
    with (photos / "grey.png").open("r+b") as file:
        file.truncate((1 << 20) + 1)
    with pytest.raises(InputError, match=r"looks/mine\.yaml:6: look\.floor\.image\.file: is larger than 1 MiB"):
        load_section("look", "looks/mine.yaml")


def test_the_look_of_the_documents_is_one(here: Path):
    text = (Path(configs.__file__).parents[1] / "docs/looks.md").read_text()
    lines = text.partition("    # my_look.yaml")[2].partition("\n")[2].split("\n\n")[0]
    (here / "my_look.yaml").write_text("\n".join(line.removeprefix("    ") for line in lines.splitlines()))
    (here / "my_photos/hall").mkdir(parents=True)
    for name, data in {"parquet.jpg": GREY, "hall/tiles.png": WHITE, "graffiti.png": GREY, "my_hall.hdr": HALL}.items():
        (here / "my_photos" / name).write_bytes(data)
    section = load_section("look", "my_look.yaml")
    taken = [draw_look(section, 1, "CW", run)[0] for run in range(1, 9)]
    assert {look.floor.image.file.name for look in taken} == {"parquet.jpg", "hall/tiles.png"}
    assert {look.images.white_board.file.name for look in taken} == {"graffiti.png"}


@pytest.mark.parametrize("assets", ["photos", 3, [3], [{}], [{"name": 3}], {"name": "a.png"}, [{"name": "a.png"}]])
def test_a_specification_that_somebody_else_wrote_is_refused_and_no_crash(assets: object):
    text = json.dumps({"name": "own", "assets": assets, "floor": {"image": {"file": "a.png"}}})
    with pytest.raises(ValidationError):
        LookConfig.model_validate_json(text)


@pytest.mark.usefixtures("photos")
def test_a_file_that_does_not_fit_into_memory_is_refused(monkeypatch):
    def full(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr("configs.assets.images.whole_image", full)
    with pytest.raises(InputError, match=r"does not fit into the memory that is free: got .*; save it smaller"):
        load_section("look", "looks/mine.yaml")


def test_a_strip_keeps_its_shape(photos: Path, monkeypatch):
    """Averaged down to 10 pixels at most, 100 x 3 becomes 10 x 1: ten times as wide as high, and no longer 33 times."""
    monkeypatch.setattr("configs.assets.images.MAX_SIDE_PX", 10)
    (photos / "grey.png").write_bytes(cv2.imencode(".png", np.full((3, 100, 3), 188, np.uint8))[1].tobytes())
    look, _ = draw_look(load_section("look", "looks/mine.yaml"), 1, "CW", 1)
    own = look.floor.image.file
    assert (own.width_px, own.height_px) == (100, 3)
    assert own.mean_rgb == pytest.approx((0.502886,) * 3)  # sRGB's 188 (IEC 61966-2-1)


def test_an_image_called_like_a_shipped_sky_is_no_sky(photos: Path):
    (photos / "city").write_bytes(GREY)
    settings = ["look.floor.image.file=city", "look.sky.panorama=city"]
    look, _ = draw_look(load_section("look", "looks/mine.yaml", settings), 1, "CW", 1)
    assert look.floor.image.file.sha256 == _sha256(GREY)
    assert look.sky.panorama == "city"
