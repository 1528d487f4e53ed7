"""The file of a fitted look."""

import numpy as np
import pytest

from diagnosis.photographs.fitted_look import paint_of
from sensors.camera.colour import paint_rgb


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
