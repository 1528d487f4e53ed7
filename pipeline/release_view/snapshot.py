"""State of the release in an output folder, from the files that are there at this moment."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from pipeline.run_folder.stored_runs import run_name, trajectory_folders
from pipeline.run_folder.workspace import StageFolder, Workspace
from pipeline.stages.simulate_runs import RunOutcome, read_outcome
from symolo.core.files.file_locks import is_locked
from symolo.core.os_errors import NOT_THERE
from symolo.dataset.layout import IMAGES, STAGES
from symolo.dataset.manifest import TAG_MANIFEST

RATE_WINDOW_S = 120.0
"""Time over which the rate of rendering is measured."""


@dataclass(frozen=True)
class RenderedImage:
    """An image that is finished."""

    run: str
    number: int
    path: Path
    made_s: float
    """Time at which it was finished, in seconds since 1970."""


@dataclass(frozen=True)
class RunProgress:
    """Progress of the images of one run."""

    run: str
    planned: int
    """Number of images that the run will have."""
    images: tuple[RenderedImage, ...]
    """Images that are rendered so far."""
    released: bool
    problem: str
    """Why the run is not released; empty where nothing is known against it."""


@dataclass(frozen=True)
class Snapshot:
    """Progress of all runs of an output folder at one moment."""

    runs: tuple[RunProgress, ...]
    """The runs with a trajectory by name."""
    working: bool
    """Whether a command works in the folder."""
    finished: bool
    """Whether the lists of checksums are there, which are written last."""
    taken_s: float
    """Time of the snapshot, in seconds since 1970."""

    @property
    def planned(self) -> int:
        return sum(run.planned for run in self.runs if not run.problem)

    @property
    def rendered(self) -> int:
        return sum(len(run.images) for run in self.runs if not run.problem)

    @property
    def newest(self) -> RenderedImage | None:
        """The last image; None before the first one."""
        return max((image for run in self.runs for image in run.images), key=lambda image: image.made_s, default=None)

    @property
    def left_s(self) -> float | None:
        """Time until all images are rendered, at the rate of the last minutes; None where there is no rate yet."""
        made = [image.made_s for run in self.runs for image in run.images]
        recent = [time for time in made if time > self.taken_s - RATE_WINDOW_S]
        if len(recent) < 2 or self.planned <= self.rendered:
            return None
        return (self.planned - self.rendered) * (self.taken_s - min(recent)) / len(recent)


def snapshot(out: Path, now_s: float) -> Snapshot:
    """Return how far the release in an output folder is.

    Args:
        out: Output folder of `release`, `simulate`, `render` or `rerender`.
        now_s: Time of the snapshot, in seconds since 1970.
    """
    workspace = Workspace(out.absolute())
    runs = tuple(_run(workspace, folder) for folder in trajectory_folders(out))
    working = is_locked(out / STAGES)
    return Snapshot(runs, working, (out / TAG_MANIFEST).is_file() and not working, now_s)


def _run(workspace: Workspace, folder: Path) -> RunProgress:
    name, outcome = run_name(folder), _outcome(folder)
    render = workspace.render(name)
    problems = outcome.problems if outcome else ()
    return RunProgress(
        run=name,
        planned=outcome.images if outcome else 0,
        images=tuple(_images(name, render)),
        released=workspace.assemble(name).done() is not None,
        problem="; ".join(problems) or render.problem(),
    )


def _outcome(folder: Path) -> RunOutcome | None:
    try:
        return read_outcome(folder)
    except (*NOT_THERE, ValidationError):
        return None


def _images(run: str, folder: StageFolder) -> Sequence[RenderedImage]:
    images = []
    for path in sorted((folder.path / IMAGES).glob("*.jpg")):
        if path.stem.isdigit():  # a name that begins with a dot is unfinished
            try:
                images.append(RenderedImage(run, int(path.stem), path, path.stat().st_mtime))
            except NOT_THERE:  # replaced meanwhile
                continue
    return images
