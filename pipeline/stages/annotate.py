"""Annotations of the images of every good run: a part of the second stage, with a folder of its own for each run."""

from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from blender_scenes.annotations.document import document
from blender_scenes.annotations.job import RECORDS_DIR, AnnotationJob, build_annotation_job, record_file
from blender_scenes.annotations.record import FrameRecord
from blender_scenes.render.job import RenderJob
from blender_scenes.render.job_file import job_path, read_job
from pipeline.run_folder.workspace import StageFolder, Workspace, mark_done
from pipeline.stages.render import IMAGES, JOB, Appearance, FrameJob, FrameTask, ImageFindings, journal
from pipeline.stages.rendering_facts import Rendered
from symolo.arena.geometry import Arena
from symolo.core.files.atomic_files import make_folder, write_file
from symolo.core.files.file_hashes import read_known, sha256_of
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.annotations import DOCUMENT
from symolo.dataset.layout import ANNOTATIONS


class AnnotationTask(FrameTask):
    """The annotations of the images of one run."""

    STAGE, FILES, WORK = "annotate", ANNOTATIONS, "annotations"

    @classmethod
    def from_images(cls, images: FrameTask, appearance: Appearance, folder: StageFolder) -> FrameJob:
        """Return the task with its job for the images that a task rendered; only its job is read."""
        arena = Arena.from_config(appearance.arena)
        rendered = RenderJob.from_json(read_job(job_path(images.folder.path)).decode())
        job = build_annotation_job(rendered, arena, appearance.render.annotations)
        return cls.frame_job(images.run, folder, job, images.frames, camera=images.camera)

    def names(self) -> list[str]:
        job = self._job()
        return [name for frame in self.frames for name in job.files(frame.number)]

    def finish(self, hashes: Mapping[str, str]) -> ImageFindings:
        job = self._job()
        names = [name for name in (record_file(frame.number) for frame in self.frames) if name in hashes]
        records = [FrameRecord.from_json(read_file(self.files / name, FileKind.JOB)) for name in names]
        write_file(self.files / DOCUMENT, document(job, IMAGES, records).to_json())
        texts = {name: sha256_of(self.folder.path / name) for name in (JOB, f"{ANNOTATIONS}/{DOCUMENT}")}
        files = {f"{ANNOTATIONS}/{name}": digest for name, digest in hashes.items()}
        mark_done(self.folder.path, self.key, {**texts, **files})
        return ImageFindings()

    def _job(self) -> AnnotationJob:
        return AnnotationJob.from_json(read_job(job_path(self.folder.path)).decode())


def copy_released(annotated: StageFolder, run: Path) -> dict[str, str]:
    """Copy the released annotations of a run or a camera into its folder, and return their SHA-256 by path."""
    copied = released_annotations(annotated.files())
    for name, digest in copied.items():
        make_folder((run / name).parent)
        write_file(run / name, read_known(annotated.path / name, digest))
    return copied


def released_annotations(files: Mapping[str, str]) -> dict[str, str]:
    """Return the annotations among the files of a stage, with their SHA-256 by path.

    The records are part of the document.
    """
    return {
        name: digest
        for name, digest in sorted(files.items())
        if name.startswith(f"{ANNOTATIONS}/") and PurePosixPath(name).parent.name != RECORDS_DIR
    }


def processors(workspace: Workspace, run: str, annotated: Mapping[str, bool]) -> tuple[str, ...]:
    """Return the classes of the processors that made the images and annotations of a run, sorted.

    Args:
        workspace: Output folder.
        run: Name of the run.
        annotated: Whether there are annotations, by the name of the camera; that of data.csv has an empty name.
    """
    classes: set[str] = set()
    for camera, has_annotations in annotated.items():
        classes |= {*Rendered.read(workspace.render(run, camera).path).cpus}
        if has_annotations:
            classes |= {*journal(workspace.annotate(run, camera), ANNOTATIONS).processors()}
    return tuple(sorted(classes))
