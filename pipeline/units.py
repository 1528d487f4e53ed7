"""The unit of work, such as a run to simulate or a block of frames to render, and what a worker says while doing it."""

import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from blender_scenes.protocol import Work
from configs.errors import EnvironmentLacking, InputError, RunFailed
from pipeline.reading import Reading


class Message(BaseModel):
    """One line of JSON between the supervisor and a worker."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class SimulateUnit(Message):
    kind: Literal["simulate"] = "simulate"
    name: str
    spec: str
    """The run specification as JSON text."""
    folder: Path
    key: str
    """Input key of the stage."""

    def run(self, progress: Callable[[float], None]) -> None:
        from pipeline.stages.simulate_runs import simulate_into  # noqa: PLC0415 - loads pybullet, in the worker alone

        simulate_into(self.spec, self.folder, self.key, progress)


class RenderUnit(Message):
    kind: Literal["render"] = "render"
    work: Work
    name: str
    job: Path
    folder: Path
    """For the pictures, or for the files of the annotations."""
    numbers: tuple[int, ...]
    threads: int
    own_files: Path | None = None
    """Folder of the user's own files by their SHA-256; only pictures show any."""

    def run(self, progress: Callable[[float], None]) -> None:
        from blender_scenes.renderer import RenderError, render_job  # noqa: PLC0415 - opencv, in the worker alone

        shares = iter(index / len(self.numbers) for index in range(1, len(self.numbers) + 1))
        try:
            render_job(
                self.job,
                self.folder,
                work=self.work,
                threads=self.threads,
                numbers=self.numbers,
                on_frame=lambda _number: progress(next(shares, 1.0)),
                own_files=self.own_files,
            )
        except RenderError as error:
            raise RunFailed(str(error)) from error


TRACEBACK = "traceback.txt"
"""In the folder of a case whose diagnosis met a bug."""


class DiagnoseUnit(Message):
    kind: Literal["diagnose"] = "diagnose"
    name: str
    case: Path
    """As the user typed it; it may be a table of the paper."""
    reading: Reading
    nominal: str
    """The nominal robot as JSON text; empty for that of the case's own parameters."""
    folder: Path
    pybullet: bool
    """Whether before and after are also measured by PyBullet."""
    against: Path | None
    """A dataset to hold against it."""
    alone: bool
    """Whether it is the only case, so that what is wrong with it is wrong with the command."""

    def run(self, progress: Callable[[float], None]) -> None:
        from pipeline.diagnosing import diagnose_into  # noqa: PLC0415 - scipy and matplotlib, in the worker alone

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
            self.folder.mkdir(parents=True, exist_ok=True)
            note = self.folder / TRACEBACK
            note.write_text(traceback.format_exc(), encoding="utf-8")
            told = f"a bug of symolo: {type(error).__name__}: {error}".splitlines()[0]
            raise RunFailed(f"{told}; please report it with {note}") from error


AnyUnit = SimulateUnit | RenderUnit | DiagnoseUnit
Unit = Annotated[AnyUnit, Field(discriminator="kind")]


class Progress(Message):
    kind: Literal["progress"] = "progress"
    share: float
    """How much of the unit is done, 0 to 1."""


class Finished(Message):
    kind: Literal["finished"] = "finished"


class Failed(Message):
    kind: Literal["failed"] = "failed"
    error: Literal["input", "environment", "run", "bug", "killed"]
    text: str


Event = Annotated[Progress | Finished | Failed, Field(discriminator="kind")]

UNITS: TypeAdapter[AnyUnit] = TypeAdapter(Unit)
EVENTS: TypeAdapter[Progress | Finished | Failed] = TypeAdapter(Event)
