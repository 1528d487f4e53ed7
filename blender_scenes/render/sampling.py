"""The qualities of pictures: samples and denoiser of each. docs/rendering.md has what they cost and miss."""

import math
from dataclasses import dataclass, replace
from typing import Annotated

from pydantic import Field

from blender_scenes.render.devices import DeviceKind
from configs.schema.scenario import Render, RenderQuality


@dataclass(frozen=True)
class HybridSamples:
    """Of a picture that is put together from its parts (`blender_side/hybrid/images.py`)."""

    near: int
    """Light paths per pixel of the picture of all light, which has a few thousand pixels."""
    far: int
    """Light paths per pixel of that of the upper rows, where the floor is far, which is finer; more of few rows."""
    surfaces: int
    """Camera rays per pixel for what the surfaces reflect."""


def _is_whole(parts: HybridSamples | None) -> bool:
    return parts is None


@dataclass(frozen=True)
class TracingSettings:
    """How the light is traced; nothing of it is left to Blender's defaults."""

    seed: int
    samples: int
    denoise: bool
    prefilter: str = "FAST"
    """Of the denoiser's guides."""
    denoise_quality: str = "BALANCED"
    diffuse_bounces: int = 3
    glossy_bounces: int = 3
    transmission_bounces: int = 6
    filter_width_px: float = 1.5
    device: DeviceKind = "CPU"
    hybrid: Annotated[HybridSamples | None, Field(exclude_if=_is_whole)] = None
    """None where a picture is traced whole; else `samples` and the denoiser's settings are not used."""


@dataclass(frozen=True)
class QualitySettings:
    samples: int
    """Light paths per pixel of a picture of 640 x 480."""
    prefilter: str
    """Of the denoiser's guides, in Cycles' words: ACCURATE denoises them first, at the price of two samples."""
    denoise_quality: str
    """HIGH differs from BALANCED only behind ACCURATE guides (Open Image Denoise has larger weights for clean ones)."""


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
"""Of `render.method: parts` at 640 x 480; the maps are not true enough for the others."""
_AUTO_WIDTH_PX = 320
"""Where parts begin to cost less than whole pictures of the same error; they have not been measured in smaller ones."""

_SIZE_PX = 640 * 480
_MAX_TIMES = 2.0


def tracing_settings(render: Render, seed: int, device: DeviceKind = "CPU") -> TracingSettings:
    """Of a run's settings: `render.samples` stands above those of its quality and size."""
    quality = QUALITIES[render.quality]
    return TracingSettings(
        seed=seed,
        samples=_samples(render) if render.samples is None else render.samples,
        denoise=render.denoise,
        prefilter=quality.prefilter,
        denoise_quality=quality.denoise_quality,
        device=device,
        hybrid=hybrid_samples(render) if _is_hybrid(render, device) else None,
    )


def _is_hybrid(render: Render, device: DeviceKind) -> bool:
    if render.method != "auto":
        return render.method == "hybrid"
    by_quality = render.quality == "standard" and render.samples is None and render.denoise
    return by_quality and device == "CPU" and render.width_px >= _AUTO_WIDTH_PX


def _samples(render: Render) -> int:
    """Small pictures take more: the denoiser has fewer pixels to go by, and texture is finer than they are.

    Four times the pixels were worth twice the samples between 320 x 240 and 640 x 480, which is not carried further.
    """
    samples = QUALITIES[render.quality].samples
    return samples if render.quality == "reference" else _of_size(samples, render)


def hybrid_samples(render: Render) -> HybridSamples:
    """Of a run's settings; only what the surfaces reflect is as fine as the picture."""
    own = HYBRID_QUALITIES[render.quality]
    return replace(own, surfaces=_of_size(own.surfaces, render))


def _of_size(samples: int, render: Render) -> int:
    times = math.sqrt(_SIZE_PX / (render.width_px * render.height_px))
    return math.ceil(samples * min(max(times, 1.0), _MAX_TIMES))
