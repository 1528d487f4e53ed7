"""How much pixels of an even patch differ, against its level: shot noise rises with the light, read noise does not.

What texture adds is taken from the simulated images, whose noise is known: their variance in the sensor's light is
that of the texture, which goes with the square of the light, and of the camera. A real floor's texture is not the
simulated one's, so that its strength is fitted along.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import nnls

from diagnosis.camera.case import Ints, Mask
from diagnosis.camera.features.patches import FloorPatches
from diagnosis.camera.features.response import ToneResponse
from diagnosis.camera.parameter import CameraNumber
from sensors.camera.response import CameraResponse
from symolo.core.arrays import Array

NOISE = (
    CameraNumber(
        "shot_noise_scale", "1", 0.15, "noise that grows with the root of the light is stronger", "a smaller sensor"
    ),
    CameraNumber("read_noise_scale", "1", 0.4, "noise in the dark is stronger", "another sensor, or a warm one"),
    CameraNumber("texture_scale", "1", 0.5, "the floor has a stronger grain", "another floor", can_be_named=False),
)

MIN_TEXTURE = 0.2
"""Of the nominal noise: there is no floor without any."""
CUT_OFF = 3.0
"""Standard deviations that a level must be above black."""


@dataclass(frozen=True)
class NoiseModel:
    """Variances; a sample is the logarithm of that of green in one patch, in the sensor's light."""

    patches: FloorPatches
    nominal: CameraResponse
    heldout_frames: Mask
    numbers: tuple[CameraNumber, ...] = NOISE
    min_sd: float = 0.1
    max_independent: float = 8.0

    @property
    def frame(self) -> Ints:
        return self.patches.frame

    @cached_property
    def heldout(self) -> Mask:
        return self.heldout_frames[self.frame]

    @property
    def fit(self) -> Mask:
        return ~self.heldout

    @cached_property
    def _seen(self) -> tuple[Array, Array, Array, Array]:
        """Level and variance (N,) in the sensor's green, measured and simulated."""
        response = ToneResponse.of(self.nominal)
        found: list[Array] = []
        for values, rough in zip(
            (self.patches.measured, self.patches.simulated), self.patches.roughness.T, strict=True
        ):
            level = response.raw(values)[:, 1]
            up, down = values.copy(), values.copy()
            up[:, 1] += 0.005
            down[:, 1] -= 0.005
            slope = (response.raw(up)[:, 1] - response.raw(down)[:, 1]) / 0.01
            found += [level, np.maximum(rough, 1e-8) * slope**2]
        return found[0], found[1], found[2], found[3]

    @cached_property
    def _shares(self) -> tuple[float, float]:
        """Of the texture, on the squared level, and of the camera's noise, on its nominal variance."""
        _, _, level, variance = self._seen
        columns = np.column_stack([level**2, self._noise(level, 1.0, 1.0)])
        weight = 1.0 / np.maximum(variance, np.median(variance))
        texture, camera = nnls(columns * weight[:, None], variance * weight)[0].tolist()
        camera = max(float(camera), 0.05)
        usual = float(np.median(level))
        return max(
            float(texture), MIN_TEXTURE * camera * float(self._noise(np.array([usual]), 1.0, 1.0)[0]) / usual**2
        ), camera

    @cached_property
    def _is_cut_off(self) -> Mask:
        """(N,), where noise would reach below black, which hides part of it."""
        level, variance, its_level, its_variance = self._seen
        return (level < CUT_OFF * np.sqrt(variance)) | (its_level < CUT_OFF * np.sqrt(its_variance))

    def _noise(self, level: Array, shot: float, read: float) -> Array:
        return (shot * self.nominal.shot_noise) ** 2 * level + (read * max(self.nominal.read_noise, 1e-3)) ** 2

    def residuals(self, x: Array) -> Array:
        level, variance, _, _ = self._seen
        shot, read, grain = (float(np.exp(v * n.tolerance)) for v, n in zip(x.tolist(), self.numbers, strict=True))
        texture, camera = self._shares
        left = np.log(variance) - np.log(grain * texture * level**2 + camera * self._noise(level, shot, read))
        return np.where(self._is_cut_off, np.nan, left)

    def frame_slopes(self, x: Array) -> Array:
        return np.zeros((len(self.frame), 0 * len(x)))
