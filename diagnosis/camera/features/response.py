"""Images to the sensor's light and back, by the nominal camera's response and by one that deviates from it."""

from dataclasses import dataclass

import numpy as np

from diagnosis.camera.case import ImagePixels
from sensors.camera.colour import LUMINANCE
from sensors.camera.response import CameraResponse, inverse_tone, tone
from symolo.core.arrays import Array


@dataclass(frozen=True)
class ToneResponse:
    """The response of a camera: from the exposed light of the sensor to the values of the image."""

    contrast: float
    saturation: float
    white_balance: tuple[float, float, float]

    @classmethod
    def nominal(cls, response: CameraResponse) -> "ToneResponse":
        return cls(response.contrast, response.saturation, response.white_balance)

    def raw(self, coded: Array) -> Array:
        """Return the light of the sensor (..., 3) for values (..., 3) from 0 to 1, without regard to sharpening."""
        exposed = inverse_tone(coded, self.contrast)
        if self.saturation > 0:
            grey = (exposed @ LUMINANCE)[..., None]
            exposed = np.maximum(grey + (exposed - grey) / self.saturation, 0.0)
        return exposed / np.array(self.white_balance)

    def coded(self, raw: Array) -> Array:
        """Return values (..., 3) from 0 to 1 for light of the sensor (..., 3)."""
        exposed = np.maximum(raw, 0.0) * np.array(self.white_balance)
        grey = (exposed @ LUMINANCE)[..., None]
        exposed = np.maximum(grey + self.saturation * (exposed - grey), 0.0)
        return np.asarray(tone(exposed.astype(np.float32), self.contrast), np.float64)


def luminance(image: ImagePixels, contrast: float) -> Array:
    """Return the light (H, W) of an image by the tone curve."""
    table = inverse_tone(np.arange(256) / 255.0, contrast)
    return table[image] @ LUMINANCE
