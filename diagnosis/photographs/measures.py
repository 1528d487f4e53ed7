"""Measures of photographs from which the settings of a camera, a floor and a line follow."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

from diagnosis.photographs.image_figures import ImageFigures, edge_px, floor_mask, laplacian, line_mask
from diagnosis.photographs.line_edges import with_light_edges
from diagnosis.photographs.line_place import BgrImage, LinePlace
from sensors.camera.colour import LUMINANCE
from sensors.camera.response import corner_share, inverse_tone
from symolo.core.arrays import Array

MIN_FLOOR_SHARE = 0.05
"""Smallest share of an image that must be floor at a clear distance from the line."""
_PROFILES = 40
"""Number of rows, evenly spread, whose profiles are averaged."""
_FAR_PX = 10
_BIN_PX = 0.5
_NEAR_PX = (1.0, 5.0)
_BEYOND_PX = (6.0, 10.0)
"""Distances from an edge where a sharpened image overshoots, and where the floor has its level."""
_MAX_PIXELS = 4000
"""Number of floor pixels, evenly spread, from which the vignetting of a photograph is estimated."""
_VIGNETTING = np.linspace(0.0, 0.9, 91)


@dataclass(frozen=True)
class PhotographMeasures:
    """Measures of one photograph; grey values from 0 to 255 as stored."""

    name: str
    place: LinePlace
    edge_px: float
    """Width of the line's edge from 10 to 90 %, square to it."""
    floor_rgb: Array
    """(3,), median of the floor beside the line."""
    line_rgb: Array
    """(3,), median of the line."""
    floor_noise: float
    line_noise: float
    """Standard deviations of the noise on floor and line (Immerkaer 1996)."""
    overshoot: float
    """Height by which the floor beside the edge exceeds the floor farther off, as a share of the edge."""

    @classmethod
    def from_place(cls, name: str, place: LinePlace) -> "PhotographMeasures | None":
        """Return the measures; None where too little of the floor is visible beside the line to measure its edges."""
        floor, line = floor_and_line(place)
        grey = cv2.cvtColor(place.image, cv2.COLOR_BGR2GRAY).astype(np.float64)
        width_px = edge_px(grey if place.is_dark else 255 - grey, place.x_px, place.rows_px)
        if floor.mean() < MIN_FLOOR_SHARE or not line.any() or np.isnan(width_px):
            return None
        noise = np.abs(laplacian(grey))
        rgb = place.image[..., ::-1]
        return cls(
            name=name,
            place=place,
            edge_px=width_px,
            floor_rgb=np.median(rgb[floor], axis=0),
            line_rgb=np.median(rgb[line], axis=0),
            floor_noise=float(noise[floor[1:-1, 1:-1]].mean()),
            line_noise=float(noise[line[1:-1, 1:-1]].mean()),
            overshoot=_overshoot(grey, place),
        )

    def with_light_edges(self, contrast: float) -> "PhotographMeasures":
        """Return the measures with the width of the line in linear light, by the contrast of the camera."""
        return replace(self, place=with_light_edges(self.place, contrast))

    @cached_property
    def figures(self) -> ImageFigures:
        """Return the figures by which photographs and rendered images are compared."""
        return ImageFigures.from_image(
            self.place.image, self.place.x_px, self.place.rows_px, is_dark=self.place.is_dark
        )


def floor_and_line(place: LinePlace) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return the pixels (H, W) that are well on the floor, and those well on the line."""
    grey = cv2.cvtColor(place.image, cv2.COLOR_BGR2GRAY).astype(np.float64)
    signed = grey if place.is_dark else 255 - grey
    rows = np.arange(len(grey))
    middle = np.interp(rows, place.rows_px, place.x_px)
    off = np.abs(np.arange(grey.shape[1])[None, :] - middle[:, None])
    seen = (rows >= place.rows_px[0]) & (rows <= place.rows_px[-1])
    return floor_mask(signed), line_mask(signed) & (off < 0.5 * place.width_px) & seen[:, None]


def _overshoot(grey: Array, place: LinePlace) -> float:
    """Return the overshoot of the median profile across both edges, whose place is interpolated in each row."""
    far, sign = int(0.5 * place.width_px), 1.0 if place.is_dark else -1.0
    offsets, levels = [], []
    first, last = round(place.rows_px[0]), round(place.rows_px[-1])
    for row in range(first, last + 1, max(1, (last - first) // _PROFILES)):
        middle = round(float(np.interp(row, place.rows_px, place.x_px)))
        for direction in (-1, 1):
            outward = sign * grey[row, middle::direction]
            if len(outward) < far + _FAR_PX + 6:
                continue
            line, floor = np.median(outward[: max(far - 5, 1)]), np.median(outward[far + 5 : far + _FAR_PX + 5])
            edge = int(np.argmax(outward > 0.5 * (line + floor)))
            if floor - line < 1 or not far - 6 < edge < far + 6:
                continue
            share = (0.5 * (line + floor) - outward[edge - 1]) / max(outward[edge] - outward[edge - 1], 1e-6)
            offsets.append(np.arange(len(outward)) - (edge - 1 + share))
            levels.append((outward - line) / (floor - line))
    if not offsets:
        return 0.0
    offset, level = np.concatenate(offsets), np.concatenate(levels)
    profile = [
        np.median(level[np.abs(offset - at) < 0.5 * _BIN_PX])
        for at in np.arange(*_NEAR_PX, _BIN_PX)
        if np.any(np.abs(offset - at) < 0.5 * _BIN_PX)
    ]
    beyond = level[(offset > _BEYOND_PX[0]) & (offset < _BEYOND_PX[1])]
    return max(0.0, float(max(profile) - np.median(beyond))) if profile and len(beyond) else 0.0


def light_of(rgb: Array | BgrImage, contrast: float) -> Array:
    """Return the linear light (..., 3) of grey values (..., 3), 0 to 255."""
    return inverse_tone(np.asarray(rgb, np.float64) / 255, contrast)


def vignetting(photographs: Sequence[PhotographMeasures], contrast: float) -> float:
    """Return the share of light that is lost in the corners, by least squares over the floors of all photographs.

    In each of them, the logarithm of the light is a plane, for the uneven light of the room, plus that of the loss.
    """
    costs = np.sum([_costs(photograph, contrast) for photograph in photographs], axis=0)
    return float(_VIGNETTING[int(np.argmin(costs))])


def _costs(photograph: PhotographMeasures, contrast: float) -> Array:
    """Return the mean squared residual (V,) for each vignetting."""
    image, (height, width) = photograph.place.image, photograph.place.shape
    floor, _ = floor_and_line(photograph.place)
    v, u = np.nonzero(floor)
    every = max(1, len(u) // _MAX_PIXELS)
    v, u = v[::every], u[::every]
    light = np.log(np.maximum(light_of(image[v, u, ::-1], contrast) @ LUMINANCE, 1e-4))
    lost = corner_share(u, v, width, height)
    plane = np.column_stack([np.ones(len(u)), u / width, v / width])
    basis, _ = np.linalg.qr(plane)
    without = light[:, None] - np.log1p(-lost[:, None] * _VIGNETTING)
    residual = without - basis @ (basis.T @ without)
    return (residual**2).mean(axis=0)


def shading_ev(photograph: PhotographMeasures, contrast: float, vignette: float) -> tuple[float, float]:
    """Return the stops by which the light of the floor rises from the left border to the right, and downwards."""
    image, (height, width) = photograph.place.image, photograph.place.shape
    floor, _ = floor_and_line(photograph.place)
    v, u = np.nonzero(floor)
    transmitted = 1 - vignette * corner_share(u, v, width, height)
    light = np.log2(np.maximum(light_of(image[v, u, ::-1], contrast) @ LUMINANCE, 1e-4) / transmitted)
    plane = np.column_stack([np.ones(len(u)), u / width, v / height])
    _, right, down = np.linalg.lstsq(plane, light, rcond=None)[0]
    # In a turned image, the axes are exchanged.
    return (float(down), float(right)) if photograph.place.is_turned else (float(right), float(down))


def median_light(photograph: PhotographMeasures, contrast: float, vignette: float) -> float:
    """Return the median luminance, 1 for white, that the exposure of a photograph made."""
    image, (height, width) = photograph.place.image, photograph.place.shape
    v, u = np.mgrid[0:height, 0:width]
    transmitted = 1 - vignette * corner_share(u, v, width, height)
    return float(np.median(light_of(image[..., ::-1], contrast) @ LUMINANCE / transmitted))


def median_of(photographs: Sequence[PhotographMeasures], value: Callable[[PhotographMeasures], float]) -> float:
    """Return the median of a value over the photographs, without those where it cannot be measured."""
    return float(np.nanmedian([value(photograph) for photograph in photographs]))
