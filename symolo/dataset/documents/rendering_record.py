"""Rendering of the images of a run, as metadata.json states it."""

from typing import Literal

from pydantic import Field

from symolo.core.progress import plural
from symolo.dataset.documents.record import Record


class LightPathsRecord(Record):
    """How far light was followed from surface to surface."""

    diffuse_bounces: int = Field(ge=0)
    """Maximum number of matt surfaces that a path of light meets after the first surface."""
    glossy_bounces: int = Field(ge=0)
    transmission_bounces: int = Field(ge=0)
    caustics: bool
    """Whether gloss and glass throw patches of light on matt surfaces."""
    clamp: float = Field(ge=0)
    """Maximum light of one path behind its first surface, in multiples of the light that the exposure renders white; 0
    for no limit."""

    @property
    def text(self) -> str:
        """Phrase for people."""
        bounces = max(self.diffuse_bounces, self.glossy_bounces, self.transmission_bounces)
        caustics = "with" if self.caustics else "without"
        limit = f"of one path limited to {self.clamp:g} times a white pixel" if self.clamp else "not limited"
        return f"up to {bounces} bounces, {caustics} caustics, reflected light {limit}"


class ImageErrorRecord(Record):
    """Error of the images, estimated on a few of them, against references without a denoiser."""

    views: int = Field(ge=1)
    """Number of images that were measured."""
    psnr_db: float
    """PSNR of these images [dB], without camera noise and JPEG."""
    jpeg_psnr_db: float
    """PSNR [dB] of JPEG for the same images with camera noise, the scale of `render.quality: standard`."""
    relative_limit_db: float | None = None
    """Error relative to that of JPEG [dB] that an image of the run exceeds with a probability of 5 %, by the estimate;
    None in releases that did not state it."""


class RenderingRecord(Record):
    """How the images of a run were rendered, and how large their error is."""

    method: Literal["full", "hybrid"]
    """Method of `render.method` that was used."""
    samples: int | None = Field(default=None, ge=1)
    """Light paths per pixel; None for hybrid rendering, which has several kinds."""
    light_paths: LightPathsRecord
    error: ImageErrorRecord | None = None
    """Estimated error of the images; None if it was not measured."""

    @property
    def text(self) -> str:
        """Phrase for people."""
        samples = "" if self.samples is None else f", {plural(self.samples, 'sample')} per pixel"
        parts = [f"{self.method}{samples}", self.light_paths.text]
        if self.error is None:
            parts.append("error not measured")
        else:
            parts.append(f"estimated PSNR {self.error.psnr_db:.1f} dB (JPEG: {self.error.jpeg_psnr_db:.1f} dB)")
        return "; ".join(parts)
