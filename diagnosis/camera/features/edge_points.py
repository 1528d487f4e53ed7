"""Measurement of the edges of the line in images, to fractions of a pixel.

Each is searched along the normal at its expected place, as in model-based tracking (Harris and Stennett, RAPID, BMVC
1990): the steepest rise from dark to bright outwards, its place by a parabola through the gradient's peak. Grey values
are made linear in light first, else blur would move edges to the dark side.
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from diagnosis.camera.features.line_points import LineEdges
from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array

STEP_PX = 0.25
"""Distance between the samples of a profile."""
SMOOTH_PX = 0.8
"""Standard deviation of the derivative's Gaussian."""
MIN_CONTRAST = 0.3
"""Smallest contrast as a share of the median edge; a weaker one is something else."""
BESIDE_PX, MIN_MICHELSON = 2.5, 0.15
"""Distance from the edge and smallest Michelson contrast of floor and line there; less is noise."""
CLEAREST = 0.5
"""Share of the steepest rise from which a rise is clear."""


@dataclass(frozen=True)
class EdgeProfiles:
    """Light along normals."""

    along_px: Array
    """(K,), distance outwards from the expected edge."""
    light: Array
    """(N, K), light at these distances across each edge."""


def profiles(edges: LineEdges, images: list[Array], reach_px: float) -> EdgeProfiles:
    """Return the profile of each point in the image (H, W) of its frame, up to `reach_px` to either side."""
    count = int(np.ceil(reach_px / STEP_PX))
    along = STEP_PX * np.arange(-count, count + 1)
    light = np.zeros((len(edges), len(along)))
    for frame in np.unique(edges.frame).tolist():
        here = edges.frame == frame
        at = edges.pixels[here][:, None, :] + along[None, :, None] * edges.outwards[here][:, None, :]
        columns, rows = at.astype(np.float32)[..., 0], at.astype(np.float32)[..., 1]
        image = images[frame].astype(np.float32)
        light[here] = cv2.remap(image, columns, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return EdgeProfiles(along, light)


def measured_edges(expected: LineEdges, images: list[Array], reach_px: float, *, dark: bool) -> tuple[LineEdges, Mask]:
    """Return the edges at the pixels where they were measured, and which of them were detected, (N,).

    Args:
        expected: The edges at the pixels where they are expected.
        images: (H, W), light of each image.
        reach_px: Largest distance from the expected place.
        dark: Whether the line is darker than the floor.
    """
    profile = profiles(expected, images, reach_px + 3.0)
    light, along = profile.light if dark else -profile.light, profile.along_px
    within_reach = np.abs(along) <= reach_px
    rise = np.where(within_reach[None, :], _derivative(light), -np.inf)
    # Of the clear rises the nearest is taken, not the steepest, which may be the edge of something else.
    peaks = (rise >= np.roll(rise, 1, axis=1)) & (rise >= np.roll(rise, -1, axis=1))
    clear = peaks & (rise >= CLEAREST * rise.max(axis=1)[:, None]) & within_reach[None, :]
    k = np.argmin(np.where(clear, np.abs(along)[None, :], np.inf), axis=1)
    k = np.clip(k, 1, len(along) - 2)
    rows = np.arange(len(light))
    before, at, after = (rise[rows, k + d] for d in (-1, 0, 1))
    with np.errstate(invalid="ignore", divide="ignore"):
        shift = 0.5 * (before - after) / (before - 2 * at + after)
        contrast = at / np.median(at[np.isfinite(at) & (at > 0)]) if len(at) else at
    beside = round(BESIDE_PX / STEP_PX)
    inner, outer = light[rows, np.maximum(k - beside, 0)], light[rows, np.minimum(k + beside, len(along) - 1)]
    good = np.isfinite(shift) & (np.abs(shift) <= 1) & (contrast > MIN_CONTRAST)
    good &= np.abs(outer - inner) > MIN_MICHELSON * (np.abs(outer) + np.abs(inner))
    distance_px = along[k] + STEP_PX * np.where(good, shift, 0.0)
    return replace(expected, pixels=expected.pixels + distance_px[:, None] * expected.outwards), good


def _derivative(light: Array) -> Array:
    """Return the derivative along the last axis of the values smoothed by a Gaussian."""
    half = int(np.ceil(3 * SMOOTH_PX / STEP_PX))
    s = STEP_PX * np.arange(-half, half + 1)
    bell = np.exp(-0.5 * (s / SMOOTH_PX) ** 2)
    kernel = -s * bell / (SMOOTH_PX**2 * bell.sum())
    padded = np.pad(light, ((0, 0), (half, half)), mode="edge")
    # A convolution with -s is a correlation with s: bright outwards is positive.
    return np.stack([np.convolve(row, kernel, mode="valid") for row in padded]) if len(light) else light
