"""The random texture of a floor, measured in photographs.

The logarithm of the light of the floor is taken as a sum of Gaussian random fields. Each is white noise that is blurred
by a Gaussian of another width s, so that its covariance over a distance r is v exp(-r^2 / (4 s^2)). A lens whose point
spread is a Gaussian of width b turns s into sqrt(s^2 + b^2) and v into v s^2 / (s^2 + b^2), so that its blur can be
taken back in closed form.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from symolo.core.arrays import Array
from symolo.core.random_streams import stream

_FIRST_LAG_PX = 2
"""Over shorter distances, pixels share noise."""
_LAST_LAG_SHARE = 0.6
"""Largest distance at which the covariance is measured, as a share of the width of the photographs."""
_MIN_PAIRS = 2000


@dataclass(frozen=True)
class FloorLight:
    """Light of the floor in one photograph, on the plane of the floor."""

    log_light: Array
    """(H, W), natural logarithm of the light without vignetting; its median over `mask` is 0."""
    mask: NDArray[np.bool_]
    """(H, W), pixels that show the floor."""


@dataclass(frozen=True)
class FloorTexture:
    """Random variation of the reflectance of a floor."""

    scales_px: tuple[float, ...]
    """Standard deviations of the Gaussians [px of the photographs]."""
    spreads: tuple[float, ...]
    """Standard deviation of the logarithm of the reflectance that each of them adds."""

    @classmethod
    def from_floors(cls, floors: Sequence[FloorLight], blur_px: float) -> "FloorTexture":
        """Return the texture whose covariance is that of the photographs, before the lens blurred it.

        Args:
            floors: Floors of photographs of one size.
            blur_px: Standard deviation of the blur of the lens.

        Raises:
            ValueError: Too little of the floor is visible.
        """
        width = floors[0].mask.shape[1]
        lags, covariance, pairs = _covariance(floors, round(_LAST_LAG_SHARE * width))
        if len(lags) < 2:
            raise ValueError("too little of the floor is visible")
        scales = np.array([2.0**k for k in range(int(np.log2(0.5 * width)) + 1)])
        blurred = np.hypot(scales, blur_px)
        weights = np.sqrt(pairs)
        columns = np.exp(-(lags[:, None] ** 2) / (4 * blurred**2))
        variances = nnls(columns * weights[:, None], covariance * weights)[0] * (blurred / scales) ** 2
        present = variances > 0
        return cls(tuple(scales[present].tolist()), tuple(np.sqrt(variances[present]).tolist()))

    @property
    def spread(self) -> float:
        """Return the standard deviation of the logarithm of the reflectance."""
        return float(np.linalg.norm(self.spreads)) if self.spreads else 0.0

    def tile(self, size_px: int, amount: float, seed: int) -> Array:
        """Return factors (size_px, size_px) on a reflectance, with a mean of 1, that repeat without a seam.

        Args:
            size_px: Side of the square [px of the photographs].
            amount: Factor on the standard deviation.
            seed: Seed of the pattern.
        """
        down, across = np.fft.fftfreq(size_px)[:, None], np.fft.rfftfreq(size_px)[None, :]
        logarithm = np.zeros((size_px, size_px))
        for scale, spread in zip(self.scales_px, self.spreads, strict=True):
            white = stream(seed, "floor texture", round(scale)).standard_normal((size_px, size_px))
            passed = np.exp(-2 * np.pi**2 * scale**2 * (down**2 + across**2))
            # By Parseval's theorem, without the mean: the column of frequency 0 counts once, most others twice.
            power = 2 * (passed**2).sum() - (passed[:, 0] ** 2).sum() - (size_px % 2 == 0) * (passed[:, -1] ** 2).sum()
            passed[0, 0] = 0.0
            field = np.fft.irfft2(np.fft.rfft2(white) * passed, s=(size_px, size_px))
            logarithm += amount * spread * field / np.sqrt((power - 1) / size_px**2)
        factor = np.exp(logarithm)
        return factor / factor.mean()


def _covariance(floors: Sequence[FloorLight], last_px: int) -> tuple[Array, Array, Array]:
    """Return distances [px], mean product of the logarithms at each of them, and the number of pairs of pixels."""
    products, pairs = (np.sum(sums, axis=0) for sums in zip(*_pair_sums(floors), strict=True))
    height, width = pairs.shape
    down, across = np.meshgrid(np.fft.fftfreq(height, 1 / height), np.fft.fftfreq(width, 1 / width), indexing="ij")
    distance = np.hypot(down, across).round().astype(int)
    lags = np.arange(_FIRST_LAG_PX, last_px + 1)
    counts = np.bincount(distance.ravel(), pairs.ravel())[lags].astype(np.float64)
    sums = np.bincount(distance.ravel(), products.ravel())[lags]
    enough = counts > _MIN_PAIRS
    return lags[enough].astype(float), sums[enough] / counts[enough], counts[enough]


def _pair_sums(floors: Sequence[FloorLight]) -> Iterator[tuple[Array, Array]]:
    """Yield, for each shift in each photograph, the sum of the products of all pairs of pixels, and their number."""
    for floor in floors:
        height, width = floor.mask.shape
        size = 2 * height, 2 * width
        mask = floor.mask.astype(np.float64)
        value, counted = (np.fft.rfft2(each, s=size) for each in (np.where(floor.mask, floor.log_light, 0.0), mask))
        yield np.fft.irfft2(np.abs(value) ** 2, s=size), np.rint(np.fft.irfft2(np.abs(counted) ** 2, s=size))


def on_the_floor(values: Array, pitch_down_deg: float, field_of_view_deg: float) -> Array:
    """Return an image (H, W) as a camera above its middle would see it that looks straight down; 0 where it ends.

    Args:
        values: (H, W), an image of a pinhole camera.
        pitch_down_deg: Angle of its optical axis below the horizon.
        field_of_view_deg: Its horizontal field of view.
    """
    if pitch_down_deg == 90:
        return values
    height, width = values.shape
    focal_px = 0.5 * width / np.tan(np.radians(0.5 * field_of_view_deg))
    pitch = np.radians(pitch_down_deg)
    u0, v0 = 0.5 * (width - 1), 0.5 * (height - 1)
    # The depth of a point of the floor, relative to the one in the middle, grows with its distance ahead.
    depth = np.array([0.0, -np.cos(pitch) / focal_px, 1 + v0 * np.cos(pitch) / focal_px])
    to_image = np.array(
        [
            np.array([1.0, 0.0, -u0]) + u0 * depth,
            np.array([0.0, np.sin(pitch), -v0 * np.sin(pitch)]) + v0 * depth,
            depth,
        ]
    )
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    return np.asarray(cv2.warpPerspective(values, to_image, (width, height), flags=flags), np.float64)
