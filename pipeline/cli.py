"""The command `symolo`: commands, exit codes, and errors as one clear line."""

import signal
import threading
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import FrameType
from typing import Annotated

import typer

from configs.errors import EnvironmentLacking, InputError, RunFailed
from pipeline.commands import bench, examine, keep, make
from pipeline.commands.diagnose import diagnose
from pipeline.commands.measured import measured
from pipeline.commands.pictures import pictures
from pipeline.commands.preview import preview
from pipeline.files import DISK_FULL

EPILOG = """Exit codes: 0 done; 1 a bug; 2 bad input or usage, nothing written; 3 a run failed, the others are finished;
4 verify found faults; 5 the environment lacks something; 6, 7 compare: equal within the tolerance, different;
130 interrupted.

First steps:

symolo doctor

symolo release smoke --out data

symolo verify data

symolo rerender data/CW/test_1 --look lab --out lab
"""


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
    for command in (make.plan, preview, make.release, make.simulate, make.render, make.assemble, make.rerender):
        app.command(rich_help_panel="Make data")(command)
    for command in (examine.verify, examine.compare, examine.contact_sheet, examine.doctor, examine.schema):
        app.command(rich_help_panel="Look at data, machine and format")(command)
    for command in (keep.repair, keep.bag):
        app.command(rich_help_panel="Keep data whole")(command)
    for command in (measured, diagnose, pictures):
        app.command(rich_help_panel="Understand measured data")(command)
    benches = typer.Typer(no_args_is_help=True)
    for command in bench.COMMANDS:
        benches.command()(command)
    app.add_typer(benches, name="bench", help=bench.HELP, rich_help_panel="Look at the robot's parts")
    return app


def _print_version(wanted: bool) -> None:  # noqa: FBT001 - what typer calls back with
    if wanted:
        from pipeline.versions import installed_version  # noqa: PLC0415 - half of the time that --help takes

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
        if isinstance(error, OSError) and error.errno in DISK_FULL:
            return _fail(5, f"{error}; free some space and run the command again")
        return _bug()
    return _interrupted() if code == 130 else int(code or 0)


@contextmanager
def _interrupts_noted() -> Iterator[threading.Event]:
    """Set the event at a SIGINT, for a library may make another error of a KeyboardInterrupt in its midst."""
    noted = threading.Event()

    def note(number: int, frame: FrameType | None) -> None:
        noted.set()
        signal.default_int_handler(number, frame)

    before = signal.getsignal(signal.SIGINT)
    if before is signal.default_int_handler:  # and not ignored, as in a background job
        signal.signal(signal.SIGINT, note)
    try:
        yield noted
    finally:
        signal.signal(signal.SIGINT, before)


def _fail(code: int, text: str) -> int:
    typer.echo(f"symolo: {text}", err=True)
    return code


def _interrupted() -> int:
    return _fail(130, "interrupted; run the same command again to continue")


def _bug() -> int:
    traceback.print_exc()
    return _fail(1, "this is a bug in symolo; please report it with the lines above")
