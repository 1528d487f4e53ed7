"""annotations.json of a run: the tables that its PNG files refer to, and every record, in the manner of COCO."""

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace

from pydantic import TypeAdapter

from blender_scenes.annotations.boxes_2d import Rectangle
from blender_scenes.annotations.boxes_3d import Box3D
from blender_scenes.annotations.instances import CATEGORIES
from blender_scenes.annotations.job import AnnotationJob, KeyPoint
from blender_scenes.annotations.key_points import Sighting
from blender_scenes.annotations.record import Record, Thing
from configs.schema.scenario import AnnotationName
from symolo.core.pinhole import Intrinsics
from symolo.core.poses import Matrix4
from symolo.dataset.layout import frame_name

FORMAT = 2
DOCUMENT = "annotations.json"

ENCODINGS: dict[AnnotationName, str] = {
    "depth": "PNG, 16 bit grey: depth along the optical axis in 0.1 mm; 0: no surface within 6.5 m",
    "instance": "PNG, 16 bit grey: id of the instance; 0: no surface",
    "semantic": "PNG, 8 bit grey: id of the category",
    "normals": "PNG, 16 bit RGB: x, y, z of the unit normal in C as 32768 + 32767 n; 0, 0, 0: no surface",
    "flow": "PNG, 16 bit RGB: 32768 + 64 du, 32768 + 64 dv to the next image [px], 1 where valid (as KITTI)",
    "free_floor": "PNG, 8 bit grey: 255 where floor or line is seen",
    "boxes_2d": "annotations: bbox around what is seen, amodal_bbox around all within the picture; x, y, width, height",
    "boxes_3d": "annotations: box_3d, size [m] and poses X_WO, X_CO of a frame in its middle",
    "key_points": "sightings: pixel (u, v), (0, 0) the middle of the first pixel, and place in C [m]",
}


@dataclass(frozen=True)
class CategoryEntry:
    id: int
    name: str


@dataclass(frozen=True)
class InstanceEntry:
    id: int
    name: str
    category_id: int
    moves: bool


@dataclass(frozen=True)
class ImageEntry:
    id: int
    file_name: str
    width: int
    height: int
    t_s: float
    X_WC: Matrix4


@dataclass(frozen=True)
class AnnotationEntry:
    """One thing in one image; fields of kinds that were not asked for are left out."""

    id: int
    image_id: int
    category_id: int
    instance_id: int
    iscrowd: int = 0
    bbox: Rectangle | None = None
    area: int | None = None
    amodal_bbox: Rectangle | None = None
    amodal_area: int | None = None
    visible_fraction: float | None = None
    truncated: bool | None = None
    box_3d: Box3D | None = None

    @classmethod
    def of(cls, thing: Thing) -> "AnnotationEntry":
        number = _IDS_PER_IMAGE * thing.image_id + thing.instance_id
        bare = cls(number, thing.image_id, thing.category_id, thing.instance_id, box_3d=thing.box_3d)
        return bare if thing.box_2d is None else replace(bare, **asdict(thing.box_2d))


_IDS_PER_IMAGE = 100_000


@dataclass(frozen=True)
class Document:
    format: int
    kinds: tuple[AnnotationName, ...]
    encodings: dict[AnnotationName, str]
    camera: Intrinsics
    categories: tuple[CategoryEntry, ...]
    instances: tuple[InstanceEntry, ...]
    key_points: tuple[KeyPoint, ...]
    """Points of the map; `p` is in W, or in the obstacle's own frame where the instance moves."""
    images: tuple[ImageEntry, ...]
    annotations: tuple[AnnotationEntry, ...]
    sightings: tuple[Sighting, ...]

    def to_json(self) -> bytes:
        return _DOCUMENT.dump_json(self, exclude_none=True) + b"\n"

    @classmethod
    def from_json(cls, data: bytes) -> "Document":
        """What `to_json` wrote; raises ValueError for anything else."""
        content = json.loads(data)
        told = content.get("format") if isinstance(content, dict) else None
        if told != FORMAT:
            raise ValueError(f"format {told}, expected {FORMAT}; annotate again with this version")
        return _DOCUMENT.validate_json(data)


_DOCUMENT = TypeAdapter(Document)


def document(job: AnnotationJob, images: str, records: Iterable[Record]) -> Document:
    """The document of a job, with the records of its frames in their order; `images` is the folder of the images."""
    kept = tuple(records)
    category_ids = job.instances.category_ids
    size = job.camera.width_px, job.camera.height_px
    return Document(
        format=FORMAT,
        kinds=job.kinds,
        encodings={kind: ENCODINGS[kind] for kind in job.kinds},
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
        annotations=tuple(AnnotationEntry.of(thing) for one in kept for thing in one.things),
        sightings=tuple(sighting for one in kept for sighting in one.key_points),
    )
