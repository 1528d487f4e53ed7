"""Facts about the rendering of a run for metadata.json, and a warning where its errors are large."""

import json
from dataclasses import dataclass
from pathlib import Path

from blender_scenes.render.probe import read_decision
from blender_scenes.render.sampling import TracingSettings
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.documents.rendering_record import LightPathsRecord, RenderingRecord

FRAMES = "frames.json"


def rendering_facts(
    sampling: TracingSettings, images: Path, job_sha256: str
) -> tuple[RenderingRecord, tuple[str, ...]]:
    """Return the record of the images in a folder, and warnings for users of the images.

    Args:
        sampling: Settings of the job.
        images: Folder of the images, beside which the renderer has left its choice where the job leaves it open.
        job_sha256: SHA-256 of the job.
    """
    decision = read_decision(images, job_sha256)
    chosen = decision.applied(sampling) if decision else sampling
    error = decision.errors.record() if decision else None
    record = RenderingRecord(
        method="hybrid" if chosen.hybrid else "full",
        samples=None if chosen.hybrid else chosen.samples,
        light_paths=LightPathsRecord.model_validate(chosen.paths),
        error=error,
    )
    if decision is None or error is None or decision.errors.excess <= 1:
        return record, ()
    text = (
        f"some images may have larger errors than JPEG adds, by an estimate (PSNR {error.psnr_db:.1f} dB; JPEG"
        f" {error.jpeg_psnr_db:.1f} dB; one image of twenty may be {decision.errors.limit_dB:.1f} dB worse than JPEG):"
        " render.quality=high makes them more exact"
    )
    return record, (text,)


@dataclass(frozen=True)
class Rendered:
    """Facts about all images of a finished folder of this stage."""

    device: str
    """Device that rendered them, as Cycles names it."""
    rendering: RenderingRecord
    warnings: tuple[str, ...]
    """Warnings about their exposure."""
    cpus: tuple[str, ...]
    """Classes of the processors; empty where they were not noted."""

    @classmethod
    def read(cls, folder: Path) -> "Rendered":
        document = json.loads(read_file(folder / FRAMES, FileKind.JOB))
        cpu = document.get("cpu", [])
        return cls(
            document["device"],
            RenderingRecord.model_validate(document["rendering"]),
            tuple(document["warnings"]),
            (cpu,) if isinstance(cpu, str) else tuple(cpu),
        )
