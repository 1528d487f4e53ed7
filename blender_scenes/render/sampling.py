"""Samples and denoiser of each quality of rendering; docs/rendering.md compares their times and errors."""

import math
from dataclasses import dataclass, replace
from typing import Annotated

from pydantic import Field

from blender_scenes.render.devices import DeviceKind
from blender_scenes.render.light_paths import LIGHT_PATHS, LightPathLimits, light_path_limits
from configs.schema.robot import Camera
from configs.schema.scenario import Render, RenderQuality


@dataclass(frozen=True)
class HybridSamples:
    """Samples of hybrid rendering (`blender_side/hybrid/images.py`)."""

    near: int
    """Light paths per pixel of the light image of the whole view, which has a few thousand pixels."""
    far: int
    """Light paths per pixel of the finer light image of the upper rows, where the floor is far."""
    surfaces: int
    """Camera rays per pixel of the image of the surfaces."""


def _is_full(hybrid: HybridSamples | None) -> bool:
    return hybrid is None


def _is_fixed(probe: bool) -> bool:  # noqa: FBT001 - pydantic calls it
    return not probe


@dataclass(frozen=True)
class TracingSettings:
    """Settings of the path tracer; none is left to Blender's defaults."""

    seed: int
    samples: int
    denoise: bool
    prefilter: str = "FAST"
    """Prefilter of the denoiser's guides."""
    denoise_quality: str = "BALANCED"
    paths: LightPathLimits = LIGHT_PATHS["standard"]
    filter_width_px: float = 1.5
    device: DeviceKind = "CPU"
    hybrid: Annotated[HybridSamples | None, Field(exclude_if=_is_full)] = None
    """Samples of hybrid rendering, in place of `samples` and the denoiser's settings; None for full rendering."""
    probe: Annotated[bool, Field(exclude_if=_is_fixed)] = False
    """Whether the renderer chooses method, samples and denoiser itself (`blender_scenes.render.probe`); hybrid
    rendering is a candidate if `hybrid` has samples."""


@dataclass(frozen=True)
class QualitySettings:
    """Settings of Cycles for one value of `render.quality`."""

    samples: int
    """Light paths per pixel of an image of 640 x 480."""
    prefilter: str
    """Cycles' prefilter of the denoiser's guides: ACCURATE denoises them first, which takes the time of two samples."""
    denoise_quality: str
    """HIGH differs from BALANCED only with ACCURATE guides, for which Open Image Denoise has larger weights."""


QUALITIES: dict[RenderQuality, QualitySettings] = {
    "draft": QualitySettings(1, "FAST", "FAST"),
    "standard": QualitySettings(4, "FAST", "BALANCED"),
    "high": QualitySettings(48, "ACCURATE", "HIGH"),
    "reference": QualitySettings(2048, "ACCURATE", "HIGH"),
}

HYBRID_QUALITIES: dict[RenderQuality, HybridSamples] = {
    "draft": HybridSamples(1, 1, 2),
    "standard": HybridSamples(4, 2, 4),
}
"""Samples of `render.method: hybrid` at 640 x 480; its maps are not accurate enough for the other qualities."""
_HYBRID_WIDTH_PX = 320
"""Width from which on hybrid rendering is a candidate; it saves little in smaller images."""
MIN_PROBED_IMAGES, MIN_HYBRID_IMAGES = 50, 100
"""Numbers of images from which on a run pays for the measurement of errors, and for the maps of hybrid rendering."""
MIN_PROBED_PIXELS = MIN_PROBED_IMAGES * 320 * 240
"""Number of pixels of all images of a run from which on it pays: where images are small, starting Blender and building
the scene are most of the cost, and fewer pixels make the measurement less exact."""

_SIZE_PX = 640 * 480
_MAX_TIMES = 2.0


def tracing_settings(render: Render, seed: int, device: DeviceKind = "CPU", images: int = 1) -> TracingSettings:
    """Return the settings of a run of so many images; `render.samples` overrides the samples of its quality and size.

    With `render.method: auto`, the renderer chooses the samples of a long run itself; those that are returned are for
    runs for which it does not. A run that chooses follows all light: what is left out is an error that no number of
    samples makes smaller, and in images of plain walls it can be larger than that of JPEG.
    """
    quality = QUALITIES[render.quality]
    probe = _is_probed(render, images)
    is_complete = probe or render.quality == "reference"
    is_candidate = probe and device == "CPU" and render.width_px >= _HYBRID_WIDTH_PX and images >= MIN_HYBRID_IMAGES
    return TracingSettings(
        seed=seed,
        samples=_samples(render) if render.samples is None else render.samples,
        denoise=render.denoise,
        prefilter=quality.prefilter,
        denoise_quality=quality.denoise_quality,
        paths=light_path_limits(render.light_paths, "complete" if is_complete else "standard"),
        device=device,
        hybrid=hybrid_samples(render) if is_candidate or render.method == "hybrid" else None,
        probe=probe,
    )


def rendering_of(render: Render, camera: Camera) -> Render:
    """Return the rendering of a camera: full through a fisheye lens, since hybrid rendering makes pinhole images."""
    return render if camera.fisheye is None else render.model_copy(update={"method": "full"})


def _is_probed(render: Render, images: int) -> bool:
    by_quality = render.quality == "standard" and render.samples is None and render.denoise
    is_long = images >= MIN_PROBED_IMAGES and images * render.width_px * render.height_px >= MIN_PROBED_PIXELS
    return render.method == "auto" and by_quality and is_long


def _samples(render: Render) -> int:
    """Return the samples of full rendering. Small images take more: the denoiser has fewer pixels and finer texture.

    Four times the pixels were worth twice the samples between 320 x 240 and 640 x 480; this is not extrapolated.
    """
    samples = QUALITIES[render.quality].samples
    return samples if render.quality == "reference" else _for_size(samples, render)


def hybrid_samples(render: Render) -> HybridSamples:
    """Return the samples of hybrid rendering; only those of the surfaces depend on the image's size."""
    samples = HYBRID_QUALITIES[render.quality]
    return replace(samples, surfaces=_for_size(samples.surfaces, render))


def _for_size(samples: int, render: Render) -> int:
    times = math.sqrt(_SIZE_PX / (render.width_px * render.height_px))
    return math.ceil(samples * min(max(times, 1.0), _MAX_TIMES))
