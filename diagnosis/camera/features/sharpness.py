"""Sharpness of the line's edges, compared with the simulated images of the same places.

An edge that a lens and a moving camera blur is a normal distribution function in light: the variances of the lens'
point spread, of the pixel, and of the motion across the edge during the exposure add up. The tone curve and an unsharp
mask follow. The blur of the pixel and of the renderer's filter is fitted to the simulated images first, so that only
differences count. The line is a bar with two edges, and the profile of a narrow line contains both.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.special import ndtr

from diagnosis.camera.case import Ints
from diagnosis.camera.features.edge_points import STEP_PX, EdgeProfiles
from diagnosis.camera.model import CameraModel, CameraParameter
from diagnosis.measured.channel import Mask
from sensors.camera.response import CameraResponse, tone
from symolo.core.arrays import Array

REACH_PX = 5.0
"""Length of a profile to either side of the edge."""
MIN_PX2 = 0.02
"""Smallest variance of an edge: none is sharper than its pixels."""
OUTER = 12.0
"""Distance [px] to either side over which the unsharp mask is computed."""
MIN_WIDTH_PX = 5.0
"""Smallest width of a line whose edges can be distinguished when they are blurred."""
SHIFT_SD_PX = 0.2
"""Standard deviation of the measured place of the edges of an image."""


@dataclass(frozen=True)
class SharpnessModel(CameraModel):
    """Profiles across edges; a sample is one value of one profile, relative to the level and height of its edge."""

    name = "sharpness"
    unit = "of the edge's height"
    min_sd = 0.03
    parameters = (
        CameraParameter(
            "lens_blur", "px", 0.08, "the lens blurs a point to this standard deviation", "a lens out of focus"
        ),
        CameraParameter(
            "exposure_time", "s", 2.5e-5, "the shutter is open for this time", "less light, another setting"
        ),
        CameraParameter("sharpening", "1", 0.06, "an unsharp mask adds more", "another picture style"),
    )
    """The tolerances of blur and time are of their squares."""

    frame_of_edge: Ints
    """(N,), index of the image."""
    profiles: EdgeProfiles
    """Grey values from 0 to 1 around the edges."""
    width_px: Array
    """(N,), width of the line."""
    speed_px_s: Array
    """(N,), speed of the image across the edge."""
    levels: tuple[float, float]
    """Typical light of the floor and of the line."""
    response: CameraResponse
    exposure_s: float
    base_px2: float = 0.25
    """Variance of pixel and filter, and of the nominal lens."""

    @cached_property
    def _inside(self) -> Mask:
        """Return the samples that only the line's two edges affect, (N, K)."""
        s = self.profiles.along_px[None, :]
        return (np.abs(s) <= REACH_PX) & (s >= -0.5 * self.width_px[:, None])

    @property
    def frame(self) -> Ints:
        return np.repeat(self.frame_of_edge, len(self.profiles.along_px))

    def residuals(self, x: Array) -> Array:
        expected = self._expected(x)
        w, measured = self._inside.astype(np.float64), self.profiles.light
        count = w.sum(axis=1)
        mean_t, mean_m = (w * expected).sum(axis=1) / count, (w * measured).sum(axis=1) / count
        t, m = expected - mean_t[:, None], measured - mean_m[:, None]
        height = (w * t * m).sum(axis=1) / np.maximum((w * t * t).sum(axis=1), 1e-12)
        # Relative to the edge's height, so that bright and dark images count alike.
        residuals = (m - height[:, None] * t) / np.maximum(np.abs(height[:, None]), 1e-3)
        return np.where(self._inside, residuals, np.nan).ravel()

    def frame_slopes(self, x: Array) -> Array:
        """Return the change by a shift of all edges of an image, because blur moves the measured place of an edge."""
        slope = np.gradient(self._expected(x), self.profiles.along_px, axis=1)
        return (SHIFT_SD_PX * slope).reshape(-1, 1)

    def _expected(self, x: Array) -> Array:
        blur, exposure, sharpening = (x * [p.tolerance for p in self.parameters]).tolist()
        variance = self.base_px2 + blur + (self.exposure_s**2 + exposure) * self.speed_px_s**2 / 12.0
        return self._template(np.sqrt(np.maximum(variance, MIN_PX2)), self.response.sharpening + sharpening)

    def _template(self, sd_px: Array, sharpening: float) -> Array:
        """Return values (N, K) across edges with these blurs (N,)."""
        step = STEP_PX * 2
        wide = np.arange(-OUTER, OUTER + step / 2, step)
        bar = ndtr((wide[None, :] + self.width_px[:, None]) / sd_px[:, None]) - ndtr(wide[None, :] / sd_px[:, None])
        floor, line = self.levels
        coded = np.asarray(tone((floor + (line - floor) * bar).astype(np.float32), self.response.contrast), np.float64)
        if sharpening:
            bell = np.exp(-0.5 * ((wide[:, None] - wide[None, :]) / self.response.sharpening_radius_px) ** 2)
            blurred = coded @ (bell / bell.sum(axis=0, keepdims=True))
            coded = coded + sharpening * (coded - blurred)
        along = self.profiles.along_px
        # Between pixels the image is linear, which spreads by 1/6 px2: three samples half a pixel apart.
        coded = (np.roll(coded, 1, axis=1) + coded + np.roll(coded, -1, axis=1)) / 3.0
        first = int(np.rint((along[0] - wide[0]) / step))
        return coded[:, first : first + len(along)]

    def based_on(self, simulated: "SharpnessModel", x: Array) -> "SharpnessModel":
        """Return the model with the blur of the simulated images, deviations x (P,), as the nominal one."""
        return replace(self, base_px2=max(simulated.base_px2 + float(x[0]) * self.parameters[0].tolerance, MIN_PX2))
