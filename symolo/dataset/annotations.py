"""Annotations of a run: kinds, files, encodings of their PNG images, and annotations.json, which is similar to COCO."""

import json
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter

from symolo.core.geometry.pinhole import Intrinsics
from symolo.core.geometry.poses import Matrix4

AnnotationName = Literal[
    "depth", "instance", "semantic", "normals", "flow", "free_floor", "boxes_2d", "boxes_3d", "key_points"
]
"""Kinds of annotations; `images.py`, `boxes.py` and `key_points.py` in blender_scenes/annotations/ compute them."""
RECORD_KINDS: tuple[AnnotationName, ...] = ("boxes_2d", "boxes_3d", "key_points")
"""Annotations that are in annotations.json; each of the others has a PNG file for each image."""
Category = Literal["sky", "floor", "line", "wall", "obstacle", "room", "robot"]
CATEGORIES: tuple[Category, ...] = get_args(Category)
"""Categories in the order of their ids. The sky is the space outside the windows, where there is no surface."""
DOCUMENT = "annotations.json"
FORMAT = 2
"""Version of annotations.json.

Raise it if a key is renamed or removed, if a value changes its meaning or unit, or if a text of ENCODINGS changes,
because `symolo verify` compares these texts. A new key that may be missing needs no new version, because readers ignore
keys that they do not know.
"""

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
_FISHEYE_DEPTH = "PNG, 16 bit grey: distance from the lens in 0.1 mm; 0: no surface within 6.5 m"


def encodings(kinds: Iterable[AnnotationName], camera: Intrinsics) -> dict[AnnotationName, str]:
    """Return the encoding of some kinds of annotations of a camera's images."""
    texts = ENCODINGS if camera.fisheye is None else {**ENCODINGS, "depth": _FISHEYE_DEPTH}
    return {kind: texts[kind] for kind in kinds}


DEPTH_UNIT_M = 1e-4
DEPTH_RANGE_M = 6.5
"""Farthest surface that an image of depths shows."""
NORMAL_ZERO = 2**15
NORMAL_SCALE = 2**15 - 1
FLOW_ZERO = 2**15
FLOW_PER_PX = 64
"""Steps of the flow per pixel, as in the KITTI flow benchmark (Menze and Geiger 2015, development kit)."""

PixelBox = tuple[int, int, int, int]
"""First column, first row, number of columns, number of rows, as in COCO; all 0 if the box is empty."""
Point2 = tuple[float, float]
Point3 = tuple[float, float, float]


def annotation_file(kind: str, number: int) -> str:
    """Return the path of an annotation's PNG file within the folder of a run's annotations."""
    return f"{kind}/{number:06d}.png"


def pixel_box(mask: NDArray[np.bool_]) -> PixelBox:
    """Return the box around the pixels of a mask (H, W) that are true."""
    columns, rows = np.flatnonzero(mask.any(axis=0)), np.flatnonzero(mask.any(axis=1))
    if not len(columns):
        return 0, 0, 0, 0
    x, y = int(columns[0]), int(rows[0])
    return x, y, int(columns[-1]) + 1 - x, int(rows[-1]) + 1 - y


@dataclass(frozen=True)
class Box3D:
    """A wall or an obstacle as a box in space."""

    size_m: Point3
    """Edge lengths along the axes of the box's frame O, whose origin is the middle of the box; z is up."""
    X_WO: Matrix4
    X_CO: Matrix4


@dataclass(frozen=True)
class KeyPoint:
    """A point of the map that can be recognised in every image."""

    id: int
    name: str
    """Name of the point, such as `line_2_07` or `A1_3`: corners 0-3 are at the foot, 4-7 above, counter-clockwise."""
    kind: str
    """`line`, `wall_corner` or `obstacle_corner`."""
    instance_id: int
    p: Point3
    """Position [m] in W; on an obstacle that moves, in its frame, whose origin is its middle on the floor."""


@dataclass(frozen=True)
class KeyPointSighting:
    """A key point that lies within an image."""

    image_id: int
    key_point_id: int
    pixel: Point2
    """u and v; (0, 0) is the middle of the first pixel."""
    p_C: Point3
    visible: bool
    """Whether nothing stands in front of the point."""


@dataclass(frozen=True)
class CategoryEntry:
    """A class of objects, such as walls."""

    id: int
    name: str


@dataclass(frozen=True)
class InstanceEntry:
    """One object of the run."""

    id: int
    name: str
    category_id: int
    moves: bool
    """Whether it moves during the run."""


@dataclass(frozen=True)
class ImageEntry:
    """One image of the run, with the time and the pose of its camera."""

    id: int
    file_name: str
    width: int
    height: int
    t_s: float
    """Time since the start of the run [s]."""
    X_WC: Matrix4
    """(4, 4), pose of the camera in W."""


@dataclass(frozen=True)
class AnnotationEntry:
    """One instance in one image; fields of kinds that the run does not have are left out."""

    id: int
    image_id: int
    category_id: int
    instance_id: int
    iscrowd: int = 0
    bbox: PixelBox | None = None
    area: int | None = None
    amodal_bbox: PixelBox | None = None
    amodal_area: int | None = None
    visible_fraction: float | None = None
    truncated: bool | None = None
    box_3d: Box3D | None = None


@dataclass(frozen=True)
class AnnotationDocument:
    """The content of annotations.json."""

    format: int
    kinds: tuple[AnnotationName, ...]
    encodings: dict[AnnotationName, str]
    camera: Intrinsics
    categories: tuple[CategoryEntry, ...]
    instances: tuple[InstanceEntry, ...]
    key_points: tuple[KeyPoint, ...]
    """Points of the map, whether or not an image shows them."""
    images: tuple[ImageEntry, ...]
    annotations: tuple[AnnotationEntry, ...]
    sightings: tuple[KeyPointSighting, ...]

    def to_json(self) -> bytes:
        return _DOCUMENT.dump_json(self, exclude_none=True) + b"\n"

    @classmethod
    def from_json(cls, data: bytes) -> "AnnotationDocument":
        """Return the document that `to_json` wrote; raise ValueError for any other content."""
        try:
            content = json.loads(data)
        except RecursionError:
            raise ValueError("is nested too deeply") from None
        version = content.get("format") if isinstance(content, dict) else None
        if version != FORMAT:
            raise ValueError(f"has format {version}, expected {FORMAT}; annotate again with this version")
        return _DOCUMENT.validate_json(data)


_DOCUMENT = TypeAdapter(AnnotationDocument)
