"""The qualities of pictures: samples and denoiser of each. docs/render_benchmarks.md has what they cost and miss."""

from dataclasses import dataclass

from blender_scenes.devices import DeviceKind
from configs.schema.scenario import Render, RenderQuality


@dataclass(frozen=True)
class Sampling:
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


@dataclass(frozen=True)
class Quality:
    samples: int
    """Light paths per pixel."""
    prefilter: str
    """Of the denoiser's guides, in Cycles' words: ACCURATE denoises them first, at the price of ten samples."""
    denoise_quality: str
    """HIGH differs from BALANCED only behind ACCURATE guides (Open Image Denoise has larger weights for clean ones)."""


QUALITIES: dict[RenderQuality, Quality] = {
    "draft": Quality(2, "FAST", "BALANCED"),
    "standard": Quality(4, "FAST", "BALANCED"),
    "high": Quality(48, "ACCURATE", "HIGH"),
    "reference": Quality(2048, "ACCURATE", "HIGH"),
}


def sampling(render: Render, seed: int, device: DeviceKind = "CPU") -> Sampling:
    """Of a run's settings: `render.samples` stands above those of its quality."""
    quality = QUALITIES[render.quality]
    return Sampling(
        seed=seed,
        samples=quality.samples if render.samples is None else render.samples,
        denoise=render.denoise,
        prefilter=quality.prefilter,
        denoise_quality=quality.denoise_quality,
        device=device,
    )
