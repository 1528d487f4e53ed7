"""How bright and of which colour floor and line are, against the simulated pictures of the same places.

The simulated values are undone to the sensor's light by the nominal response (`sensors.camera.response`), and
done again with one that deviates. Each picture's exposure may differ a little by itself, for automatic exposure meters
what the camera sees.

What is predicted from is smooth over each picture, floor and line apart: noise in it would make slopes too small
(Fuller, Measurement Error Models, 1987, section 1.1), above all that of the colours, which hardly differ over a floor.
The texture that is smoothed away is taken from the measured values in its place.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from diagnosis.camera.case import Ints, Mask
from diagnosis.camera.features.patches import Patches
from diagnosis.camera.features.response import Response
from diagnosis.camera.parameter import Number
from sensors.camera.response import CameraResponse, corner_share
from symolo.core.arrays import Array

LEVELS = (
    Number(
        "exposure_scale", "1", 0.03, "so many times the light is taken", "another exposure time, gain, iris, or light"
    ),
    Number("red_gain_scale", "1", 0.02, "red is amplified more, beside green", "another white balance, or light"),
    Number("blue_gain_scale", "1", 0.02, "blue is amplified more, beside green", "another white balance, or light"),
    Number("vignetting", "1", 0.03, "more of the light is lost in the corners", "another lens or iris"),
    Number("veiling_glare", "1", 0.004, "more light is spread evenly over the picture", "a dirty or a cheap lens"),
    Number("contrast_scale", "1", 0.05, "the tone curve is steeper", "another picture style"),
    Number("saturation_scale", "1", 0.03, "colours are stronger", "another picture style"),
    Number("line_reflectance_scale", "1", 0.25, "the line is paler", "another or a worn tape", can_be_named=False),
)
OWN_EXPOSURE = 0.02
"""Standard deviation of a picture's own exposure."""
FOR_SQUARES = 20
"""Patches of floor or line in a picture, from which a slope and a bend of their light are told."""


@dataclass(frozen=True)
class LevelModel:
    """Levels; a sample is the mean of one channel of one patch, from 0 to 1."""

    patches: Patches
    nominal: CameraResponse
    heldout_frames: Mask
    size_px: tuple[int, int]
    numbers: tuple[Number, ...] = LEVELS
    min_sd: float = 0.002
    max_worth: float = 8.0

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
        """(N, 3), of the scene, exposed as in the simulated pictures, smooth."""
        nominal, place = self.nominal, self.patches
        raw = Response.of(nominal).raw(place.simulated)
        light, smooth = raw / self._left_of_light(place.nominal_at, nominal.vignetting)[:, None], np.empty_like(raw)
        for frame in np.unique(place.frame):
            for on_line in (False, True):
                here = (place.frame == frame) & (place.on_line == on_line)
                if here.any():
                    smooth[here] = _smoothed(light[here], place.nominal_at[here] / self.size_px[0])
        return smooth

    @cached_property
    def _untextured(self) -> Array:
        """(N, 3) measured values, less what distinguishes a simulated patch from a smooth floor or line."""
        place, nominal = self.patches, self.nominal
        raw = self.light * self._left_of_light(place.nominal_at, nominal.vignetting)[:, None]
        return place.measured - (place.simulated - Response.of(nominal).coded(raw))

    def _left_of_light(self, at: Array, vignetting: float) -> Array:
        return 1.0 - vignetting * corner_share(at[:, 0], at[:, 1], *self.size_px)

    def predicted(self, x: Array, own: float = 0.0) -> Array:
        """(N, 3), each picture exposed exp(`own`) times as long."""
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
        return Response(contrast, saturation, balance).coded(raw)

    @cached_property
    def mean_light(self) -> Array:
        """(frames, 3), about what a picture sees: the mean of its patches of floor."""
        frames = len(self.heldout_frames)
        found = np.zeros((frames, 3))
        floor = ~self.patches.on_line
        for frame in range(frames):
            here = floor & (self.patches.frame == frame)
            found[frame] = self.light[here if here.any() else floor].mean(axis=0)
        return found

    def left(self, x: Array) -> Array:
        return (self._untextured - self.predicted(x)).ravel()

    def own(self, x: Array) -> Array:
        step = self.predicted(x, 0.5 * OWN_EXPOSURE) - self.predicted(x, -0.5 * OWN_EXPOSURE)
        return step.reshape(-1, 1)

    def some(self, most: int) -> "LevelModel":
        """With every so-manieth patch of floor, so that there are at most so many."""
        p = self.patches
        floor = np.flatnonzero(~p.on_line)
        kept = np.sort(np.concatenate([floor[:: max(1, len(floor) // most)], np.flatnonzero(p.on_line)]))
        taken = Patches(*(getattr(p, name)[kept] for name in p.__dataclass_fields__))
        return replace(self, patches=taken)


def _smoothed(light: Array, at: Array) -> Array:
    """Of light (n, 3) in places (n, 2), by a polynomial that so many can bear."""
    x, y = (at - at.mean(axis=0)).T
    columns = [np.ones(len(x)), x, y, x * x, x * y, y * y]
    some = np.stack(columns[: 6 if len(x) >= FOR_SQUARES else 1], axis=1)
    return some @ np.linalg.lstsq(some, light, rcond=None)[0]
