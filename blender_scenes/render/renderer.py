"""Render or annotate a job's frames in a Blender process; a later call makes only the files that are missing."""

import hashlib
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from blender_scenes.annotations.job import AnnotationJob
from blender_scenes.render.frame_files import FrameFile, Ledger
from blender_scenes.render.job import RenderJob
from blender_scenes.render.job_file import read_job
from blender_scenes.render.probe import LADDER, is_decided
from blender_scenes.render.protocol import MESSAGES, FrameBegun, FrameDone, RenderRequest, Work
from blender_scenes.render.surroundings import without_blender_settings
from symolo.core.child_process import SCRATCH, ChildProcess, Failed
from symolo.core.errors import EnvironmentLacking
from symolo.core.files.atomic_files import make_folder
from symolo.core.files.scratch_folders import scratch_folder

_JOBS: dict[Work, type[RenderJob] | type[AnnotationJob]] = {"images": RenderJob, "annotations": AnnotationJob}
_LOG_LINES = 15
_PATIENCE_S = 300.0
"""Maximum time until the first frame begins, and for a frame besides its samples."""
_START_ON_A_CARD_S = 3600.0
"""Maximum time until the first frame begins on a graphics card. Where Blender brings no kernels for a card, its driver
compiles them once: more than 300 s were measured (H200, driver 580). If the driver is interrupted, it
later begins from the start."""
_PATIENCE_PER_SAMPLE_S = 2e-4
"""Maximum time for each camera sample: two hundred times what one usually takes."""


class RenderError(RuntimeError):
    """The Blender process died, was silent for too long, or failed; the text ends with the last lines of its log."""


@dataclass(frozen=True)
class FrameSet:
    """The files of some frames of a job, in order of the frames' numbers."""

    files: tuple[FrameFile, ...]
    made: int
    """Number of frames for which this call made files; those of the others were there and undamaged."""


def render_job(
    job_path: Path,
    folder: Path,
    *,
    work: Work = "images",
    threads: int = 1,
    numbers: Sequence[int] | None = None,
    on_frame: Callable[[int], None] | None = None,
    on_begin: Callable[[int], None] | None = None,
    user_files: Path | None = None,
    cpu: str = "",
) -> FrameSet:
    """Put the files of a job's frames below `folder`: images, or annotations.

    Their bytes depend on the job and the frame's number alone. Finished files are recorded in a journal beside the
    folder, `<folder>.jsonl`; a frame whose files are all there and undamaged is not rendered again.

    Args:
        job_path: File of the job.
        folder: Folder of the files.
        work: What the job makes.
        threads: Number of threads of Blender.
        numbers: Numbers of the frames; None for all.
        on_frame: Called with the number of each frame whose files are all in place.
        on_begin: Called with the number of each frame that is begun.
        user_files: Folder of the user's files by their SHA-256, for a job that shows some.
        cpu: Class of this machine's processor, for the journal.

    Raises:
        EnvironmentLacking: bpy cannot be loaded, the disk is full or refuses, or the job's graphics card is not there.
        RenderError: The Blender process failed.
        ValueError: The job is damaged or has no such frame.
    """
    text = read_job(job_path)
    job = _JOBS[work].from_json(text.decode())
    known = [view.number for view in job.frames]
    requested = sorted(set(known if numbers is None else numbers))
    if unknown := sorted(set(requested) - set(known)):
        raise ValueError(f"{job_path}: no frame {unknown[0]}; the job has {len(known)} frames")
    job_sha256 = hashlib.sha256(text).hexdigest()
    ledger = Ledger(folder, job_sha256)
    # Images whose settings nobody knows any more are made again.
    whole = ledger.whole_files() if is_decided(job.sampling, folder, job_sha256) else {}
    files = {number: job.files(number) for number in requested}
    left = {number: set(files[number]) - whole.keys() for number in requested}
    missing = tuple(number for number in requested if left[number])
    report = on_frame or (lambda _number: None)
    for place in {(folder / name).parent for number in missing for name in left[number]}:
        make_folder(place)
    for number in requested:
        if not left[number]:
            report(number)
    if missing:
        request = RenderRequest(
            work=work,
            job_path=str(job_path),
            folder=str(folder),
            numbers=missing,
            threads=threads,
            user_files=str(user_files or ""),
        )
        for file in _blender_files(request, job, on_begin or (lambda _number: None)):
            ledger.add(replace(file, cpu=cpu))
            whole[file.file] = file
            left[file.number].discard(file.file)
            if not left[file.number]:
                report(file.number)
    return FrameSet(tuple(whole[name] for number in requested for name in files[number]), made=len(missing))


def seed_of(job_path: Path, work: Work) -> int:
    """Return the seed from which the frames of a job draw their noise, by their numbers."""
    return _JOBS[work].from_json(read_job(job_path).decode()).sampling.seed


def _blender_files(
    request: RenderRequest, job: RenderJob | AnnotationJob, on_begin: Callable[[int], None]
) -> Iterator[FrameFile]:
    """Yield the finished files of a Blender process, which ends with the iteration.

    It is also ended if it takes too long for a frame, or before the first one.
    """
    pixels = job.camera.width_px * job.camera.height_px
    samples = LADDER[-1].samples if job.sampling.probe else job.sampling.samples
    patience_s = _PATIENCE_S + _PATIENCE_PER_SAMPLE_S * pixels * samples
    start_s = 0.0 if job.sampling.device == "CPU" else _START_ON_A_CARD_S
    with scratch_folder() as scratch:
        command = [sys.executable, "-X", "faulthandler", "-m", "blender_scenes.blender_side"]
        environment = {**without_blender_settings(os.environ), "TMPDIR": str(scratch), SCRATCH: str(scratch)}
        blender = ChildProcess("Blender", command, MESSAGES, environment)
        try:
            for message in blender.ask(request, patience_s=patience_s, start_s=start_s):
                if isinstance(message, FrameBegun):
                    on_begin(message.number)
                elif isinstance(message, FrameDone):
                    yield message.frame
                elif isinstance(message, Failed):
                    if message.error == "environment":
                        raise EnvironmentLacking(message.text)
                    log = "".join(f"\n  {line}" for line in blender.last_lines(_LOG_LINES))
                    raise RenderError(f"{message.text}; the last lines of its log:{log}" if log else message.text)
        finally:
            blender.close()
