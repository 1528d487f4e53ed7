"""The record of a frame: boxes and key points."""

from collections.abc import Iterator
from dataclasses import dataclass

from pydantic import TypeAdapter

from blender_scenes.annotations.boxes import Box2D, box_2d, box_3d, silhouette
from blender_scenes.annotations.key_points import key_points
from blender_scenes.annotations.visible_scene import VisibleScene
from symolo.dataset.annotations import Box3D, KeyPointSighting


@dataclass(frozen=True)
class ObjectRecord:
    """A wall or an obstacle that is partly in the field of view, hidden or not."""

    image_id: int
    instance_id: int
    category_id: int
    box_2d: Box2D | None
    box_3d: Box3D | None


@dataclass(frozen=True)
class FrameRecord:
    """All boxes and key points of one image, which are stored beside it until the dataset is assembled."""

    things: tuple[ObjectRecord, ...]
    """Walls and obstacles."""
    key_points: tuple[KeyPointSighting, ...]

    def to_json(self) -> bytes:
        return _RECORD.dump_json(self) + b"\n"

    @classmethod
    def from_json(cls, data: bytes) -> "FrameRecord":
        """Return the record that `to_json` wrote; raise ValueError for anything else."""
        return _RECORD.validate_json(data)


_RECORD = TypeAdapter(FrameRecord)


def record(seen: VisibleScene) -> FrameRecord:
    """Return the record of a frame with the kinds of annotation that the job names."""
    kinds = seen.job.kinds
    has_boxes = "boxes_2d" in kinds or "boxes_3d" in kinds
    return FrameRecord(
        things=tuple(_objects(seen)) if has_boxes else (),
        key_points=key_points(seen) if "key_points" in kinds else (),
    )


def _objects(seen: VisibleScene) -> Iterator[ObjectRecord]:
    kinds = seen.job.kinds
    for solid in seen.job.solids:
        whole = silhouette(seen, solid)
        if whole.any():
            yield ObjectRecord(
                image_id=seen.view.number,
                instance_id=solid.instance_id,
                category_id=int(seen.job.instances.category_ids[solid.instance_id]),
                box_2d=box_2d(seen, solid, whole) if "boxes_2d" in kinds else None,
                box_3d=box_3d(seen, solid) if "boxes_3d" in kinds else None,
            )
