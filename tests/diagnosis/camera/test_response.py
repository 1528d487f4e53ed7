"""The response undone, against the one that makes the images."""

import numpy as np
import pytest

from sensors.camera.response import inverse_tone, tone


@pytest.mark.parametrize("contrast", [0.7, 1.0, 1.4])
def test_the_tone_curve_is_undone(contrast):
    light = np.linspace(0.0, 1.0, 60)
    assert inverse_tone(tone(light, contrast), contrast) == pytest.approx(
        light, abs=1e-6
    )  # the curve is worked out in single precision


def test_a_middle_grey_of_srgb_is_undone_to_its_light():
    assert inverse_tone(np.array([119 / 255]), 1.0)[0] == pytest.approx(0.1845, abs=1e-4)  # IEC 61966-2-1
