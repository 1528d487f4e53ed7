"""Where the edges of the line are in the images, to fractions of a pixel.

Each is looked for along the normal of where it should be, as in model-based tracking (Harris and Stennett, RAPID, BMVC
1990): the steepest rise from dark to bright outwards, its place by a parabola through the gradient's peak. Grey values
are made linear in light first, else blur would move edges to the dark side.
"""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from diagnosis.camera.case import ImagePixels, Mask
from diagnosis.camera.features.line_points import ExpectedEdges
from symolo.core.arrays import Array

STEP_PX = 0.25
SMOOTH_PX = 0.8
"""Standard deviation of the derivative's Gaussian."""
MIN_CONTRAST = 0.3
"""Least contrast as a share of the median edge; a weaker one is something else."""
BESIDE_PX, MIN_MICHELSON = 2.5, 0.15
"""Distance from the edge and least Michelson contrast of floor and line there; less is noise."""
CLEAREST = 0.5
"""Share of the steepest rise from which a rise competes; the competing rise that is nearest is taken."""

Linear = Callable[[ImagePixels], Array]
"""Function from 8-bit values (H, W, 3) to light (H, W)."""


@dataclass(frozen=True)
class EdgeProfiles:
    """Light along normals."""

    along_px: Array
    """(K,), distance outwards from where the edge should be."""
    light: Array
    """(N, K)."""


def profiles(sighting: ExpectedEdges, images: list[Array], reach_px: float) -> EdgeProfiles:
    """Return the profile of each point in the image (H, W) of its frame, up to `reach_px` to either side."""
    count = int(np.ceil(reach_px / STEP_PX))
    along = STEP_PX * np.arange(-count, count + 1)
    light = np.zeros((len(sighting.points), len(along)))
    for frame in np.unique(sighting.points.frame).tolist():
        here = sighting.points.frame == frame
        at = sighting.pixels[here][:, None, :] + along[None, :, None] * sighting.outwards[here][:, None, :]
        at = at.astype(np.float32)
        seen = cv2.remap(
            images[frame].astype(np.float32),
            at[..., 0],
            at[..., 1],
            cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_REPLICATE,
        )
        light[here] = seen
    return EdgeProfiles(along, light)


def edges(sighting: ExpectedEdges, images: list[Array], reach_px: float, *, dark: bool = True) -> tuple[Array, Mask]:
    """Return how far outwards each edge is from its expected place, (N,) [px], and which were detected, (N,).

    Args:
        sighting: Where they should be.
        images: (H, W) light of each frame.
        reach_px: How far to look.
        dark: Whether the line is darker than the floor.
    """
    found = profiles(sighting, images, reach_px + 3.0)
    light = found.light if dark else -found.light
    rise = _derivative(light)
    along = found.along_px
    looked_at = np.abs(along) <= reach_px
    rise = np.where(looked_at[None, :], rise, -np.inf)
    top = rise.max(axis=1)
    peaks = (rise >= np.roll(rise, 1, axis=1)) & (rise >= np.roll(rise, -1, axis=1))
    clear = peaks & (rise >= CLEAREST * top[:, None]) & looked_at[None, :]
    distance = np.where(clear, np.abs(along)[None, :], np.inf)
    k = np.argmin(distance, axis=1)
    rows = np.arange(len(light))
    k = np.clip(k, 1, len(along) - 2)
    before, at, after = (rise[rows, k + d] for d in (-1, 0, 1))
    with np.errstate(invalid="ignore", divide="ignore"):
        shift = 0.5 * (before - after) / (before - 2 * at + after)
        contrast = at / np.median(at[np.isfinite(at) & (at > 0)]) if len(at) else at
    beside = round(BESIDE_PX / STEP_PX)
    inner, outer = light[rows, np.maximum(k - beside, 0)], light[rows, np.minimum(k + beside, len(along) - 1)]
    good = np.isfinite(shift) & (np.abs(shift) <= 1) & (contrast > MIN_CONTRAST)
    good &= np.abs(outer - inner) > MIN_MICHELSON * (np.abs(outer) + np.abs(inner))
    return along[k] + STEP_PX * np.where(good, shift, 0.0), good


def _derivative(light: Array) -> Array:
    """Return the derivative along the last axis of the values smoothed by a Gaussian."""
    half = int(np.ceil(3 * SMOOTH_PX / STEP_PX))
    s = STEP_PX * np.arange(-half, half + 1)
    bell = np.exp(-0.5 * (s / SMOOTH_PX) ** 2)
    kernel = -s * bell / (SMOOTH_PX**2 * bell.sum())
    padded = np.pad(light, ((0, 0), (half, half)), mode="edge")
    # A convolution with -s is a correlation with s: bright outwards is positive.
    return np.stack([np.convolve(row, kernel, mode="valid") for row in padded]) if len(light) else light
