"""How bright and of which colour floor and line are, against the simulated images of the same places.

The simulated values are undone to the sensor's light by the nominal response (`sensors.camera.response`), and
done again with one that deviates. Each image's exposure may differ a little by itself, for automatic exposure meters
what the camera sees.

What is predicted from is smooth over each image, floor and line apart: noise in it would make slopes too small
(Fuller, Measurement Error Models, 1987, section 1.1), above all that of the colours, which hardly differ over a floor.
The texture that is smoothed away is taken from the measured values in its place.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from diagnosis.camera.case import Ints, Mask
from diagnosis.camera.features.patches import FloorPatches
from diagnosis.camera.features.response import ToneResponse
from diagnosis.camera.parameter import CameraNumber
from sensors.camera.response import CameraResponse, corner_share
from symolo.core.arrays import Array

LEVELS = (
    CameraNumber(
        "exposure_scale", "1", 0.03, "so many times the light is taken", "another exposure time, gain, iris, or light"
    ),
    CameraNumber("red_gain_scale", "1", 0.02, "red is amplified more, beside green", "another white balance, or light"),
    CameraNumber(
        "blue_gain_scale", "1", 0.02, "blue is amplified more, beside green", "another white balance, or light"
    ),
    CameraNumber("vignetting", "1", 0.03, "more of the light is lost in the corners", "another lens or iris"),
    CameraNumber("veiling_glare", "1", 0.004, "more light is spread evenly over the image", "a dirty or a cheap lens"),
    CameraNumber("contrast_scale", "1", 0.05, "the tone curve is steeper", "another picture style"),
    CameraNumber("saturation_scale", "1", 0.03, "colours are stronger", "another picture style"),
    CameraNumber(
        "line_reflectance_scale", "1", 0.25, "the line is paler", "another or a worn tape", can_be_named=False
    ),
)
OWN_EXPOSURE = 0.02
"""Standard deviation of the exposure from image to image, relative."""
FOR_SQUARES = 20
"""Patches of floor or line in an image from which a slope and a curvature of their light are fitted."""


@dataclass(frozen=True)
class LevelModel:
    """Levels; a sample is the mean of one channel of one patch, from 0 to 1."""

    patches: FloorPatches
    nominal: CameraResponse
    heldout_frames: Mask
    size_px: tuple[int, int]
    numbers: tuple[CameraNumber, ...] = LEVELS
    min_sd: float = 0.002
    max_independent: float = 8.0

    @property
    def frame(self) -> Ints:
        return np.repeat(self.patches.frame, 3)

    @cached_property
    def heldout(self) -> Mask:
        return self.heldout_frames[self.frame]

    @property
    def fit(self) -> Mask:
        return ~self.heldout

    @cached_property
    def light(self) -> Array:
        """Return the light of the scene, exposed as in the simulated images and smoothed, (N, 3)."""
        nominal, place = self.nominal, self.patches
        raw = ToneResponse.of(nominal).raw(place.simulated)
        light, smooth = raw / self._left_of_light(place.nominal_at, nominal.vignetting)[:, None], np.empty_like(raw)
        for frame in np.unique(place.frame):
            for on_line in (False, True):
                here = (place.frame == frame) & (place.on_line == on_line)
                if here.any():
                    smooth[here] = _smoothed(light[here], place.nominal_at[here] / self.size_px[0])
        return smooth

    @cached_property
    def _untextured(self) -> Array:
        """Return measured values without the texture of the simulated patches, (N, 3)."""
        place, nominal = self.patches, self.nominal
        raw = self.light * self._left_of_light(place.nominal_at, nominal.vignetting)[:, None]
        return place.measured - (place.simulated - ToneResponse.of(nominal).coded(raw))

    def _left_of_light(self, at: Array, vignetting: float) -> Array:
        return 1.0 - vignetting * corner_share(at[:, 0], at[:, 1], *self.size_px)

    def predicted(self, x: Array, own: float = 0.0) -> Array:
        """Return predicted values (N, 3), each image exposed exp(`own`) times as long."""
        d = dict(zip((n.name for n in self.numbers), x * [n.tolerance for n in self.numbers], strict=True))
        nominal = self.nominal
        paler = np.where(self.patches.on_line, np.exp(d["line_reflectance_scale"]), 1.0)[:, None]
        light = self.light * paler * np.exp(d["exposure_scale"] + own)
        veil = self.mean_light[self.patches.frame] * np.exp(d["exposure_scale"] + own)
        light = light + d["veiling_glare"] * (veil - light)
        raw = light * self._left_of_light(self.patches.at, nominal.vignetting + d["vignetting"])[:, None]
        red, green, blue = nominal.white_balance
        balance = (red * np.exp(d["red_gain_scale"]), green, blue * np.exp(d["blue_gain_scale"]))
        contrast = nominal.contrast * float(np.exp(d["contrast_scale"]))
        saturation = nominal.saturation * float(np.exp(d["saturation_scale"]))
        return ToneResponse(contrast, saturation, balance).coded(raw)

    @cached_property
    def mean_light(self) -> Array:
        """Return the mean light of each image, approximated by its patches of floor, (frames, 3)."""
        frames = len(self.heldout_frames)
        found = np.zeros((frames, 3))
        floor = ~self.patches.on_line
        for frame in range(frames):
            here = floor & (self.patches.frame == frame)
            found[frame] = self.light[here if here.any() else floor].mean(axis=0)
        return found

    def residuals(self, x: Array) -> Array:
        return (self._untextured - self.predicted(x)).ravel()

    def frame_slopes(self, x: Array) -> Array:
        step = self.predicted(x, 0.5 * OWN_EXPOSURE) - self.predicted(x, -0.5 * OWN_EXPOSURE)
        return step.reshape(-1, 1)

    def some(self, most: int) -> "LevelModel":
        """Return the model with every nth patch of floor, so that about `most` of them remain."""
        p = self.patches
        floor = np.flatnonzero(~p.on_line)
        kept = np.sort(np.concatenate([floor[:: max(1, len(floor) // most)], np.flatnonzero(p.on_line)]))
        taken = FloorPatches(*(getattr(p, name)[kept] for name in p.__dataclass_fields__))
        return replace(self, patches=taken)


def _smoothed(light: Array, at: Array) -> Array:
    """Return light (n, 3) at places (n, 2) smoothed by a polynomial whose degree fits the number of patches."""
    x, y = (at - at.mean(axis=0)).T
    columns = [np.ones(len(x)), x, y, x * x, x * y, y * y]
    some = np.stack(columns[: 6 if len(x) >= FOR_SQUARES else 1], axis=1)
    return some @ np.linalg.lstsq(some, light, rcond=None)[0]
