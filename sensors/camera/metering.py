"""What a run's exposure is metered on: a few of its views, small."""

from dataclasses import replace

import numpy as np

from blender_scenes.render.job import RenderJob
from blender_scenes.scene.description import FrameView, Intrinsics

_VIEWS = 5
_WIDTH_PX = 64


def metered_views(job: RenderJob) -> tuple[FrameView, ...]:
    """Spread over the run, whichever frames are asked for, each of an instant."""
    chosen = np.unique(np.linspace(0, len(job.frames) - 1, _VIEWS).round().astype(int))
    return tuple(replace(job.frames[i], exposure=()) for i in chosen)


def metering_camera(camera: Intrinsics) -> Intrinsics:
    """The same field of view in few pixels."""
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
