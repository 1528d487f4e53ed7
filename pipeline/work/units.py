"""Units of work as plain data, such as a run to simulate or a block of frames to render, and messages about them."""

from pathlib import Path
from typing import Annotated, ClassVar, Literal

from pydantic import Field, TypeAdapter
from typing_extensions import Self

from blender_scenes.render.protocol import Work
from symolo.core.child_process import Alive, Failed, Finished, Message
from symolo.core.files.atomic_files import remove_leftovers


class UnitOfWork(Message):
    """Base of all kinds of unit. `pipeline.work.worker_main` holds the function that does each kind."""

    patience_s: ClassVar[float] = float("inf")
    """Time [s] without progress after which the worker is killed."""
    shares_a_worker: ClassVar[bool] = True
    """Whether a process that has done another unit before gives the same bytes and needs no more memory."""

    name: str
    """Name in messages: the run or the case."""
    folder: Path
    """Folder that the unit fills, perhaps together with other units."""

    def clear(self, writer: str) -> None:
        """Remove the unfinished files of a dead process: the folder itself, or files in it."""
        remove_leftovers(self.folder.parent, of=writer)
        remove_leftovers(self.folder, below=True, of=writer)

    def given_up(self, frame: int, tries: int, cause: str) -> str:
        """Return the message for a frame that failed in every try."""
        return f"image {frame} was given up after {tries} tries: {cause}"

    def without(self, frame: int) -> Self | None:  # noqa: ARG002 - a unit of one piece has no frames
        """Return the unit less one of its frames; None where nothing is left."""
        return None


class SimulateUnit(UnitOfWork):
    """One run to simulate."""

    patience_s: ClassVar[float] = 900.0
    """A second of driving takes one second at most on a slow machine."""

    kind: Literal["simulate"] = "simulate"
    spec: str
    """Run specification as JSON text."""
    key: str
    """Input key of the stage."""


class RenderUnit(UnitOfWork):
    """A block of frames of one run. The renderer itself limits the time for a frame, for it knows the frame's size."""

    kind: Literal["render"] = "render"
    work: Work
    """Product of Blender: the images, or the files of the annotations."""
    job: Path
    """File of the render job or annotation job."""
    numbers: tuple[int, ...]
    """Numbers of the frames."""
    threads: int
    """Number of threads that Blender uses."""
    user_files: Path | None = None
    """Folder of the user's own files by their SHA-256; only images need it."""

    def given_up(self, frame: int, tries: int, cause: str) -> str:
        from blender_scenes.render.renderer import seed_of  # noqa: PLC0415 - loads OpenCV

        seed = seed_of(self.job, self.work)
        # The cause comes last, because it may end with a log.
        return (
            f"image {frame} (seed {seed}) was given up after {tries} tries; "
            f"the same command tries this image again and keeps the others: {cause}"
        )

    def without(self, frame: int) -> Self | None:
        rest = tuple(number for number in self.numbers if number != frame)
        return self.model_copy(update={"numbers": rest}) if rest else None


class DiagnosisSettings(Message):
    """Options of `symolo diagnose`, the same for all cases."""

    importer: str | None = None
    """Name of the importer; None for the one that recognises a case."""
    part: str | None = None
    """The only part of the robot to look at; None for all."""
    held_out: tuple[str, ...] = ()
    """Patterns of the trials to hold out; empty for those that the source or its importer holds out."""
    nominal: str = ""
    """Nominal robot as JSON text; empty for the robot that the case itself describes."""
    pybullet: bool = False
    """Whether the errors before and after are measured by PyBullet as well."""
    against: Path | None = None
    """Dataset that each case is compared with."""
    together: tuple[Path, ...] = ()
    """Further cases of the same robot, which are fitted together with the first one."""
    discover: bool = False
    """Whether a law is looked for where something stays unexplained."""


class DiagnoseUnit(UnitOfWork):
    """One case to diagnose."""

    shares_a_worker: ClassVar[bool] = False
    """Libraries for fits and plots keep state."""

    kind: Literal["diagnose"] = "diagnose"
    case: Path
    """Path as the user typed it; it may be a table of the paper."""
    settings: DiagnosisSettings
    alone: bool
    """Whether it is the only case, so that a fault of it is a fault of the command."""


AnyUnit = SimulateUnit | RenderUnit | DiagnoseUnit


class Progress(Message):
    """How far a unit is."""

    kind: Literal["progress"] = "progress"
    share: float
    """Share of the unit that is done, 0 to 1."""
    at: int | None = None
    """Number of the frame that is begun."""
    text: str = ""
    """What is being done, in a few words; empty if nobody says so."""


AnyMessage = Progress | Alive | Finished | Failed

UNITS: TypeAdapter[AnyUnit] = TypeAdapter(Annotated[AnyUnit, Field(discriminator="kind")])
MESSAGES: TypeAdapter[AnyMessage] = TypeAdapter(Annotated[AnyMessage, Field(discriminator="kind")])
