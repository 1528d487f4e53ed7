"""Beside the second stage: the annotations of every good run's images, in a folder apart from them."""

import hashlib
from dataclasses import dataclass
from pathlib import Path

from blender_scenes.annotations.document import DOCUMENT, document
from blender_scenes.annotations.job import RECORDS_DIR, AnnotationJob, build_annotation_job, record_file
from blender_scenes.annotations.record import Record
from blender_scenes.job import FramePose, RenderJob
from blender_scenes.protocol import Work
from physics.arena import Arena
from pipeline.dataset.annotation_checks import ANNOTATIONS
from pipeline.files import hashes_of, write_file
from pipeline.stages.render import IMAGES, INPUTS, Appearance, Findings, RenderTask
from pipeline.versions import versions
from pipeline.workspace import DONE, StageFolder, input_key, mark_done


@dataclass(frozen=True)
class AnnotationTask:
    """The annotations of one run's images."""

    run: str
    folder: StageFolder
    job_text: str
    frames: tuple[FramePose, ...]
    work: Work = "annotations"
    own_files: Path | None = None
    """None: no material plays a part."""

    @classmethod
    def of(cls, task: RenderTask, appearance: Appearance, folder: StageFolder) -> "AnnotationTask":
        """Of the images that a task renders; they are not looked at, and need not be there."""
        arena = Arena.from_config(appearance.arena)
        job = build_annotation_job(RenderJob.from_json(task.job_text), arena, appearance.render.annotations)
        return cls(task.run, folder, job.to_json(), task.frames)

    @property
    def key(self) -> str:
        digest = hashlib.sha256(self.job_text.encode()).hexdigest()
        return input_key("annotate", job=digest, versions=versions("symolo", "bpy", "numpy", "opencv-python-headless"))

    @property
    def files(self) -> Path:
        return self.folder.path / ANNOTATIONS

    def finish(self) -> Findings:
        job = AnnotationJob.from_json(self.job_text)
        names = [record_file(frame.number) for frame in self.frames]
        records = [Record.from_json((self.files / name).read_bytes()) for name in names if (self.files / name).exists()]
        write_file(self.files / DOCUMENT, document(job, IMAGES, records).to_json())
        left_out = (DONE, INPUTS, f"{ANNOTATIONS}.jsonl")
        mark_done(self.folder.path, self.key, hashes_of(self.folder.path, skip=left_out))
        return Findings()


def copy_released(annotated: StageFolder, run: Path) -> None:
    """Put the files of a run's annotations that are released below the run's folder; records are in the document."""
    root = annotated.path / ANNOTATIONS
    for path in sorted(path for path in root.rglob("*") if path.is_file() and path.parent.name != RECORDS_DIR):
        copy = run / ANNOTATIONS / path.relative_to(root)
        copy.parent.mkdir(parents=True, exist_ok=True)
        write_file(copy, path.read_bytes())
