"""Scatter of the pixels of an even patch by its level: shot noise rises with the light, read noise does not.

A part of the scatter is texture. It is taken from the simulated images, whose noise is known: their variance, in the
light of the sensor, is that of the texture, in proportion to the square of the light, and that of the camera. The
texture of a real floor differs from the simulated one, so its strength is fitted along.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import nnls

from diagnosis.camera.case import Ints
from diagnosis.camera.features.patches import FloorPatches
from diagnosis.camera.features.response import ToneResponse
from diagnosis.camera.model import CameraModel, CameraParameter
from diagnosis.measured.channel import Mask
from sensors.camera.response import CameraResponse
from symolo.core.arrays import Array

MIN_TEXTURE = 0.2
"""Smallest variance of the texture, as a share of the variance of the nominal noise: no floor is quite even."""
MIN_CAMERA = 0.05
"""Smallest variance of the camera's noise in the simulated images, as a share of the nominal one."""
CUT_OFF = 3.0
"""Standard deviations that a level must be above black."""


@dataclass(frozen=True)
class NoiseModel(CameraModel):
    """Variances; a sample is the logarithm of the variance of green in one patch, in the light of the sensor."""

    name = "noise"
    unit = "of the log variance"
    min_sd = 0.1
    max_independent = 8.0
    parameters = (
        CameraParameter(
            "shot_noise_scale",
            "1",
            0.15,
            "the noise that grows with the root of the light is stronger",
            "a smaller sensor",
        ),
        CameraParameter(
            "read_noise_scale", "1", 0.4, "the noise in the dark is stronger", "another or a warmer sensor"
        ),
        CameraParameter(
            "texture_scale", "1", 0.5, "the floor has a stronger grain", "another floor", can_be_named=False
        ),
    )

    patches: FloorPatches
    nominal: CameraResponse

    @property
    def frame(self) -> Ints:
        return self.patches.frame

    def residuals(self, x: Array) -> Array:
        (level, variance), _ = self._light
        shot, read, grain = (float(np.exp(v * p.tolerance)) for v, p in zip(x.tolist(), self.parameters, strict=True))
        texture, camera = self._shares
        residuals = np.log(variance) - np.log(grain * texture * level**2 + camera * self._noise(level, shot, read))
        return np.where(self._is_cut_off, np.nan, residuals)

    def frame_slopes(self, x: Array) -> Array:
        return np.zeros((len(self.frame), 0 * len(x)))

    @cached_property
    def _light(self) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Return level and variance (N,) in the sensor's green, of the measured and of the simulated patches."""
        response, patches = ToneResponse.nominal(self.nominal), self.patches
        pairs: list[tuple[Array, Array]] = []
        for values, roughness in zip((patches.measured, patches.simulated), patches.roughness.T, strict=True):
            up, down = values.copy(), values.copy()
            up[:, 1] += 0.005
            down[:, 1] -= 0.005
            slope = (response.raw(up)[:, 1] - response.raw(down)[:, 1]) / 0.01
            pairs.append((response.raw(values)[:, 1], np.maximum(roughness, 1e-8) * slope**2))
        return pairs[0], pairs[1]

    @cached_property
    def _shares(self) -> tuple[float, float]:
        """Return the factors of the squared level, for texture, and of the nominal noise, in the simulated patches."""
        _, (level, variance) = self._light
        columns = np.column_stack([level**2, self._noise(level, 1.0, 1.0)])
        weight = 1.0 / np.maximum(variance, np.median(variance))
        texture, camera = nnls(columns * weight[:, None], variance * weight)[0].tolist()
        camera = max(float(camera), MIN_CAMERA)
        usual = float(np.median(level))
        usual_noise = float(self._noise(np.array([usual]), 1.0, 1.0)[0])
        return max(float(texture), MIN_TEXTURE * camera * usual_noise / usual**2), camera

    @cached_property
    def _is_cut_off(self) -> Mask:
        """Return the patches (N,) whose noise would reach below black, where values are cut off and scatter less."""
        is_dark = [level < CUT_OFF * np.sqrt(variance) for level, variance in self._light]
        return is_dark[0] | is_dark[1]

    def _noise(self, level: Array, shot: float, read: float) -> Array:
        """Return the variance of the nominal camera with factors on its shot noise and its read noise."""
        return (shot * self.nominal.shot_noise) ** 2 * level + (read * max(self.nominal.read_noise, 1e-3)) ** 2
