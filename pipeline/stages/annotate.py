"""Beside the second stage: the annotations of every good run's images, in a folder apart from them."""

from pathlib import Path

from blender_scenes.annotations.document import DOCUMENT, document
from blender_scenes.annotations.job import RECORDS_DIR, AnnotationJob, build_annotation_job, record_file
from blender_scenes.annotations.record import Record
from blender_scenes.job import RenderJob
from physics.arena import Arena
from pipeline.dataset.annotation_checks import ANNOTATIONS
from pipeline.files import hashes_of, write_file
from pipeline.stages.render import IMAGES, INPUTS, JOB, Appearance, Findings, FrameTask, Order
from pipeline.workspace import DONE, StageFolder, mark_done


class AnnotationTask(FrameTask):
    """The annotations of one run's images."""

    STAGE, FILES, WORK = "annotate", ANNOTATIONS, "annotations"

    @classmethod
    def of(cls, pictures: FrameTask, appearance: Appearance, folder: StageFolder) -> Order:
        """Of the images that a task rendered; they are not looked at, its job is."""
        arena = Arena.from_config(appearance.arena)
        rendered = RenderJob.from_json((pictures.folder.path / JOB).read_text())
        job = build_annotation_job(rendered, arena, appearance.render.annotations)
        return cls.order(pictures.run, folder, job, pictures.frames)

    def finish(self) -> Findings:
        job = AnnotationJob.from_json((self.folder.path / JOB).read_text())
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
