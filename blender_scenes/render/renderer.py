"""Renders or annotates a job's frames in a Blender process of its own; finishes what an earlier call left undone."""

import contextlib
import hashlib
import os
import queue
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO

from pydantic import ValidationError

from blender_scenes.annotations.job import AnnotationJob
from blender_scenes.render.frame_files import FrameFile, Ledger
from blender_scenes.render.job import RenderJob
from blender_scenes.render.protocol import (
    MESSAGE,
    REQUEST,
    Alive,
    Failed,
    Finished,
    FrameBegun,
    FrameDone,
    Message,
    Request,
    Work,
)
from blender_scenes.render.surroundings import SYSTEM_PACKAGES, without_blender_settings
from symolo.core.atomic_files import make_folder
from symolo.core.errors import EnvironmentLacking

_JOBS: dict[Work, type[RenderJob] | type[AnnotationJob]] = {"pictures": RenderJob, "annotations": AnnotationJob}
_CURES = {
    "libraries": f"run `apt-get install -y {SYSTEM_PACKAGES}`",
    "device": "render on the machine that has it, or give --device cpu",
}
_LOG_LINES = 15
_SILENCE_S = 120.0
"""Without a sign of life, of which Blender's side gives one every few seconds."""
_PATIENCE_S = 300.0
"""For what comes before the first frame, and for a frame besides its samples."""
_PATIENCE_PER_SAMPLE_S = 2e-4
"""For each camera sample: two hundred times what one takes."""


class RenderError(RuntimeError):
    """The Blender process died, fell silent or gave up; the text ends with the last lines of its log."""


@dataclass(frozen=True)
class FrameSet:
    """What was asked for of a job, in order of the frames' numbers."""

    files: tuple[FrameFile, ...]
    made: int
    """Of how many frames this call made files; those of the others were there and whole."""


def render_job(
    job_path: Path,
    folder: Path,
    *,
    work: Work = "pictures",
    threads: int = 1,
    numbers: Sequence[int] | None = None,
    on_frame: Callable[[int], None] | None = None,
    on_begin: Callable[[int], None] | None = None,
    own_files: Path | None = None,
    cpu: str = "",
) -> FrameSet:
    """Puts the files of the frames `numbers` of a job (all by default) below `folder`: pictures, or annotations.

    Their bytes depend on the job and the frame's number alone. Finished files are recorded in a journal beside the
    folder, `<folder>.jsonl`; a frame whose files are all there and whole is not done again. `on_frame` hears of every
    frame in place, `on_begin` of each that is begun. `own_files` is the folder that holds the user's own files by their
    SHA-256, for a job that shows some. `cpu` is the class of this machine's processor, for the journal.

    Raises:
        EnvironmentLacking: bpy cannot be loaded, the disk is full or refuses, or the job's graphics card is not there.
        RenderError: The Blender process failed.
        ValueError: The job is damaged or has no such frame.
    """
    text = job_path.read_bytes()
    job = _JOBS[work].from_json(text.decode())
    known = [view.number for view in job.frames]
    wanted = sorted(set(known if numbers is None else numbers))
    if unknown := sorted(set(wanted) - set(known)):
        raise ValueError(f"{job_path}: no frame {unknown[0]}; the job has {len(known)} frames")
    ledger = Ledger(folder, hashlib.sha256(text).hexdigest())
    whole = ledger.whole_files()
    files = {number: job.files(number) for number in wanted}
    left = {number: set(files[number]) - whole.keys() for number in wanted}
    missing = tuple(number for number in wanted if left[number])
    tell = on_frame or (lambda _number: None)
    for place in {(folder / name).parent for number in missing for name in left[number]}:
        make_folder(place)
    for number in wanted:
        if not left[number]:
            tell(number)
    if missing:
        with tempfile.TemporaryDirectory(prefix="symolo-", ignore_cleanup_errors=True) as scratch:
            own = str(own_files or "")
            request = Request(work, str(job_path), str(folder), missing, threads, scratch, own)
            pixels = job.camera.width_px * job.camera.height_px
            for file in _blender_files(request, pixels * job.sampling.samples, on_begin or (lambda _number: None)):
                ledger.add(replace(file, cpu=cpu))
                whole[file.file] = file
                left[file.number].discard(file.file)
                if not left[file.number]:
                    tell(file.number)
    return FrameSet(tuple(whole[name] for number in wanted for name in files[number]), made=len(missing))


def seed_of(job_path: Path, work: Work) -> int:
    """The seed from which each of a job's frames draws its noise, by its number."""
    return _JOBS[work].from_json(job_path.read_text(encoding="utf-8")).sampling.seed


def _blender_files(request: Request, camera_samples: int, on_begin: Callable[[int], None]) -> Iterator[FrameFile]:
    """Finished files of a child process as they come; the child never outlives the iteration.

    `camera_samples` of a frame decide how long it may take.
    """
    patience_s = _PATIENCE_S + _PATIENCE_PER_SAMPLE_S * camera_samples
    with tempfile.TemporaryFile() as log:
        command = [sys.executable, "-X", "faulthandler", "-m", "blender_scenes.blender_side"]
        environment = {**without_blender_settings(os.environ), "TMPDIR": request.scratch_dir}
        child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log, env=environment)
        try:
            for message in _converse(child, request, patience_s, log):
                if isinstance(message, FrameBegun):
                    on_begin(message.number)
                else:
                    yield message.frame
        finally:
            child.kill()
            child.wait()
            for pipe in (child.stdin, child.stdout):
                if pipe is not None:
                    with contextlib.suppress(BrokenPipeError):  # of what a child that died at once did not take
                        pipe.close()


def _converse(
    child: subprocess.Popen[bytes], request: Request, patience_s: float, log: IO[bytes]
) -> Iterator[FrameBegun | FrameDone]:
    lines: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    if child.stdin is None or child.stdout is None:
        raise RenderError("the Blender process has no pipes")
    threading.Thread(target=_pass_lines_on, args=(child.stdout, lines), daemon=True).start()
    with contextlib.suppress(BrokenPipeError):  # a child that is dead already is noticed when it is listened to
        child.stdin.write(REQUEST.dump_json(request) + b"\n")
        child.stdin.flush()
    moved_s = time.monotonic()
    while True:
        line = _next_line(lines, moved_s + patience_s - time.monotonic(), patience_s, log)
        if not line:
            raise RenderError(f"the Blender process ended with status {child.wait()} before its work did{_tail(log)}")
        message = _message(line, log)
        if not isinstance(message, Alive):
            moved_s = time.monotonic()
        if isinstance(message, FrameBegun | FrameDone):
            yield message
        elif isinstance(message, Failed):
            raise _failure(message, log)
        elif isinstance(message, Finished):
            return


def _next_line(lines: "queue.SimpleQueue[bytes]", left_s: float, patience_s: float, log: IO[bytes]) -> bytes:
    try:
        return lines.get(timeout=max(0.0, min(left_s, _SILENCE_S)))
    except queue.Empty:
        if left_s <= _SILENCE_S:
            raise RenderError(f"Blender got no further in {patience_s:.0f} s{_tail(log)}") from None
        raise RenderError(f"Blender gave no sign of life for {_SILENCE_S:.0f} s{_tail(log)}") from None


def _failure(message: Failed, log: IO[bytes]) -> Exception:
    if not message.lacking:
        return RenderError(f"{message.message}{_tail(log)}")
    cure = _CURES.get(message.lacking)
    return EnvironmentLacking(f"{message.message}; {cure}" if cure else message.message)


def _pass_lines_on(pipe: IO[bytes], lines: "queue.SimpleQueue[bytes]") -> None:
    """Feeds the child's messages to the queue, and an empty one at its end."""
    with contextlib.suppress(ValueError):  # the pipe is closed under us once the child is killed
        for line in pipe:
            lines.put(line)
    lines.put(b"")


def _message(line: bytes, log: IO[bytes]) -> Message:
    try:
        return MESSAGE.validate_json(line)
    except ValidationError:
        raise RenderError(f"the Blender process said {line[:200]!r}, which is no message{_tail(log)}") from None


def _tail(log: IO[bytes]) -> str:
    """The log's last lines, indented, to stand at the end of an error."""
    log.seek(0)
    lines = log.read().decode(errors="replace").splitlines()[-_LOG_LINES:]
    return "; the last lines of its log:\n" + "\n".join(f"  {line}" for line in lines) if lines else ""
