"""Metering of the exposure: small images of a few frames of a run, their median luminance, and the gain of each frame.

With manual exposure there is no metering; `sensors.camera.response` computes its gain.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sensors.camera.colour import LUMINANCE
from sensors.camera.views import FrameView
from symolo.core.arrays import FloatImage
from symolo.core.geometry.pinhole import Intrinsics

_VIEWS = 5
_WIDTH_PX = 64
_BURNT_SHARE = 0.04
"""Largest share of a frame that automatic exposure makes brighter than white."""
_DARKEST = 1e-3
"""Minimum brightness of a frame, relative to the run, to which the exposure adapts."""


def metered_views(frames: Sequence[FrameView]) -> tuple[FrameView, ...]:
    """Return views that are spread over all frames of a run, without an exposure time."""
    chosen = np.unique(np.linspace(0, len(frames) - 1, _VIEWS).round().astype(int))
    return tuple(replace(frames[i], exposure=()) for i in chosen)


def metering_camera(camera: Intrinsics) -> Intrinsics:
    """Return a camera with the same field of view and few pixels."""
    height_px = max(1, round(_WIDTH_PX * camera.height_px / camera.width_px))
    x, y = _WIDTH_PX / camera.width_px, height_px / camera.height_px
    return replace(
        camera,
        width_px=_WIDTH_PX,
        height_px=height_px,
        fx_px=camera.fx_px * x,
        fy_px=camera.fy_px * y,
        cx_px=(camera.cx_px + 0.5) * x - 0.5,
        cy_px=(camera.cy_px + 0.5) * y - 0.5,
    )


def median_luminance(light: FloatImage) -> float:
    """Return the metered value of linear light (..., 3).

    Raises:
        ValueError: No light reaches what the camera sees.
    """
    median = _median_luminance(light)
    if not median > 0:
        raise ValueError("the image is black: no light reaches what the camera sees; give the look a lamp or a sky")
    return median


def _median_luminance(light: FloatImage) -> float:
    return float(np.median(light @ LUMINANCE.astype(np.float32)))


def automatic_gain(light: FloatImage, metered: float, brightness: float, adaption: float) -> float:
    """Return the gain of automatic exposure for the light (..., 3) of a frame.

    Args:
        light: Linear light of the pixels that the exposure depends on.
        metered: Median luminance of the run.
        brightness: Linear pixel value of the median luminance.
        adaption: Share of the frame, and not of the run, in the metered median, 0 to 1.
    """
    frame_median = max(_median_luminance(light), _DARKEST * metered)
    # The mean is geometric, because exposures are ratios. The gain is then limited, so that few pixels are overexposed.
    median = metered ** (1 - adaption) * frame_median**adaption
    highlights = float(np.quantile(light @ LUMINANCE.astype(np.float32), 1 - _BURNT_SHARE))
    return min(brightness / median, 1.0 / highlights if highlights > 0 else np.inf)
