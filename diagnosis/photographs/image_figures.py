"""Numbers of an image of a line on a floor, computed in the same way for photographs and for rendered frames."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import Array

_BEYOND_PX = 4
"""Floor counts from so far beyond an edge."""
_FLOOR_PX = 10
_MIN_PX = 6
"""Smallest half width of a line that has a level of its own."""
_LAPLACIAN = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], np.float64)
_MOTTLING_PX = 3.0
_RUN = 9
"""Rows of an edge that a parabola is fitted to."""


@dataclass(frozen=True)
class ImageFigures:
    """Grey values from 0 to 255 as stored."""

    edge_px: float
    """Width of the edge of the line, from 10 to 90 % of the step, square to the edge; median over the rows."""
    noise: float
    """Standard deviation after Immerkaer 1996, Computer Vision and Image Understanding 64, 300.

    Fine texture adds to it."""
    mottling_percent: float
    """Standard deviation of the floor beside the line to its mean, finer than 3 px left out."""
    line_spread: float
    """Standard deviation on the line, 4 px off its edges: what shines on it, and wear."""
    contrast: float
    """(floor - line) / (floor + line) of grey values beside the line and on it; median over the rows."""
    saturation_percent: float
    """Mean of (max - min) / max of the components."""
    black: float
    """Grey value below which 1 % of the image is."""
    white: float
    """Grey value above which 1 % of the image is."""
    spectrum_slope: float
    """Slope of the logarithm of power over that of frequency, from 0.03 to 0.4 cycles a pixel, in all directions."""
    high_frequency_percent: float
    """Share of the power, without the mean, above 0.25 cycles a pixel."""
    jaggedness_px: float
    """Standard deviation of the line's edge, row by row and square to the edge, from a smooth curve along nine rows."""

    @classmethod
    def from_image(
        cls, image: NDArray[np.uint8], x_px: Array, rows_px: Sequence[float], *, is_dark: bool = True
    ) -> "ImageFigures":
        """Return the figures of an image.

        Args:
            image: (H, W, 3), blue first.
            x_px: (R,), middle of the line in each row, NaN where it is unknown.
            rows_px: (R,), rows; 0 is the middle of the first one.
            is_dark: Whether the line is darker than the floor.
        """
        grey = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY).astype(np.float64)
        # With a light line, the edges are measured in the negative.
        signed = grey if is_dark else 255 - grey
        steps, across = _all_steps(signed, x_px, rows_px), _across(x_px, rows_px)
        smooth = cv2.GaussianBlur(grey, (0, 0), _MOTTLING_PX)
        floor, line = floor_mask(signed), line_mask(signed)
        noise = np.abs(laplacian(grey)).mean()
        frequency, power = _spectrum(grey)
        within = (frequency > 0.03) & (frequency < 0.4)
        top, low = image.max(axis=2).astype(float), image.min(axis=2).astype(float)
        return cls(
            edge_px=_edge_px(steps) * across,
            noise=float(noise),
            mottling_percent=float(100 * smooth[floor].std() / smooth[floor].mean()),
            line_spread=float(grey[line].std()) if line.any() else np.nan,
            contrast=float(np.median([_contrast(s, is_dark=is_dark) for s in steps])) if steps else np.nan,
            saturation_percent=float(100 * ((top - low) / np.maximum(top, 1)).mean()),
            black=float(np.quantile(grey, 0.01)),
            white=float(np.quantile(grey, 0.99)),
            spectrum_slope=_fitted_slope(frequency[within], power[within]),
            high_frequency_percent=float(100 * power[frequency > 0.25].sum() / power[frequency > 0].sum()),
            jaggedness_px=_jaggedness(signed, x_px, rows_px, steps) * across,
        )


@dataclass(frozen=True)
class _Step:
    line: float
    floor: float
    width_px: float


def edge_px(signed: Array, x_px: Array, rows_px: Sequence[float]) -> float:
    """Return `ImageFigures.edge_px` of grey values (H, W) in which the line is dark; NaN where no edge is measured."""
    return _edge_px(_all_steps(signed, x_px, rows_px)) * _across(x_px, rows_px)


def _edge_px(steps: Sequence[_Step]) -> float:
    """Return the median width along the rows."""
    return float(np.median([s.width_px for s in steps])) if steps else np.nan


def _across(x_px: Array, rows_px: Sequence[float]) -> float:
    """Return the ratio of a distance square to the line to the one along a row."""
    known = np.isfinite(x_px)
    slope = np.polyfit(np.array(rows_px)[known], x_px[known], 1)[0] if known.sum() > 1 else 0.0
    return float(np.cos(np.arctan(slope)))


def _all_steps(grey: Array, x_px: Array, rows_px: Sequence[float]) -> list[_Step]:
    return [s for row, x in zip(rows_px, x_px, strict=True) if np.isfinite(x) for s in _steps(grey, row, x)]


def _steps(grey: Array, row: float, x: float) -> list[_Step]:
    """Return the edges on both sides of the line's middle, in the mean of the two rows about `row`."""
    profile = grey[int(row) : int(row) + 2].mean(axis=0)
    middle = round(x)
    line = float(np.median(profile[middle - 4 : middle + 5]))
    half = 0.5 * (line + float(np.quantile(profile, 0.9)))
    steps = []
    for direction in (-1, 1):
        outward = profile[middle::direction]
        edge = int(np.argmax(outward > half))
        floor_there = outward[edge + _BEYOND_PX : edge + _FLOOR_PX]
        if edge < _MIN_PX or len(floor_there) < _FLOOR_PX - _BEYOND_PX:
            continue
        floor, inner = float(np.median(floor_there)), float(np.median(outward[max(0, edge - _FLOOR_PX) : edge - 3]))
        near = outward[edge - 4 : edge + _BEYOND_PX]
        low, high = (_first_above(near, inner + share * (floor - inner)) for share in (0.1, 0.9))
        steps.append(_Step(line, floor, high - low))
    return steps


def _contrast(step: _Step, *, is_dark: bool) -> float:
    """Return (floor - line) / (floor + line), positive for light lines too."""
    difference = step.floor - step.line
    return difference / (step.floor + step.line if is_dark else 510 - step.floor - step.line)


def _first_above(profile: Array, level: float) -> float:
    """Return where a profile first rises through a level, interpolated between its samples."""
    at = max(1, int(np.argmax(profile > level)))
    return at - 1 + float((level - profile[at - 1]) / max(profile[at] - profile[at - 1], 1e-6))


def _spectrum(grey: Array) -> tuple[Array, Array]:
    """Frequency [cycles a pixel] and power of each component; the borders fade out, so that they are no edge."""
    height, width = grey.shape
    window = np.outer(np.hanning(height), np.hanning(width))
    apart = grey - (grey * window).sum() / window.sum()
    power = (np.abs(np.fft.fft2(apart * window)) ** 2).astype(np.float64)
    return np.hypot(np.fft.fftfreq(height)[:, None], np.fft.fftfreq(width)[None, :]), power


def _fitted_slope(frequency: Array, power: Array) -> float:
    """Return the slope by least squares over ten bands of equal width on the logarithmic scale."""
    edges = np.geomspace(frequency.min(), frequency.max() * 1.0001, 11)
    band = np.digitize(frequency, edges)
    middles = np.array([np.log(frequency[band == b]).mean() for b in range(1, 11)])
    levels = np.array([np.log(power[band == b].mean()) for b in range(1, 11)])
    return float(np.polyfit(middles, levels, 1)[0])


def _jaggedness(grey: Array, x_px: Array, rows_px: Sequence[float], steps: Sequence[_Step]) -> float:
    known = np.isfinite(x_px)
    if known.sum() < 2 or not steps:
        return np.nan
    half = float(np.median([0.5 * (s.line + s.floor) for s in steps]))
    at = np.array(rows_px)[known]
    rows = np.arange(int(at.min()), int(at.max()) + 2)
    middles = np.rint(np.interp(rows, at, x_px[known])).astype(int)
    spreads = []
    for direction in (-1, 1):
        edge = np.array(
            [
                middle + direction * _first_above(grey[row, middle::direction], half)
                for row, middle in zip(rows, middles, strict=True)
            ]
        )
        for run in np.lib.stride_tricks.sliding_window_view(edge, _RUN):
            off = run - np.polyval(np.polyfit(np.arange(_RUN), run, 2), np.arange(_RUN))
            spreads.append(np.sqrt((off**2).sum() / (_RUN - 3)))
    return float(np.median(spreads))


def laplacian(grey: Array) -> Array:
    """Return values (H - 2, W - 2) whose mean magnitude is the standard deviation of independent noise (Immerkaer)."""
    return cv2.filter2D(grey, -1, _LAPLACIAN)[1:-1, 1:-1] * np.sqrt(np.pi / 2) / 6


def floor_mask(grey: Array) -> NDArray[np.bool_]:
    """Return the pixels (H, W) that are well off whatever is dark."""
    return cv2.erode(_bright(grey), np.ones((15, 15), np.uint8)).astype(bool)


def line_mask(grey: Array) -> NDArray[np.bool_]:
    """Return the pixels (H, W) that are well within what is dark."""
    return cv2.erode(1 - _bright(grey), np.ones((9, 9), np.uint8)).astype(bool)


def _bright(grey: Array) -> NDArray[np.uint8]:
    return (grey > 0.6 * np.quantile(grey, 0.75)).astype(np.uint8)


def medians(figures: Sequence[ImageFigures]) -> dict[str, tuple[float, float, float]]:
    """Return median, smallest and largest of each figure."""
    table = {name: np.array([getattr(f, name) for f in figures]) for name in vars(figures[0])}
    return {n: (float(np.nanmedian(v)), float(np.nanmin(v)), float(np.nanmax(v))) for n, v in table.items()}
