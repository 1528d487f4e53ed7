"""Splits of a dataset in metadata.json: the runs or images of training, validation and test."""

from collections import Counter
from collections.abc import Collection, Iterator
from typing import Literal, get_args

from pydantic import Field

from symolo.dataset.documents.record import Record

SplitName = Literal["train", "validation", "test"]
SPLIT_NAMES: tuple[SplitName, ...] = get_args(SplitName)
"""Splits in the order in which every output lists them."""
Grouping = Literal["run", "route", "look", "robot", "arena", "seed", "image"]
"""Properties by which runs are grouped; `image` divides runs."""
Stratum = Literal["route", "look", "robot"]
"""Properties whose values may be mixed alike in all splits."""
NEIGHBOURS_WARNING = (
    "splits by image: neighbouring images of a run are nearly alike, so results for validation and test are better than"
    " those for new runs; divide by run instead"
)


class SplitsRecord(Record):
    """Assignment of all runs, or of all images, to splits."""

    by: Literal[Grouping, "listed"]
    """Property by which the runs were grouped: a group is in one split as a whole. With `listed`, the runs of each
    split were listed; with `image`, runs are divided."""
    seed: int
    """Seed of the random assignment."""
    stratify: tuple[Stratum, ...] = Field(default=(), exclude_if=lambda names: not names)
    """Properties whose values are mixed about alike in all splits; absent if there are none."""
    runs: dict[SplitName, tuple[str, ...]] = Field(default_factory=dict, exclude_if=lambda runs: not runs)
    """Runs of each split; absent for splits by image."""
    images: dict[SplitName, dict[str, tuple[int, ...]]] = Field(
        default_factory=dict, exclude_if=lambda images: not images
    )
    """Numbers of the images of each split by run; absent unless the splits are by image."""

    @property
    def names(self) -> tuple[SplitName, ...]:
        """Names of the splits in their order."""
        return tuple(name for name in SPLIT_NAMES if name in self.runs or name in self.images)

    @property
    def how(self) -> str:
        """Sentence on how the dataset was divided."""
        if self.by == "listed":
            return "The runs of each split were listed."
        mixed = f", with about the same mix of {' and '.join(self.stratify)} in each split" if self.stratify else ""
        return f"Divided by {self.by}{mixed}."

    @property
    def split_by_run(self) -> dict[str, SplitName]:
        """Split of each run by its name; empty for splits by image."""
        return {run: name for name in self.names for run in self.runs.get(name, ())}

    @property
    def split_by_image(self) -> dict[tuple[str, int], SplitName]:
        """Split of each image by its run and number; empty unless the splits are by image."""
        return {
            (run, number): name
            for name in self.names
            for run, numbers in self.images.get(name, {}).items()
            for number in numbers
        }

    @property
    def empty(self) -> tuple[SplitName, ...]:
        """Names of the splits without a run or an image: all of their runs failed, or were not chosen."""
        return tuple(
            name for name in self.names if not self.runs.get(name) and not any(self.images.get(name, {}).values())
        )

    def only(self, runs: Collection[str]) -> "SplitsRecord":
        """Return the assignment of these runs only; a split may then be empty."""
        runs_of_split: dict[SplitName, tuple[str, ...]] = {
            name: tuple(run for run in ones if run in runs) for name, ones in self.runs.items()
        }
        images_of_split: dict[SplitName, dict[str, tuple[int, ...]]] = {
            name: {run: n for run, n in ones.items() if run in runs} for name, ones in self.images.items()
        }
        return self.model_copy(update={"runs": runs_of_split, "images": images_of_split})

    def faults(self, known: set[str]) -> Iterator[str]:
        """Yield what is wrong with the assignment of runs with these names."""
        if bool(self.images) != (self.by == "image") or bool(self.runs) == bool(self.images):
            yield "splits: by image has the key images, every other grouping the key runs"
        listed = Counter(run for runs in self.runs.values() for run in runs)
        yield from (f"splits: {run} is in several splits" for run, count in sorted(listed.items()) if count > 1)
        named = {*listed, *(run for runs in self.images.values() for run in runs)}
        yield from (f"splits: there is no run {run}" for run in sorted(named - known))
