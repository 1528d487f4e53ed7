"""annotations.json of a run: the tables for its PNG files, and the record of each frame, in the style of COCO."""

from collections.abc import Iterable
from dataclasses import asdict, replace

from blender_scenes.annotations.job import AnnotationJob
from blender_scenes.annotations.record import FrameRecord, ObjectRecord
from symolo.dataset.annotations import (
    CATEGORIES,
    FORMAT,
    AnnotationDocument,
    AnnotationEntry,
    CategoryEntry,
    ImageEntry,
    InstanceEntry,
    encodings,
)
from symolo.dataset.layout import frame_name

_IDS_PER_IMAGE = 100_000


def annotation_entry(item: ObjectRecord) -> AnnotationEntry:
    """Return the entry of an instance that a frame's record holds."""
    number = _IDS_PER_IMAGE * item.image_id + item.instance_id
    entry = AnnotationEntry(number, item.image_id, item.category_id, item.instance_id, box_3d=item.box_3d)
    return entry if item.box_2d is None else replace(entry, **asdict(item.box_2d))


def document(job: AnnotationJob, images: str, records: Iterable[FrameRecord]) -> AnnotationDocument:
    """Return the document of a job from the records of its frames in order; `images` is the folder of the images."""
    frames = tuple(records)
    category_ids = job.instances.category_ids
    size = job.camera.width_px, job.camera.height_px
    return AnnotationDocument(
        format=FORMAT,
        kinds=job.kinds,
        encodings=encodings(job.kinds, job.camera),
        camera=job.camera,
        categories=tuple(CategoryEntry(i, name) for i, name in enumerate(CATEGORIES)),
        instances=tuple(
            InstanceEntry(one.id, one.name, int(category_ids[one.id]), one.moves) for one in job.instances.known
        ),
        key_points=job.key_points if "key_points" in job.kinds else (),
        images=tuple(
            ImageEntry(view.number, f"{images}/{frame_name(view.number)}", *size, view.t_s, view.X_WC)
            for view in job.frames
        ),
        annotations=tuple(annotation_entry(item) for frame in frames for item in frame.things),
        sightings=tuple(sighting for frame in frames for sighting in frame.key_points),
    )
