"""The file of a fitted look."""

import numpy as np
import pytest

from configs.schema.appearance.camera_look import CameraLook
from diagnosis.photographs.camera_fit import CameraTarget, FittedCamera
from diagnosis.photographs.fitted_look import FittedLook, paint_of
from diagnosis.photographs.line_place import find_lines
from diagnosis.photographs.measures import PhotographMeasures
from sensors.camera.colour import paint_rgb
from tests.known_photographs import photograph


def test_exposures_vary_as_in_the_photographs_whatever_the_rendered_images_made_of_the_brightness():
    """Floors of 0.35, 0.42 and 0.5 in one light are exposures of log2(0.35 / 0.42) to log2(0.5 / 0.42) stops."""
    images = [photograph(k, floor=floor, line=floor / 7) for k, floor in enumerate((0.35, 0.42, 0.5))]
    measured = tuple(PhotographMeasures.from_place("known", place) for place in find_lines(images))
    corrected = CameraLook(contrast=1.0, brightness=0.2, vignetting=0.1)
    camera = FittedCamera(corrected, np.full(3, 0.42), np.full(3, 0.06), CameraTarget.from_photographs(measured))
    look = FittedLook("known", "lab", measured, camera, "concrete", 0.45, reflectance_is_assumed=True)
    stops = next(setting.value for setting in look.settings if setting.path == ("camera", "compensation_ev"))
    assert stops["uniform"] == pytest.approx([np.log2(0.35 / 0.42), np.log2(0.5 / 0.42)], abs=0.03)


@pytest.mark.parametrize("saturation", [1.0, 0.6])
def test_a_paint_has_the_colour_of_its_light_after_the_saturation_of_the_camera(saturation):
    """The camera moves each component towards the luminance of the colour: grey + saturation (component - grey)."""
    light = np.array([0.42, 0.40, 0.37])
    rgb = np.array(paint_rgb(paint_of(light, 0.5, saturation)))
    luminance = np.array([0.2126, 0.7152, 0.0722])  # ITU-R BT.709
    grey = rgb @ luminance
    assert grey == pytest.approx(0.5, rel=1e-3)
    seen = grey + saturation * (rgb - grey)
    assert seen / grey == pytest.approx(light / (light @ luminance), rel=2e-3)


@pytest.mark.parametrize(
    ("lights", "losses", "doubt"),
    [
        ((0.06, 0.07, 0.06), (0.3, 0.3, 0.3), ""),
        ((0.03, 0.04, 0.09), (0.3, 0.3, 0.3), "the line has from 0.0"),
        ((0.06, 0.07, 0.06), (0.0, 0.3, 0.5), "the vignetting of single photographs is from 0.0"),
    ],
)
def test_photographs_of_different_lines_or_light_are_doubted(lights, losses, doubt):
    images = [photograph(k, line=line, loss=loss) for k, (line, loss) in enumerate(zip(lights, losses, strict=True))]
    measured = tuple(PhotographMeasures.from_place("known", place) for place in find_lines(images))
    camera = FittedCamera(
        CameraLook(contrast=1.0), np.full(3, 0.42), np.full(3, 0.06), CameraTarget.from_photographs(measured)
    )
    look = FittedLook("known", "lab", measured, camera, "concrete", 0.45, reflectance_is_assumed=True)
    assert len(look.doubts) == bool(doubt)
    assert doubt in "".join(look.doubts)
