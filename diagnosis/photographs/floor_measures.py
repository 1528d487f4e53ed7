"""The floor beside the line: its random texture, and sheets of paper along the line."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from configs.schema.appearance.camera_look import CameraLook
from diagnosis.photographs.floor_texture import FloorLight, FloorTexture, on_the_floor
from diagnosis.photographs.measures import PhotographMeasures, floor_and_line, light_of, shading_ev
from sensors.camera.colour import LUMINANCE
from sensors.camera.response import corner_share
from symolo.core.arrays import Array

_BESIDE = 0.35
"""Width of the strips on both sides of a possible border that are compared, in widths of the line."""
_GAP = 0.06
"""Distance of these strips from that border."""
_STEP = 0.02
_NEAREST = 0.25
"""Smallest distance of a border from the edge of the line."""
_LARGEST_BORDER = 3.0
"""Largest distance of a border from the middle of the line, in widths of the line."""
_MIN_STRIP_PIXELS = 150
_MIN_STEP = 0.05
"""Smallest median difference between the logarithms of the light on and off the sheets."""
_MIN_SHARE = 0.7
"""Smallest share of the sides of lines on which sheets must be visible."""
_SHIFT = 0.3
"""Distance from the median border, in widths of the line, within which that of each side is looked for."""
_DARKEST = 1e-4


@dataclass(frozen=True)
class PaperSheets:
    """Sheets along the line, lighter or darker than the floor beside them."""

    width: float
    """Width across the line, in widths of the line."""
    shift: float
    """Largest shift of a sheet from the middle of the line, in widths of the line."""
    ratio: float
    """Light of the sheets as a share of that of the floor."""
    visible: int
    """Number of sides of lines on which their border was recognised."""
    sides: int
    """Number of sides of lines that were examined."""


@dataclass(frozen=True)
class FloorMeasures:
    """What photographs show of a floor."""

    texture: FloorTexture
    sheets: PaperSheets | None
    beside: float
    """Median light of what is beside the line as a share of that of the bare floor."""

    @classmethod
    def from_photographs(
        cls,
        photographs: Sequence[PhotographMeasures],
        camera: CameraLook,
        pitch_down_deg: float,
        field_of_view_deg: float,
    ) -> "FloorMeasures":
        """Return the measures of photographs of one size.

        Args:
            photographs: Photographs of one camera.
            camera: Its tone curve, vignetting and blur.
            pitch_down_deg: Angle of its optical axis below the horizon.
            field_of_view_deg: Its horizontal field of view.

        Raises:
            ValueError: Too little of the floor is visible.
        """
        seen = [_Seen.from_photograph(photograph, camera.contrast, camera.vignetting) for photograph in photographs]
        sheets = _sheets(seen)
        border = np.inf if sheets is None else 0.5 * sheets.width + sheets.shift
        floors, lighter = [], []
        for one in seen:
            bare = one.floor & (np.abs(one.off) > (border if np.isfinite(border) else 0.0))
            if not bare.any():
                continue
            level = float(np.median(one.log_light[bare]))
            lighter.append(float(np.median(one.log_light[one.floor])) - level)
            light, mask = one.upright(one.log_light - level), one.upright(bare.astype(np.float64))
            floors.append(
                FloorLight(
                    on_the_floor(light, pitch_down_deg, field_of_view_deg),
                    on_the_floor(mask, pitch_down_deg, field_of_view_deg) > 0.999,
                )
            )
        if not floors:
            raise ValueError("too little of the floor is visible")
        return cls(FloorTexture.from_floors(floors, camera.lens_blur_px), sheets, float(np.exp(np.median(lighter))))


@dataclass(frozen=True)
class _Seen:
    log_light: Array
    floor: NDArray[np.bool_]
    off: Array
    """Distance of each pixel from the middle of the line, in widths of the line, negative to its left."""
    is_turned: bool

    @classmethod
    def from_photograph(cls, photograph: PhotographMeasures, contrast: float, vignetting: float) -> "_Seen":
        place, (height, width) = photograph.place, photograph.place.shape
        v, u = np.mgrid[0:height, 0:width]
        transmitted = 1 - vignetting * corner_share(u, v, width, height)
        right, down = shading_ev(photograph, contrast, vignetting)[:: -1 if place.is_turned else 1]
        transmitted = transmitted * 2.0 ** (right * ((u + 0.5) / width - 0.5) + down * ((v + 0.5) / height - 0.5))
        light = light_of(place.image[..., ::-1], contrast) @ LUMINANCE / transmitted
        floor, _ = floor_and_line(place)
        rows = (np.arange(height) >= place.rows_px[0]) & (np.arange(height) <= place.rows_px[-1])
        middle = np.interp(np.arange(height), place.rows_px, place.x_px)
        off = (u - middle[:, None]) / place.width_px
        return cls(np.log(np.maximum(light, _DARKEST)), floor & rows[:, None], off, place.is_turned)

    def upright(self, values: Array) -> Array:
        return np.ascontiguousarray(values.T) if self.is_turned else values

    def steps(self, direction: int, borders: Array) -> Array:
        """Return the mean logarithm of the light within each border minus that beyond; NaN where pixels are few."""
        off = direction * self.off[self.floor]
        aside = off > 0
        number = (off[aside] / _STEP).astype(int)
        length = max(int(number.max(initial=0)) + 1, round((_LARGEST_BORDER + 1) / _STEP))
        sums = np.cumsum(np.bincount(number, self.log_light[self.floor][aside], length))
        counts = np.cumsum(np.bincount(number, minlength=length))
        means = []
        for low in (borders - _GAP - _BESIDE, borders + _GAP):
            first, end = np.rint(low / _STEP).astype(int), np.rint((low + _BESIDE) / _STEP).astype(int)
            pixels = counts[end - 1] - counts[first - 1]
            total = sums[end - 1] - sums[first - 1]
            means.append(np.where(pixels < _MIN_STRIP_PIXELS, np.nan, total / np.maximum(pixels, 1)))
        return means[0] - means[1]


def _sheets(seen: Sequence[_Seen]) -> PaperSheets | None:
    """Return the sheets whose border is visible on most sides of the lines at about the same distance, if any are."""
    borders = np.arange(0.5 + _NEAREST + _BESIDE, _LARGEST_BORDER, _STEP)
    steps = np.array([one.steps(direction, borders) for one in seen for direction in (-1, 1)])
    known = np.isfinite(steps)
    columns = known.sum(axis=0) >= max(2, 0.5 * len(steps))
    if not columns.any():
        return None
    borders, steps = borders[columns], steps[:, columns]
    medians = np.nanmedian(steps, axis=0)
    best = int(np.argmax(np.abs(medians)))
    sign = np.sign(medians[best])
    near = np.abs(borders - borders[best]) <= _SHIFT
    steps, borders = sign * steps[:, near], borders[near]
    steps = steps[np.isfinite(steps).any(axis=1)]
    largest = np.nanmax(steps, axis=1)
    # Where the border lies in the gap between the strips, all steps are alike.
    at = np.array([borders[step >= most - 0.05 * abs(most)].mean() for step, most in zip(steps, largest, strict=True)])
    visible = largest > _MIN_STEP
    if np.abs(medians[best]) < _MIN_STEP or visible.mean() < _MIN_SHARE:
        return None
    border = float(np.median(at[visible]))
    shift = float(np.quantile(np.abs(at[visible] - border), 0.9))
    ratio = float(np.exp(sign * np.median(largest[visible])))
    return PaperSheets(2 * border, shift, ratio, int(visible.sum()), len(steps))
