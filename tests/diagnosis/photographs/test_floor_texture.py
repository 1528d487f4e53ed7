"""The texture of a floor and the sheets along a line, of which everything is known."""

import cv2
import numpy as np
import pytest

from configs.schema.appearance.camera_look import CameraLook
from diagnosis.photographs.floor_measures import FloorMeasures
from diagnosis.photographs.floor_texture import FloorLight, FloorTexture, on_the_floor
from diagnosis.photographs.line_place import find_lines
from diagnosis.photographs.measures import PhotographMeasures, shading_ev
from tests.known_photographs import photograph

CAMERA = CameraLook(contrast=1, vignetting=0, lens_blur_px=1.2)
SPREAD, SCALE_PX, BLUR_PX = 0.1, 8.0, 1.5


def spots(number, blur_px):
    """Noise that is blurred twice with OpenCV: by the floor, to a known spread, and then by the lens."""
    white = np.random.Generator(np.random.PCG64(number)).standard_normal((240, 320))
    floor = cv2.GaussianBlur(white, (0, 0), SCALE_PX)
    lens = cv2.GaussianBlur(floor * SPREAD / floor.std(), (0, 0), blur_px)[60:180, 80:240]
    return lens - np.median(lens)


def test_a_texture_has_the_spread_that_it_had_before_the_lens_blurred_it():
    mask = np.ones((120, 160), bool)
    mask[:, 60:100] = False  # the line
    floors = [FloorLight(np.where(mask, spots(k, BLUR_PX), 9.9), mask) for k in range(6)]
    texture = FloorTexture.from_floors(floors, BLUR_PX)
    assert texture.spread == pytest.approx(SPREAD, rel=0.15)
    coarse = [s**2 for scale, s in zip(texture.scales_px, texture.spreads, strict=True) if 4 <= scale <= 16]
    assert sum(coarse) > 0.85 * texture.spread**2


def test_a_tile_has_the_spread_of_its_texture_and_no_seam():
    tile = FloorTexture((2.0, 8.0), (0.06, 0.08)).tile(256, 1.5, seed=3)
    assert tile.mean() == pytest.approx(1)
    assert np.log(tile).std() == pytest.approx(1.5 * 0.1, rel=0.1)  # 0.06^2 + 0.08^2 = 0.1^2
    steps = np.abs(np.diff(tile, axis=1))
    assert np.abs(tile[:, 0] - tile[:, -1]).mean() < 1.3 * steps.mean()


def test_a_slanted_view_of_stripes_becomes_even_on_the_floor():
    """Stripes across the view of a camera at height 1, pitched down by 50 degrees, are 0.2 wide on the floor."""
    focal_px, pitch = 80 / np.tan(np.radians(25)), np.radians(50)
    v = np.arange(120)[:, None] - 59.5
    below_horizon = pitch + np.arctan(v / focal_px)
    ahead = 1 / np.tan(below_horizon)
    image = np.repeat(((ahead / 0.2) % 2 < 1).astype(float), 160, axis=1)
    column = on_the_floor(image, 50, 50)[:, 80]
    edges = np.flatnonzero(np.abs(np.diff((column > 0.5).astype(int))))
    widths = np.diff(edges)
    # One pixel is 1 / focal length at the distance of the middle of the image, 1 / sin(pitch).
    assert widths == pytest.approx(0.2 * focal_px * np.sin(pitch), abs=1.6)


def measured(images):
    return tuple(PhotographMeasures.from_place("known", place) for place in find_lines(images))


def with_sheets(number, ratio):
    """A line of 30 px on sheets of 75 px in linear light, whose shadow-free floor is as light elsewhere."""
    image = photograph(number, slant=0.0, width_px=30.0, loss=0.0)
    grey = image[..., 0].astype(float)
    middle = np.flatnonzero(grey[60] < 100).mean()
    beyond = np.abs(np.arange(160) - middle) > 37.5
    # Grey values follow light to the power of about 1 / 2.2.
    grey[:, beyond] *= ratio ** (-1 / 2.2)
    return np.repeat(np.rint(grey)[..., None], 3, axis=2).astype(np.uint8)


@pytest.mark.parametrize("ratio", [1.2, 0.8])
def test_sheets_along_the_line_have_their_width_and_their_light(ratio):
    seen = FloorMeasures.from_photographs(measured([with_sheets(k, ratio) for k in range(2)]), CAMERA, 90, 60)
    assert seen.sheets is not None
    assert seen.sheets.width == pytest.approx(75 / 29, abs=0.1)  # the mask of the line has 29 px
    assert seen.sheets.ratio == pytest.approx(ratio, rel=0.04)


def test_an_even_floor_has_no_sheets_and_no_texture():
    seen = FloorMeasures.from_photographs(
        measured([photograph(k, shot=0.01, read=0.004) for k in range(2)]),
        CAMERA.model_copy(update={"vignetting": 0.3}),
        90,
        60,
    )
    assert seen.sheets is None
    assert seen.beside == pytest.approx(1, abs=0.01)
    assert seen.texture.spread < 0.01


def test_light_that_rises_to_the_right_is_shading_whichever_way_the_line_runs():
    """Grey values that rise by 2^(1 / 2.2) from border to border are about one stop."""
    slope = 2.0 ** ((np.arange(160) / 160 - 0.5) / 2.2)[None, :, None]
    upright = np.rint(photograph(1, loss=0.0, floor=0.3) * slope).astype(np.uint8)
    level = np.rint(photograph(1, loss=0.0, floor=0.3).transpose(1, 0, 2)[:, :, :] * slope[:, :120]).astype(np.uint8)
    for image, expected in ((upright, 1.0), (level, 0.75)):
        (one,) = measured([image])
        right, down = shading_ev(one, 1.0, 0.0)
        assert right == pytest.approx(expected, abs=0.12)
        assert down == pytest.approx(0, abs=0.05)
