"""A camera fitted to photographs of which blur, vignetting, light and noise are known."""

import numpy as np
import pytest

from configs.schema.appearance.camera_look import CameraLook, ManualExposure
from diagnosis.photographs.camera_fit import CameraTarget, fit_camera
from diagnosis.photographs.line_place import find_lines
from diagnosis.photographs.measures import PhotographMeasures, vignetting
from tests.known_photographs import FLOOR, LINE, coded, photograph

PLAIN = CameraLook(contrast=1.0, saturation=1.0)
"""A camera whose tone curve is that of sRGB, as long as nothing is brighter than 0.6."""


def measured(*images):
    return [PhotographMeasures.from_place("known", place) for place in find_lines(images)]


@pytest.fixture(scope="module")
def grey():
    return [photograph(k, blur_px=1.2, loss=0.3, shot=0.012, read=0.004) for k in range(4)]


@pytest.fixture(scope="module")
def noisy(grey):
    """The same with a slight colour."""
    return measured(*(image - np.array([2, 0, 0], np.uint8) for image in grey))


@pytest.fixture(scope="module")
def fitted(noisy):
    return fit_camera(noisy, PLAIN)


def test_the_light_is_that_of_the_floor(fitted):
    """Most of an image is floor, so that its median light is that of the floor."""
    assert fitted.look.brightness == pytest.approx(FLOOR, rel=0.02)
    assert fitted.line_light[1] / fitted.floor_light[1] == pytest.approx(LINE / FLOOR, rel=0.08)


def test_blur_and_vignetting_are_those_of_the_lens(fitted):
    assert fitted.look.lens_blur_px == pytest.approx(1.2, rel=0.06)
    assert fitted.look.vignetting == pytest.approx(0.3, abs=0.03)
    assert fitted.look.sharpening < 0.2


def test_the_images_have_the_noise_of_the_photographs(noisy, fitted):
    """Of floor and line, both after compression; the sensor of the camera has more noise than its images."""
    target = CameraTarget.from_photographs(noisy)
    assert fitted.measures.floor_noise == pytest.approx(target.floor_noise, rel=0.1)
    assert fitted.measures.line_noise == pytest.approx(target.line_noise, rel=0.1)
    assert np.sqrt(fitted.look.shot_noise**2 * FLOOR + fitted.look.read_noise**2) > 0.012 * np.sqrt(FLOOR)


def test_the_noise_is_right_with_a_camera_that_reduces_noise_and_has_a_colour_filter(noisy):
    camera = PLAIN.model_copy(update={"noise_reduction": 0.025, "colour_filter": "bayer", "colour_blur_px": 1.5})
    assert fit_camera(noisy, camera).measures.floor_noise == pytest.approx(
        CameraTarget.from_photographs(noisy).floor_noise, rel=0.1
    )


def test_photographs_without_colours_are_of_a_monochrome_camera_with_their_noise(noisy, grey, fitted):
    target = measured(*grey)
    monochrome = fit_camera(target, PLAIN)
    assert monochrome.look.colour_filter == "monochrome"
    assert monochrome.measures.floor_noise == pytest.approx(CameraTarget.from_photographs(target).floor_noise, rel=0.1)
    assert fitted.look.colour_filter == fit_camera(noisy, monochrome.look).look.colour_filter == "none"


def test_a_manual_exposure_of_the_base_is_not_in_the_fit(noisy, fitted):
    base = PLAIN.model_copy(update={"manual_exposure": ManualExposure(iso=200.0), "exposure_time_s": 0.01})
    assert fit_camera(noisy, base).look == fitted.look


@pytest.mark.parametrize("loss", [0.0, 0.6])
def test_the_vignetting_is_that_of_the_lens_under_uneven_light(loss):
    """Light that falls by a third from left to right is no vignetting."""
    image = photograph(5, loss=loss)
    linear = (image / 255.0) ** 2.2 * np.exp(np.linspace(0, -0.4, 160))[None, :, None]
    assert vignetting(measured((255 * linear ** (1 / 2.2)).astype(np.uint8)), 1.0) == pytest.approx(loss, abs=0.05)


def test_an_overshoot_is_sharpening():
    soft = photograph(6, blur_px=1.2, loss=0.0, slant=0.0)
    assert measured(soft)[0].overshoot < 0.01
    off = np.abs(np.arange(160) - float(np.median(measured(soft)[0].place.x_px)))
    halo = np.where((off > 20) & (off < 23), 10, 0).astype(np.uint8)
    (sharp,) = measured(soft + halo[None, :, None])
    step = coded(FLOOR) - coded(LINE)
    assert sharp.overshoot == pytest.approx(10 / 255 / step, rel=0.1)
