"""The split of each run or image as a table beside the shards, and its record sets in Croissant 1.1.

A record set of the type `cr:Split` lists the splits. A second one is the table. The images refer to both, because the
path of an image contains its run but not its split.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from symolo.dataset.documents.splits_record import SplitName, SplitsRecord
from symolo.dataset.layout import IMAGES, frame_name

SPLITS = "splits"
_FOLDER = f"^(?:[^/]+/(?=[^/]+/[^/]+/{IMAGES}/))?"
"""Folder of the dataset in front of the path of an image; absent where a reader has applied an expression before."""
RUN_REGEX = f"{_FOLDER}([^/]+/[^/]+)"
"""Expression whose group is the run, in the path of an image in a shard, in that in the dataset, and in the run."""
_MEANINGS: Mapping[SplitName, str] = {
    "train": "cr:TrainingSplit",
    "validation": "cr:ValidationSplit",
    "test": "cr:TestSplit",
}


@dataclass(frozen=True)
class Membership:
    """The table with the split of each run, or of each image if the splits are by image."""

    name: str
    """Name of the table and of its record set."""
    key: str
    """Name of the column, and of a field of the images, that identifies a run or an image."""
    key_regex: str
    """Expression whose group is the key, both in the path of an image in a shard and in the key itself: readers apply
    it to both."""
    key_text: str
    """Description of the key."""
    names: tuple[SplitName, ...]
    """Names of the splits in their order."""
    split_of: Mapping[str, SplitName]
    """Split by key."""

    @classmethod
    def from_splits(cls, splits: SplitsRecord) -> "Membership":
        """Return the membership of runs, or for splits by image that of images."""
        if not splits.images:
            return cls("run_splits", "run", RUN_REGEX, "for example CW/test_1", splits.names, splits.split_by_run)
        regex = f"{_FOLDER}(.+)$"
        split_of: dict[str, SplitName] = {
            f"{run}/{IMAGES}/{frame_name(number)}": split for (run, number), split in splits.split_by_image.items()
        }
        return cls("image_splits", "path", regex, "path of the image in the dataset", splits.names, split_of)

    @property
    def file(self) -> str:
        return f"{self.name}.csv"

    @property
    def meaning(self) -> str:
        return "the split of each image" if self.key == "path" else "the split of each run"

    def csv(self) -> bytes:
        """Return the table; keys are names that need no quotes."""
        rows = [f"{key},{split}\n" for key, split in sorted(self.split_of.items())]
        return "".join((f"{self.key},split\n", *rows)).encode()

    def record_sets(self) -> list[dict[str, Any]]:
        """Return the record set of the splits, with its records, and that of the table."""
        name, url = f"{SPLITS}/name", f"{SPLITS}/url"
        splits = {
            "description": "Training, validation and test.",
            "dataType": "cr:Split",
            "key": {"@id": name},
            "field": [
                _field(name, "name of the split", "sc:Text"),
                # The specification has cr:Split alone, which mlcroissant 1.1.1 refuses.
                _field(url, "meaning of the split", ["sc:URL", "cr:Split"]),
            ],
            "data": [{name: one, url: _MEANINGS[one]} for one in self.names],
        }
        members = {
            "description": f"{self.meaning[0].upper()}{self.meaning[1:]}.",
            "key": {"@id": f"{self.name}/{self.key}"},
            "field": [
                _field(f"{self.name}/{column}", text, "sc:Text")
                | {"source": {"fileObject": {"@id": self.file}, "extract": {"column": column}}}
                for column, text in ((self.key, self.key_text), ("split", "name of the split"))
            ],
        }
        return [
            {"@type": "cr:RecordSet", "@id": one, "name": one, **content}
            for one, content in ((SPLITS, splits), (self.name, members))
        ]

    def fields_of_images(self, source: Mapping[str, Any]) -> list[dict[str, Any]]:
        """Return the fields with the key and the split of each image; `source` is that of the path of an image."""
        return [
            _field(f"{IMAGES}/{self.key}", self.key_text, "sc:Text")
            | {"source": {**source, "transform": {"regex": self.key_regex}}}
            | {"references": {"field": {"@id": f"{self.name}/{self.key}"}}},
            _field(f"{IMAGES}/split", "name of its split", "sc:Text")
            | {"source": {"field": {"@id": f"{self.name}/split"}}}
            | {"references": {"field": {"@id": f"{SPLITS}/name"}}},
        ]


def _field(place: str, text: str, kind: str | list[str]) -> dict[str, Any]:
    name = place.rpartition("/")[2]
    return {"@type": "cr:Field", "@id": place, "name": name, "description": text, "dataType": kind}
