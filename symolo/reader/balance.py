"""Content of each split, so that training, validation and test can be compared: runs, images, classes, speeds."""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from symolo.arena.fingerprint import arena_fingerprint
from symolo.arena.geometry import Arena
from symolo.dataset.annotations import CATEGORIES
from symolo.dataset.documents.robots import SimulatedRobots, robot_of_run
from symolo.dataset.documents.splits_record import NEIGHBOURS_WARNING
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run
from symolo.reader.run_folder import Image

_LINE = "line"
_SKY = 0
"""Id of the category, and of the pixels, where there is no surface."""
_MAX_NAMES = 4


@dataclass
class SplitContent:
    """What is in a split; it is counted image by image."""

    name: str
    runs: dict[str, None] = field(default_factory=dict)
    routes: dict[str, None] = field(default_factory=dict)
    looks: dict[str, None] = field(default_factory=dict)
    robots: dict[str, None] = field(default_factory=dict)
    arenas: set[str] = field(default_factory=set)
    """Arenas with their values that were drawn, as JSON."""
    images: int = 0
    images_by_class: Counter[str] = field(default_factory=Counter)
    """Number of images that show a class."""
    instances: Counter[str] = field(default_factory=Counter)
    """Number of instances of a class, each counted in every image that shows it."""
    speeds_m_s: list[float] = field(default_factory=list)
    """Smallest and largest speed at the images of each run."""


@dataclass(frozen=True)
class Balance:
    """The splits of a dataset side by side."""

    splits: tuple[SplitContent, ...]
    by: str
    """Property by which the dataset is divided."""
    how: str
    """Sentence on how it was divided."""
    classes: tuple[str, ...]
    """Classes that are known from annotations and occur in a split; empty without annotations."""
    knows_line: bool
    """Whether annotations say which images show the line."""

    @property
    def rows(self) -> list[tuple[str, list[str]]]:
        """Rows of a table: a quantity, and its value in each split."""
        rows = [
            ("runs", [str(len(split.runs)) for split in self.splits]),
            ("routes", [_listed([*split.routes]) for split in self.splits]),
            ("looks", [_listed([*split.looks]) for split in self.splits]),
            ("robots", [_listed([*split.robots]) for split in self.splits]),
            ("arenas", [str(len(split.arenas)) for split in self.splits]),
            ("arenas that another split has too", [str(len(self._in_others(split))) for split in self.splits]),
            ("images", [str(split.images) for split in self.splits]),
        ]
        if self.knows_line:
            without = [str(split.images - split.images_by_class[_LINE]) for split in self.splits]
            rows.append(("images without the line", without))
        for what, counts in (
            ("images with", [split.images_by_class for split in self.splits]),
            ("instances of", [split.instances for split in self.splits]),
        ):
            named = [name for name in self.classes if any(count[name] for count in counts)]
            rows += [(f"{what} {name}", [str(count[name]) for count in counts]) for name in named]
        if any(split.speeds_m_s for split in self.splits):
            rows.append(("speed at the images [m/s]", [_range(split.speeds_m_s) for split in self.splits]))
        return rows

    def _in_others(self, split: SplitContent) -> set[str]:
        """Return the arenas of a split that another split has, too."""
        others = (other.arenas for other in self.splits if other is not split)
        return split.arenas.intersection(set().union(*others))

    @property
    def has_images(self) -> bool:
        """Whether a split has images; a dataset that is simulated with `camera_hz: 0` has none."""
        return any(split.images for split in self.splits)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What makes results of the splits hard to compare, one sentence each without its full stop."""
        texts = [NEIGHBOURS_WARNING] if self.by == "image" else []
        if self.has_images:
            texts += [f"the {_splits([split.name])} has no images" for split in self.splits if not split.images]
        for name in self.classes:
            without = [split.name for split in self.splits if split.images and not split.images_by_class[name]]
            texts += [f'no image of the {_splits(without)} shows the annotated class "{name}"'] if without else []
        if self.knows_line:
            whole = [split.name for split in self.splits if split.images == split.images_by_class[_LINE] > 0]
            if 0 < len(whole) < len(self.splits):
                texts.append(f"every image of the {_splits(whole)} shows the line")
        return tuple(text[0].upper() + text[1:] for text in texts)


def _splits(names: Sequence[str]) -> str:
    """Return the word "split" with the names, which may be words of a sentence too, in quotation marks."""
    return ("split " if len(names) == 1 else "splits ") + " and ".join(f'"{name}"' for name in names)


def balance(data: Dataset, on_image: Callable[[int], None] = lambda _done: None) -> Balance | None:
    """Return the content of each split, or None if the dataset is not divided; label images are read one by one.

    Args:
        data: A dataset or some of its runs.
        on_image: Called after each image with the number of images done.

    Raises:
        InputError: A table or an annotation is missing or damaged.
    """
    if data.splits is None:
        return None
    record = data.splits
    diagnosis = SimulatedRobots.from_metadata(data.metadata).diagnosis if data.metadata else ""
    contents = {name: SplitContent(name) for name in record.names}
    split_by_run, split_by_image = record.split_by_run, record.split_by_image
    done, knows_line = 0, bool(data.runs)
    for stored in data.runs:
        run = replace(stored)  # its tables are freed together with it
        classes = _Classes(run)
        knows_line &= classes.knows_line
        parts: dict[str, list[Image]] = {}
        for image in run.images:
            split = split_by_run.get(run.name) or split_by_image.get((run.name, image.number))
            if split:
                parts.setdefault(split, []).append(image)
        if not run.images and (split := split_by_run.get(run.name)):
            parts[split] = []
        for split, images in parts.items():
            content = contents[split]
            _add_run(content, run, images, diagnosis)
            for image in images:
                seen = classes.seen(image)
                content.images += 1
                content.images_by_class.update(seen.keys())
                content.instances.update(seen if classes.counts_instances else {})
                done += 1
                on_image(done)
    occurring = {name for content in contents.values() for name in content.images_by_class}
    names = tuple(name for name in CATEGORIES if name in occurring)
    return Balance(tuple(contents.values()), record.by, record.how, names, knows_line)


def _add_run(content: SplitContent, run: Run, images: Sequence[Image], diagnosis: str) -> None:
    """Add the properties of a run, and the range of its speed at the images."""
    content.runs[run.name] = None
    content.routes[run.spec.route] = None
    content.looks[run.spec.look.name] = None
    content.robots[robot_of_run(run.spec.robot.name, run.spec.drawn, diagnosis)] = None
    content.arenas.add(arena_fingerprint(Arena.from_config(run.spec.arena)))
    if images and "v" in run.table.columns:
        speeds = run.image_table.twist[[image.index for image in images], 0]
        known = speeds[np.isfinite(speeds)]
        content.speeds_m_s += [float(known.min()), float(known.max())] if len(known) else []


class _Classes:
    """Classes in the images of a run, by the most exact of its annotations."""

    def __init__(self, run: Run) -> None:
        kinds = set(run.annotations.kinds) if run.has_annotations else set()
        self._kind = next((kind for kind in ("instance", "semantic", "boxes_2d") if kind in kinds), None)
        self.knows_line = self._kind in {"instance", "semantic"}
        self.counts_instances = self._kind in {"instance", "boxes_2d"}
        document = run.annotations if self._kind else None
        self._names = {one.id: one.name for one in document.categories} if document else {}
        self._instances = {one.id: self._names[one.category_id] for one in document.instances} if document else {}
        self._boxes: dict[int, Counter[str]] = {}
        for one in document.annotations if document and self._kind == "boxes_2d" else ():
            if one.area:
                self._boxes.setdefault(one.image_id, Counter())[self._names[one.category_id]] += 1

    def seen(self, image: Image) -> Counter[str]:
        """Return the number of visible instances of each class; 1 for each visible class if instances are not known."""
        if self._kind is None:
            return Counter()
        if self._kind == "boxes_2d":
            return self._boxes.get(image.number, Counter())
        names = self._instances if self._kind == "instance" else self._names
        return Counter(names[number] for number in _ids(image, self._kind) if number in names)


def _ids(image: Image, kind: str) -> Iterator[int]:
    """Yield the ids in a label image except that of the sky."""
    present = np.flatnonzero(np.bincount(image.annotation(kind).ravel()))
    return (number for number in present.tolist() if number != _SKY)


def _listed(names: Sequence[str]) -> str:
    more = len(names) - _MAX_NAMES
    return ", ".join(names[:_MAX_NAMES]) + (f" and {more} more" if more > 0 else "") or "-"


def _range(values: Sequence[float]) -> str:
    return f"{min(values):.2f} to {max(values):.2f}" if values else "-"
