"""Brightness and colour of floor and line, compared with the simulated images of the same places.

The nominal response (`sensors.camera.response`) is inverted on the simulated values, which gives the light of the
scene, and a response with deviations is applied to that light. The exposure of each image may differ a little, because
an automatic exposure depends on what the camera sees.

The light is smoothed over each image, floor and line separately: noise in a regressor makes slopes too small (Fuller,
Measurement Error Models, 1987, section 1.1), above all the slopes of the colours, which hardly differ over a floor. The
texture that this removes is subtracted from the measured values as well.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from diagnosis.camera.case import Ints
from diagnosis.camera.features.patches import FloorPatches
from diagnosis.camera.features.response import ToneResponse
from diagnosis.camera.model import CameraModel, CameraParameter
from sensors.camera.response import CameraResponse, corner_share
from symolo.core.arrays import Array

EXPOSURE_SD = 0.02
"""Standard deviation of the exposure from image to image, relative."""
MIN_PATCHES_FOR_SQUARES = 20
"""Patches of floor or line in an image from which a slope and a curvature of their light are fitted."""


@dataclass(frozen=True)
class LevelModel(CameraModel):
    """Levels; a sample is the mean of one channel of one patch, from 0 to 1."""

    name = "levels"
    unit = "of white"
    min_sd = 0.002
    max_independent = 8.0
    parameters = (
        CameraParameter(
            "exposure_scale",
            "1",
            0.03,
            "the images receive this many times the light",
            "exposure time, gain, iris, or light",
        ),
        CameraParameter(
            "red_gain_scale", "1", 0.02, "red is amplified more, relative to green", "white balance, or light"
        ),
        CameraParameter(
            "blue_gain_scale", "1", 0.02, "blue is amplified more, relative to green", "white balance, or light"
        ),
        CameraParameter("vignetting", "1", 0.03, "the corners lose more of the light", "another lens or iris"),
        CameraParameter(
            "veiling_glare", "1", 0.004, "more light is spread evenly over the image", "a dirty or a cheap lens"
        ),
        CameraParameter("contrast_scale", "1", 0.05, "the tone curve is steeper", "another picture style"),
        CameraParameter("saturation_scale", "1", 0.03, "colours are stronger", "another picture style"),
        CameraParameter(
            "line_reflectance_scale", "1", 0.25, "the line is paler", "another or a worn tape", can_be_named=False
        ),
    )

    patches: FloorPatches
    nominal: CameraResponse
    size_px: tuple[int, int]

    @property
    def frame(self) -> Ints:
        return np.repeat(self.patches.frame, 3)

    @cached_property
    def light(self) -> Array:
        """Return the light of the scene, exposed as in the simulated images and smoothed, (N, 3)."""
        patches = self.patches
        raw = ToneResponse.nominal(self.nominal).raw(patches.simulated)
        light = raw / self._vignetted(patches.nominal_at, self.nominal.vignetting)[:, None]
        smooth = np.empty_like(raw)
        for frame in np.unique(patches.frame):
            for on_line in (False, True):
                here = (patches.frame == frame) & (patches.on_line == on_line)
                if here.any():
                    smooth[here] = _smoothed(light[here], patches.nominal_at[here] / self.size_px[0])
        return smooth

    @cached_property
    def mean_light(self) -> Array:
        """Return the mean light of each image, approximated by its patches of floor, (frames, 3)."""
        floor = ~self.patches.on_line
        means = []
        for frame in range(len(self.heldout_frames)):
            here = floor & (self.patches.frame == frame)
            means.append(self.light[here if here.any() else floor].mean(axis=0))
        return np.array(means)

    def predicted(self, x: Array, log_exposure: float = 0.0) -> Array:
        """Return the predicted values (N, 3) with every image exposed exp(`log_exposure`) times as long."""
        d = {p.name: value * p.tolerance for p, value in zip(self.parameters, x, strict=True)}
        nominal = self.nominal
        exposure = np.exp(d["exposure_scale"] + log_exposure)
        reflectance = np.where(self.patches.on_line, np.exp(d["line_reflectance_scale"]), 1.0)[:, None]
        light = self.light * reflectance * exposure
        veil = self.mean_light[self.patches.frame] * exposure
        light = light + d["veiling_glare"] * (veil - light)
        raw = light * self._vignetted(self.patches.at, nominal.vignetting + d["vignetting"])[:, None]
        red, green, blue = nominal.white_balance
        balance = (red * np.exp(d["red_gain_scale"]), green, blue * np.exp(d["blue_gain_scale"]))
        contrast = nominal.contrast * float(np.exp(d["contrast_scale"]))
        saturation = nominal.saturation * float(np.exp(d["saturation_scale"]))
        return ToneResponse(contrast, saturation, balance).coded(raw)

    def residuals(self, x: Array) -> Array:
        return (self._untextured - self.predicted(x)).ravel()

    def frame_slopes(self, x: Array) -> Array:
        step = self.predicted(x, 0.5 * EXPOSURE_SD) - self.predicted(x, -0.5 * EXPOSURE_SD)
        return step.reshape(-1, 1)

    def thinned(self, floor_patches: int) -> "LevelModel":
        """Return the model with every nth patch of floor, so that about `floor_patches` of them remain."""
        on_line = self.patches.on_line
        floor = np.flatnonzero(~on_line)[:: max(1, np.count_nonzero(~on_line) // floor_patches)]
        return replace(self, patches=self.patches.some(np.sort(np.concatenate([floor, np.flatnonzero(on_line)]))))

    @cached_property
    def _untextured(self) -> Array:
        """Return the measured values without the texture of the simulated patches, (N, 3)."""
        patches = self.patches
        raw = self.light * self._vignetted(patches.nominal_at, self.nominal.vignetting)[:, None]
        return patches.measured - (patches.simulated - ToneResponse.nominal(self.nominal).coded(raw))

    def _vignetted(self, at: Array, vignetting: float) -> Array:
        """Return the share of the light that reaches pixels (N, 2), (N,)."""
        return 1.0 - vignetting * corner_share(at[:, 0], at[:, 1], *self.size_px)


def _smoothed(light: Array, at: Array) -> Array:
    """Return light (n, 3) at places (n, 2) smoothed by a polynomial whose degree fits the number of patches."""
    x, y = (at - at.mean(axis=0)).T
    columns = [np.ones(len(x)), x, y, x * x, x * y, y * y]
    terms = np.stack(columns[: 6 if len(x) >= MIN_PATCHES_FOR_SQUARES else 1], axis=1)
    return terms @ np.linalg.lstsq(terms, light, rcond=None)[0]
