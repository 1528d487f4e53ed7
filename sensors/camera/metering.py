"""Metering of the exposure of a run with small images of a few of its frames."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sensors.camera.views import FrameView
from symolo.core.geometry.pinhole import Intrinsics

_VIEWS = 5
_WIDTH_PX = 64


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
