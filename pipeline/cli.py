"""The command `symolo`: commands, exit codes, and errors as one clear line."""

import os
import signal
import threading
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import FrameType
from typing import Annotated

import typer

from pipeline.commands import checks, hil, maintenance, stages, validate
from pipeline.commands.baselines import baselines
from pipeline.commands.diagnose import diagnose
from pipeline.commands.export import export
from pipeline.commands.identify_camera import identify_camera
from pipeline.commands.measurements import measured
from pipeline.commands.model import model
from pipeline.commands.pack import pack
from pipeline.commands.preview import preview
from pipeline.commands.report import report
from pipeline.commands.storage import download, upload
from symolo.core.errors import EnvironmentLacking, InputError, RunFailed, one_line
from symolo.core.extras import EXTRA_OF, extra_is_missing
from symolo.core.os_errors import lacking

EPILOG = """Exit codes: 0 done; 1 a bug; 2 bad input or usage, nothing written; 3 a run failed, the others are finished;
4 verify or upload --check found faults, or repair left some; 5 the environment lacks something; 6, 7 compare: equal
within the tolerance, different; 130 interrupted.

First steps:

symolo doctor

symolo release smoke --out data

symolo verify data

symolo rerender data/CW/test_1 --look lab --out lab
"""


INTERRUPTED = 130
AT_ONCE = "interrupted twice, ended at once; run the same command again to continue"


def command_line() -> typer.Typer:
    """All commands, as `--help` lists them."""
    app = typer.Typer(
        name="symolo",
        help="From a YAML scenario to a photorealistic, physically honest dataset of a small educational robot.",
        epilog=EPILOG,
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback()(_options)
    for command in (
        stages.plan,
        preview,
        stages.release,
        stages.simulate,
        stages.render,
        stages.assemble,
        stages.rerender,
        model,
    ):
        app.command(rich_help_panel="Make data")(command)
    for command in (hil.hil, hil.firmware):
        app.command(rich_help_panel="Hardware in the loop")(command)
    looks = checks.verify, checks.compare, checks.contact_sheet, report, baselines, checks.doctor, checks.schema
    for command in looks:
        app.command(rich_help_panel="Look at data, machine and format")(command)
    for command in (maintenance.status, maintenance.repair, maintenance.bag, export, pack, upload, download):
        app.command(rich_help_panel="Keep data whole")(command)
    for command in (measured, diagnose, identify_camera):
        app.command(rich_help_panel="Understand measured data")(command)
    validation = typer.Typer(no_args_is_help=True)
    for command in validate.COMMANDS:
        validation.command()(command)
    app.add_typer(validation, name="validate", help=validate.HELP, rich_help_panel="Look at the robot's parts")
    return app


def _print_version(wanted: bool) -> None:  # noqa: FBT001 - what typer calls back with
    if wanted:
        from symolo.core.versions import installed_version  # noqa: PLC0415 - half of the time that --help takes

        typer.echo(f"symolo {installed_version('symolo')}")
        raise typer.Exit


def _options(
    *,
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code."""
    with _interrupts_noted() as interrupted:
        return _run(arguments, interrupted)


def _run(arguments: Sequence[str] | None, interrupted: threading.Event) -> int:
    try:
        code = command_line()(arguments, standalone_mode=False)
    except typer.TyperException as error:
        return _fail(2, f"{error.format_message()} (see symolo --help)")
    except InputError as error:
        return _fail(2, str(error))
    except RunFailed as error:
        return _fail(3, str(error))
    except EnvironmentLacking as error:
        return _fail(5, str(error))
    except (KeyboardInterrupt, typer.Abort):
        return _interrupted()
    except SystemExit:
        return 0  # typer's answer to a reader of our output that has gone, as in `symolo schema | head`
    except Exception as error:  # noqa: BLE001 - the last line of defence gives a bug its exit code
        if interrupted.is_set():
            return _interrupted()
        if problem := _machine_lacks(error):
            return _fail(5, one_line(problem))
        return _bug()
    return _interrupted() if code == INTERRUPTED else int(code or 0)


def _machine_lacks(error: Exception) -> str:
    """Return what the machine lacks and what to do about it; empty where the error is not the machine's."""
    package = (error.name or "").partition(".")[0] if isinstance(error, ModuleNotFoundError) else ""
    return str(extra_is_missing(package)) if package in EXTRA_OF else lacking(error)


@contextmanager
def _interrupts_noted() -> Iterator[threading.Event]:
    """Set the event at a SIGINT or SIGTERM, which interrupts; a second one ends the process at once.

    The event, for a library may make another error of a KeyboardInterrupt in its midst.
    """
    noted = threading.Event()

    def note(_number: int, _frame: FrameType | None) -> None:
        if noted.is_set():
            # Workers see the pipe close and end themselves; what is on the disk is whole at any instant.
            os.write(2, f"symolo: {AT_ONCE}\n".encode())
            os._exit(INTERRUPTED)
        noted.set()
        raise KeyboardInterrupt

    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    # Not those that are ignored, as SIGINT is in a background job.
    heeded = {signal.default_int_handler, signal.SIG_DFL}
    noticed = [number for number, handler in before.items() if handler in heeded]
    for number in noticed:
        signal.signal(number, note)
    try:
        yield noted
    finally:
        for number in noticed:
            signal.signal(number, before[number])


def _fail(code: int, text: str) -> int:
    typer.echo(f"symolo: {text}", err=True)
    return code


def _interrupted() -> int:
    return _fail(INTERRUPTED, "interrupted, nothing is lost; run the same command again to continue")


def _bug() -> int:
    traceback.print_exc()
    return _fail(1, "this is a bug in symolo; please report it with the lines above")
