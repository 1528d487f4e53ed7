"""The worker process: `python -m pipeline.work.worker_main` reads one unit of work a line, does it and reports.

`symolo.core.child_process` describes the channel to the supervisor.
"""

import time
import traceback
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Protocol

from pipeline.user_code import fault_of_user_code, load_from_environment
from pipeline.work.processors import cpu_class
from pipeline.work.units import UNITS, AnyUnit, DiagnoseUnit, Progress, RenderUnit, SimulateUnit
from symolo.core.child_process import ErrorKind, Failed, Finished, Owner
from symolo.core.errors import EnvironmentLacking, InputError, RunFailed
from symolo.core.extras import extra_lacking
from symolo.core.files.atomic_files import make_folder, write_file
from symolo.core.os_errors import lacking


class EngineFailed(Exception):  # noqa: N818 - an outcome with a name, as `RunFailed` is
    """An engine died, hung or gave up; another try may succeed."""


class OnProgress(Protocol):
    """Called while a unit is done."""

    def __call__(self, share: float, at: int | None = None, text: str = "") -> None:
        """Take the share of the unit that is done, 0 to 1, the number of the frame that is begun, and what is done."""
        ...


def simulate_run(unit: SimulateUnit, on_progress: OnProgress) -> None:
    from pipeline.stages.simulate_runs import simulate_into  # noqa: PLC0415 - loads PyBullet

    simulate_into(unit.spec, unit.folder, unit.key, on_progress)


def render_frames(unit: RenderUnit, on_progress: OnProgress) -> None:
    """Render a block of frames.

    Raises:
        EngineFailed: Blender failed.
    """
    from blender_scenes.render.renderer import RenderError, render_job  # noqa: PLC0415 - loads OpenCV

    done: list[int] = []

    def on_frame(number: int) -> None:
        done.append(number)
        on_progress(len(done) / len(unit.numbers))

    try:
        render_job(
            unit.job,
            unit.folder,
            work=unit.work,
            threads=unit.threads,
            numbers=unit.numbers,
            on_frame=on_frame,
            on_begin=lambda number: on_progress(len(done) / len(unit.numbers), number),
            user_files=unit.user_files,
            cpu=cpu_class(),
        )
    except RenderError as error:
        raise EngineFailed(str(error)) from error


SECONDS_BETWEEN_SHARES = 1.0
"""Time between two messages about how far a diagnosis is, which has thousands of steps."""

MIN_SHARE = 0.05
"""Share that a diagnosis reports at least; less of it says too little about the time that is left."""


def diagnose_case(unit: DiagnoseUnit, on_progress: OnProgress) -> None:
    """Diagnose a case; of several cases a bad one fails alone.

    Raises:
        InputError: The only case is bad.
        RunFailed: One of several cases is bad or brings out a bug.
    """
    from diagnosis.progress import DiagnosisProgress  # noqa: PLC0415 - as below
    from pipeline.diagnosing.diagnose import TRACEBACK, diagnose_into  # noqa: PLC0415 - loads SciPy and Matplotlib

    sent_s, text = time.monotonic(), ""

    def on_fits(words: str) -> None:
        nonlocal text
        text = words

    def on_share(share: float) -> None:
        nonlocal sent_s
        if time.monotonic() - sent_s >= SECONDS_BETWEEN_SHARES:
            sent_s = time.monotonic()
            on_progress(share if share >= MIN_SHARE else 0.0, text=text)

    try:
        diagnose_into(unit.case, unit.settings, unit.folder, DiagnosisProgress(on_share, on_fits))
    except (EnvironmentLacking, OSError):
        raise
    except Exception as error:
        if unit.alone or lacking(error):
            raise
        fault = error if isinstance(error, InputError) else fault_of_user_code(error)
        if fault is not None:
            raise RunFailed(str(fault)) from error
        # A bug that one case brings out is no reason to lose the others; its traceback is kept.
        make_folder(unit.folder)
        note = unit.folder / TRACEBACK
        write_file(note, traceback.format_exc().encode())
        cause = f"a bug of symolo: {type(error).__name__}: {error}".splitlines()[0]
        raise RunFailed(f"{cause}; please report it with {note}") from error


WORK: Mapping[type[AnyUnit], Callable[[Any, OnProgress], None]] = MappingProxyType(
    {SimulateUnit: simulate_run, RenderUnit: render_frames, DiagnoseUnit: diagnose_case}
)


KIND_OF: Mapping[type[Exception], ErrorKind] = MappingProxyType(
    {InputError: "input", EnvironmentLacking: "environment", RunFailed: "run", EngineFailed: "engine"}
)


def main() -> None:
    owner = Owner()
    while True:
        unit = UNITS.validate_json(owner.next_request())
        owner.send(do(unit, lambda share, at=None, text="": owner.send(Progress(share=share, at=at, text=text))))


def do(unit: AnyUnit, on_progress: OnProgress) -> Finished | Failed:
    """Do a unit and return the message about its end."""
    try:
        load_from_environment()
        WORK[type(unit)](unit, on_progress)
    except Exception as error:  # noqa: BLE001 - reported with its traceback by the supervisor, which decides
        for error_class, kind in KIND_OF.items():
            if isinstance(error, error_class):
                return Failed(error=kind, text=str(error))
        if cause := extra_lacking(error) or lacking(error):
            return Failed(error="environment", text=cause)
        if fault := fault_of_user_code(error):
            return Failed(error="input", text=str(fault))
        return Failed(error="bug", text=traceback.format_exc())
    return Finished()


if __name__ == "__main__":
    main()
