"""Annotates a job's frames in a Blender process of its own, and finishes what an earlier call left undone."""

import hashlib
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

from blender_scenes.annotations.job import AnnotationJob
from blender_scenes.frame_files import Ledger
from blender_scenes.protocol import Request
from blender_scenes.renderer import blender_files


def annotate_job(
    job_path: Path,
    folder: Path,
    *,
    threads: int = 1,
    numbers: Sequence[int] | None = None,
    on_frame: Callable[[int], None] | None = None,
) -> int:
    """Puts the files of the frames `numbers` of an annotation job (all by default) below `folder`.

    Their bytes depend on the job and the frame's number alone. Finished files are recorded in a file beside the folder,
    `<folder>.jsonl`; a frame whose files are all there and whole is not done again. `on_frame` hears of every frame in
    place. Returns how many frames this call did.

    Raises:
        EnvironmentLacking: bpy cannot be loaded, or the disk is full.
        RenderError: The Blender process failed.
        ValueError: The job is damaged or has no such frame.
    """
    text = job_path.read_bytes()
    job = AnnotationJob.from_json(text.decode())
    known = [view.number for view in job.frames]
    wanted = sorted(set(known if numbers is None else numbers))
    if unknown := sorted(set(wanted) - set(known)):
        raise ValueError(f"{job_path}: no frame {unknown[0]}; the job has {len(known)} frames")
    ledger = Ledger(folder, hashlib.sha256(text).hexdigest())
    whole = set(ledger.whole_files())
    left = {number: set(job.files(number)) - whole for number in wanted}
    missing = tuple(number for number in wanted if left[number])
    for kind in {Path(name).parent for number in missing for name in left[number]}:
        (folder / kind).mkdir(parents=True, exist_ok=True)
    for number in set(wanted) - set(missing):
        _tell(on_frame, number)
    if missing:
        with tempfile.TemporaryDirectory(prefix="symolo-", ignore_cleanup_errors=True) as scratch:
            request = Request("annotations", str(job_path), str(folder), missing, threads, scratch)
            for file in blender_files(request, job.camera.width_px * job.camera.height_px):
                ledger.add(file)
                left[file.number].discard(file.file)
                if not left[file.number]:
                    _tell(on_frame, file.number)
    return len(missing)


def _tell(on_frame: Callable[[int], None] | None, number: int) -> None:
    if on_frame is not None:
        on_frame(number)
