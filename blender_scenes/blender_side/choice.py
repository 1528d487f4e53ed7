"""The tracer of a job, whose settings may be left to a measurement that all processes of a run share."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from blender_scenes.blender_side.engine import FrameTracer, metered_light
from blender_scenes.blender_side.measured_images import Probe
from blender_scenes.render.job import RenderJob
from blender_scenes.render.probe import PROBE, decide, read_decision, to_json
from sensors.camera.metering import median_luminance
from symolo.core.files.atomic_files import write_file


def tracer_for(  # noqa: PLR0917 - what a measurement takes
    job: RenderJob, job_sha256: str, images: Path, threads: int, scratch: Path, on_step: Callable[[], None]
) -> FrameTracer:
    """Return the tracer of a job whose scene is in Blender, after `engine.configure`.

    If the job leaves its settings open, they come from the file `PROBE` beside the images. If there is none, the errors
    are measured here, and the file is written, unless another process has written it meanwhile.

    Args:
        job: Job.
        job_sha256: SHA-256 of its text.
        images: Folder of the images.
        threads: Number of threads.
        scratch: Folder for temporary files.
        on_step: Called after each rendering of the measurement.
    """
    if not job.sampling.probe:
        return FrameTracer(job, threads, scratch)
    metered = median_luminance(metered_light(job))
    decision = read_decision(images, job_sha256)
    if decision is None:
        probe = Probe(job, threads, scratch, metered, on_step)
        measured = decide(job_sha256, job.sampling.hybrid, len(job.frames), probe.measure)
        decision = read_decision(images, job_sha256)
        if decision is None:
            write_file(images.with_name(PROBE), to_json(measured))
        if decision is None or decision == measured:
            return probe.tracer  # that of the candidate that was measured last, which is the one chosen
    return FrameTracer(replace(job, sampling=decision.applied(job.sampling)), threads, scratch, metered)
