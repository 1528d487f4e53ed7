"""The unit of work, such as a run to simulate or a block of frames to render, and what a worker says while doing it."""

import traceback
from pathlib import Path
from typing import Annotated, ClassVar, Literal, Protocol, Self

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from blender_scenes.render.protocol import Work
from pipeline.diagnosing.case_reading import Reading
from pipeline.work.cpu import cpu_class
from symolo.core.atomic_files import make_folder, remove_leftovers, write_file
from symolo.core.errors import EnvironmentLacking, InputError, RunFailed


class Message(BaseModel):
    """One line of JSON between the supervisor and a worker."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class EngineFailed(Exception):  # noqa: N818 - an outcome with a name, as `RunFailed` is
    """An engine died, hung or gave up; another try may do better."""


class Tell(Protocol):
    """Called by a unit while it is done."""

    def __call__(self, share: float, at: int | None = None) -> None:
        """How much of the unit is done, 0 to 1, and which of its frames is begun."""
        ...


class UnitOfWork(Message):
    """What every kind of unit has; the supervisor asks for no more."""

    patience_s: ClassVar[float] = float("inf")
    """How long it may get no further before it is ended."""
    shares_a_worker: ClassVar[bool] = True
    """Whether it is done in a process that has done another one before, with the same bytes and no more memory."""

    name: str
    folder: Path
    """What it fills, or fills with others."""

    def clear(self, writer: str) -> None:
        """Remove what a process that is gone left unfinished: the folder itself, or files in it."""
        remove_leftovers(self.folder.parent, of=writer)
        remove_leftovers(self.folder, below=True, of=writer)

    def part(self, frame: int) -> str:
        """What a frame of the unit is called."""
        return f"image {frame}"

    def set_aside(self, frame: int, tries: int, cause: str) -> str:
        """What to say of a frame that failed in every try."""
        return f"{self.part(frame)} was given up after {tries} tries: {cause}"

    def without(self, frame: int) -> Self | None:  # noqa: ARG002 - a unit of one piece has no frames
        """The unit less one of its frames; None where nothing is left."""
        return None


class SimulateUnit(UnitOfWork):
    patience_s: ClassVar[float] = 900.0
    """For a second of driving, of which it takes one at most on a slow machine."""

    kind: Literal["simulate"] = "simulate"
    spec: str
    """The run specification as JSON text."""
    key: str
    """Input key of the stage."""

    def run(self, progress: Tell) -> None:
        from pipeline.stages.simulate_runs import simulate_into  # noqa: PLC0415 - loads pybullet, in the worker alone

        simulate_into(self.spec, self.folder, self.key, progress)


class RenderUnit(UnitOfWork):
    """A block of frames. How long Blender may take for one is for the renderer to say, which knows their size."""

    kind: Literal["render"] = "render"
    work: Work
    """Whether `folder` is for the pictures, or for the files of the annotations."""
    job: Path
    numbers: tuple[int, ...]
    threads: int
    own_files: Path | None = None
    """Folder of the user's own files by their SHA-256; only pictures show any."""

    def run(self, progress: Tell) -> None:
        from blender_scenes.render.renderer import RenderError, render_job  # noqa: PLC0415 - opencv, in the worker alone

        done: list[int] = []

        def on_frame(number: int) -> None:
            done.append(number)
            progress(len(done) / len(self.numbers))

        try:
            render_job(
                self.job,
                self.folder,
                work=self.work,
                threads=self.threads,
                numbers=self.numbers,
                on_frame=on_frame,
                on_begin=lambda number: progress(len(done) / len(self.numbers), number),
                own_files=self.own_files,
                cpu=cpu_class(),
            )
        except RenderError as error:
            raise EngineFailed(str(error)) from error

    def set_aside(self, frame: int, tries: int, cause: str) -> str:
        from blender_scenes.render.renderer import seed_of  # noqa: PLC0415 - as above

        told = f"image {frame} (seed {seed_of(self.job, self.work)}) was given up after {tries} tries"
        # The cause last, for it may end with a log.
        return f"{told}; the same command tries it alone, for the others are there: {cause}"

    def without(self, frame: int) -> Self | None:
        rest = tuple(number for number in self.numbers if number != frame)
        return self.model_copy(update={"numbers": rest}) if rest else None


TRACEBACK = "traceback.txt"
"""In the folder of a case whose diagnosis met a bug."""


class DiagnoseUnit(UnitOfWork):
    shares_a_worker: ClassVar[bool] = False
    """Libraries for fits and plots keep what they have seen."""

    kind: Literal["diagnose"] = "diagnose"
    case: Path
    """As the user typed it; it may be a table of the paper."""
    reading: Reading
    nominal: str
    """The nominal robot as JSON text; empty for that of the case's own parameters."""
    pybullet: bool
    """Whether before and after are also measured by PyBullet."""
    against: Path | None
    """A dataset to hold against it."""
    alone: bool
    """Whether it is the only case, so that what is wrong with it is wrong with the command."""

    def run(self, progress: Tell) -> None:
        from pipeline.diagnosing.diagnose import diagnose_into  # noqa: PLC0415 - scipy and matplotlib, in the worker alone

        del progress
        try:
            diagnose_into(
                self.case, self.reading, self.nominal, self.folder, pybullet=self.pybullet, against=self.against
            )
        except InputError as error:
            if self.alone:
                raise
            raise RunFailed(str(error)) from error
        except (EnvironmentLacking, OSError):
            raise
        except Exception as error:
            if self.alone:
                raise
            # A bug that one case brings out is no reason to lose the others; its traceback is kept.
            make_folder(self.folder)
            note = self.folder / TRACEBACK
            write_file(note, traceback.format_exc().encode())
            told = f"a bug of symolo: {type(error).__name__}: {error}".splitlines()[0]
            raise RunFailed(f"{told}; please report it with {note}") from error


AnyUnit = SimulateUnit | RenderUnit | DiagnoseUnit
Unit = Annotated[AnyUnit, Field(discriminator="kind")]


class Progress(Message):
    kind: Literal["progress"] = "progress"
    share: float
    """How much of the unit is done, 0 to 1."""
    at: int | None = None
    """The frame that is begun."""


class Alive(Message):
    """A sign of life while nothing else is to be said."""

    kind: Literal["alive"] = "alive"


class Finished(Message):
    kind: Literal["finished"] = "finished"


class Failed(Message):
    kind: Literal["failed"] = "failed"
    error: Literal["input", "environment", "run", "bug", "killed", "engine"]
    text: str


AnyMessage = Progress | Alive | Finished | Failed
Event = Annotated[AnyMessage, Field(discriminator="kind")]

UNITS: TypeAdapter[AnyUnit] = TypeAdapter(Unit)
EVENTS: TypeAdapter[AnyMessage] = TypeAdapter(Event)
