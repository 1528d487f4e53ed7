"""The command `symolo`: commands, exit codes, and errors as one clear line."""

import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import cache
from itertools import pairwise
from pathlib import Path
from time import monotonic
from types import FrameType
from typing import Annotated

import typer
from typer.core import TyperGroup
from typer.main import get_group

from pipeline.address_space import check_address_space
from pipeline.commands.datasets.bag import bag
from pipeline.commands.datasets.baselines import baselines
from pipeline.commands.datasets.compare import compare
from pipeline.commands.datasets.contact_sheet import contact_sheet
from pipeline.commands.datasets.download import download
from pipeline.commands.datasets.export import export
from pipeline.commands.datasets.pack import pack
from pipeline.commands.datasets.repair import repair
from pipeline.commands.datasets.report import report
from pipeline.commands.datasets.sign import sign
from pipeline.commands.datasets.status import status
from pipeline.commands.datasets.train import train
from pipeline.commands.datasets.upload import upload
from pipeline.commands.datasets.verify import verify
from pipeline.commands.datasets.video import video
from pipeline.commands.datasets.view import view
from pipeline.commands.exit_codes import BAD_INPUT, BUG, INTERRUPTED, MACHINE_LACKS, RUN_FAILED
from pipeline.commands.machine.doctor import doctor
from pipeline.commands.machine.schema import schema
from pipeline.commands.make import arena, effect, robot, sensor
from pipeline.commands.make.assemble import assemble
from pipeline.commands.make.firmware import firmware
from pipeline.commands.make.hil import hil
from pipeline.commands.make.import_logs import import_logs
from pipeline.commands.make.model import model
from pipeline.commands.make.plan import plan
from pipeline.commands.make.preview import preview
from pipeline.commands.make.release import release
from pipeline.commands.make.render import render
from pipeline.commands.make.rerender import rerender
from pipeline.commands.make.simulate import simulate
from pipeline.commands.measured import case, look, validate
from pipeline.commands.measured.diagnose import diagnose
from pipeline.commands.measured.identify_camera import identify_camera
from pipeline.commands.measured.inspect import inspect
from pipeline.commands.measured.next_trial import next_trial
from symolo.core.errors import EnvironmentLacking, InputError, RunFailed, one_line
from symolo.core.extras import extra_lacking
from symolo.core.os_errors import lacking

EPILOG = """First steps:

symolo doctor
symolo release smoke --out data
symolo verify data
symolo rerender data/CW/test_1 --look lab --out lab

Exit codes:

0: success
1: a bug in symolo
2: the input or an option is wrong, and nothing was written
3: a run failed, and the others are finished
4: a dataset has faults
5: something is missing on this machine
6: `compare`: the data are equal within the tolerance
7: `compare`: the data are different
130: interrupted
"""

CODE_OF = {InputError: BAD_INPUT, RunFailed: RUN_FAILED, EnvironmentLacking: MACHINE_LACKS}
ONE_INTERRUPT_S = 0.1
"""Time within which several signals are one interrupt: `timeout` of GNU signals a command and then its group."""
RAISED_AGAIN_AFTER_S = 0.01
"""Time after which an interrupt is raised again that fell into a function whose errors Python ignores."""
INTERRUPTED_TWICE = "interrupted twice, stopped at once; run the same command again"


PANELS: dict[str, tuple[Callable[..., int | None], ...]] = {
    "Make data": (
        *(plan, preview, release, simulate, render, assemble),
        *(import_logs, rerender, model),
    ),
    "Hardware in the loop": (hil, firmware),
    "Look at data": (view, video, report, contact_sheet),
    "Inspect data and machine": (verify, compare, baselines, train, doctor, schema),
    "Keep, convert and share data": (status, repair, sign, bag, export, pack, upload, download),
    "Explain measured data": (inspect, diagnose, next_trial, identify_camera),
}
"""Commands by their heading, both in the order of `symolo --help`."""
NAMES: dict[Callable[..., int | None], str] = {import_logs: "import", next_trial: "next"}
"""Commands with another name than their function, which Python reserves or has as a function."""
CONTINUED = (
    *("release", "simulate", "render", "assemble", "hil", "rerender"),
    *("repair", "upload", "download"),
)
"""Commands that keep what was finished before an interrupt; the others begin again."""


@cache
def command_line() -> TyperGroup:
    """Return all commands, grouped as `--help` lists them.

    A program that calls `main` several times builds them once, because that takes longer than a short command.
    """
    app = typer.Typer(
        name="symolo",
        help="Make a photorealistic dataset of a small mobile robot from a YAML scenario, check it, and explain how a "
        "simulated robot differs from a real one. `symolo COMMAND --help` explains a command.",
        epilog=EPILOG,
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback()(_options)
    for panel, commands in PANELS.items():
        for command in commands:
            app.command(NAMES.get(command), help=_joined(command), rich_help_panel=panel)(command)
    for name, group, panel in (
        ("case", case, "Explain measured data"),
        ("look", look, "Explain measured data"),
        ("effect", effect, "Make data"),
        ("sensor", sensor, "Make data"),
        ("robot", robot, "Make data"),
        ("arena", arena, "Make data"),
        ("validate", validate, "Look at the robot's parts"),
    ):
        commands = typer.Typer(no_args_is_help=True)
        for command in group.COMMANDS:
            commands.command(command.__name__.strip("_").replace("_", "-"), help=_joined(command))(command)
        app.add_typer(commands, name=name, help=group.HELP, rich_help_panel=panel)
    return get_group(app)


def _joined(command: Callable[..., int | None]) -> str:
    """Return the docstring with one line for each paragraph; Typer would keep the line breaks of the source."""
    return "\n\n".join(" ".join(paragraph.split()) for paragraph in (command.__doc__ or "").split("\n\n"))


def _print_version(requested: bool) -> None:  # noqa: FBT001 - what typer calls back with
    if requested:
        from symolo.core.versions import installed_version  # noqa: PLC0415 - half of the time that --help takes

        typer.echo(f"symolo {installed_version('symolo')}")
        raise typer.Exit


def _options(
    *,
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
    effect_file: Annotated[
        list[Path] | None,
        typer.Option(
            envvar="SYMOLO_EFFECT_FILES", metavar="FILE", help="Python file that defines an effect; may be repeated."
        ),
    ] = None,
    sensor_file: Annotated[
        list[Path] | None,
        typer.Option(
            envvar="SYMOLO_SENSOR_FILES", metavar="FILE", help="Python file that defines a sensor; may be repeated."
        ),
    ] = None,
    controller_file: Annotated[
        list[Path] | None,
        typer.Option(
            envvar="SYMOLO_CONTROLLER_FILES",
            metavar="FILE",
            help="Python file that defines the controller of the robot.",
        ),
    ] = None,
    controller_command: Annotated[
        str | None,
        typer.Option(
            envvar="SYMOLO_CONTROLLER_COMMAND",
            metavar="COMMAND",
            help="Program that controls the robot by lines of JSON, such as 'python3 my_controller.py'.",
        ),
    ] = None,
) -> None:
    del version  # its callback has printed it
    if effect_file or sensor_file or controller_file or controller_command:
        from pipeline.user_code import FAMILIES, PROGRAM  # noqa: PLC0415 - loads NumPy, which --help does not need

        for family, paths in zip(FAMILIES, (effect_file, sensor_file, controller_file), strict=True):
            for path in paths or ():
                family.load(path)
        if controller_command:
            PROGRAM.choose(controller_command)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code."""
    with _streams_open(), _interrupts_noted() as interrupted:
        return _run(arguments, interrupted)


@contextmanager
def _streams_open() -> Iterator[None]:
    """Open the null device in place of each standard stream that is closed, and thus None, as under some daemons."""
    with ExitStack() as stack:
        for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
            if getattr(sys, name) is None:
                setattr(sys, name, stack.enter_context(Path(os.devnull).open(mode, encoding="utf-8")))
                stack.callback(setattr, sys, name, None)
        yield


def _run(arguments: Sequence[str] | None, interrupted: threading.Event) -> int:
    try:
        check_address_space()
        code = command_line()(arguments, standalone_mode=False)
    except typer.TyperException as error:
        return _fail(BAD_INPUT, _usage_problem(error))
    except (InputError, RunFailed, EnvironmentLacking) as error:
        code = next(code for kind, code in CODE_OF.items() if isinstance(error, kind))
        return _fail(code, str(error))
    except (KeyboardInterrupt, typer.Abort):
        return _interrupted(arguments)
    except SystemExit:
        return 0  # typer ends so when the reader of our output is gone, as in `symolo schema | head`
    except Exception as error:  # noqa: BLE001 - the last line of defence gives a bug its exit code
        if interrupted.is_set():
            return _interrupted(arguments)
        if problem := extra_lacking(error) or lacking(error):
            return _fail(MACHINE_LACKS, one_line(problem))
        from pipeline.user_code import fault_of_user_code  # noqa: PLC0415 - loads NumPy, which --help does not need

        if fault := fault_of_user_code(error):
            return _fail(BAD_INPUT, str(fault))
        traceback.print_exc()
        return _fail(BUG, "this is a bug in symolo; please report it with the lines above")
    return _interrupted(arguments) if code == INTERRUPTED else int(code or 0)


@contextmanager
def _interrupts_noted() -> Iterator[threading.Event]:
    """Set the event at a SIGINT or SIGTERM, which raises KeyboardInterrupt; a later one ends the process at once.

    Further signals within `ONE_INTERRUPT_S` belong to the first one. The event is needed because a library may turn a
    KeyboardInterrupt into another error. Python ignores one in a destructor or in the callback of a weak reference;
    then it is raised again.
    """
    noted = threading.Event()
    noted_at_s = 0.0
    again: threading.Timer | None = None

    def note(number: int, _frame: FrameType | None) -> None:
        nonlocal noted_at_s, noted_number, again
        if again is not None:
            again = None
            raise KeyboardInterrupt
        if noted.is_set() and monotonic() - noted_at_s < ONE_INTERRUPT_S:
            return
        if noted.is_set():
            # Workers end themselves when their pipe closes; the files on the disk are complete at any moment.
            os.write(2, f"symolo: {INTERRUPTED_TWICE}\n".encode())
            os._exit(INTERRUPTED)
        noted_at_s, noted_number = monotonic(), number
        noted.set()
        raise KeyboardInterrupt

    def raise_again(lost: "sys.UnraisableHookArgs") -> None:
        """Raise the interrupt again when the function in which Python ignores errors has ended."""
        nonlocal again
        if not (noted.is_set() and issubclass(lost.exc_type, KeyboardInterrupt)):
            unraisable_before(lost)
            return
        main_thread = threading.main_thread().ident or 0
        again = threading.Timer(RAISED_AGAIN_AFTER_S, signal.pthread_kill, (main_thread, noted_number))
        again.daemon = True
        again.start()

    noted_number = signal.SIGINT
    unraisable_before, sys.unraisablehook = sys.unraisablehook, raise_again
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    # Signals that are ignored, as SIGINT is in a background job, stay ignored.
    handled = [n for n, handler in before.items() if handler in {signal.default_int_handler, signal.SIG_DFL}]
    for number in handled:
        signal.signal(number, note)
    try:
        yield noted
    finally:
        if again is not None:
            again.cancel()
        sys.unraisablehook = unraisable_before
        for number in handled:
            signal.signal(number, before[number])


def _usage_problem(error: typer.TyperException) -> str:
    """Return what is wrong with the arguments; an option of all commands may stand at the wrong place."""
    context, name = getattr(error, "ctx", None), getattr(error, "option_name", None)
    if context is not None and name in {option for each in context.find_root().command.params for option in each.opts}:
        return f"write {name} before the command: symolo {name} ... {context.info_name}"
    names = []
    while context is not None and context.parent is not None:
        names.append(context.info_name)
        context = context.parent
    message = error.format_message().replace("Value error, ", "").rstrip(".?")
    return f"{message}; see {' '.join(['symolo', *reversed(names)])} --help"


def _fail(code: int, text: str) -> int:
    typer.echo(f"symolo: {text}", err=True)
    return code


def _interrupted(arguments: Sequence[str] | None) -> int:
    """Report an interrupt, and what the same command does when it is run again."""
    words = sys.argv[1:] if arguments is None else arguments
    # Each option that may stand before the command has a value.
    command = next((b for a, b in pairwise(("", *words)) if b[:1] != "-" and (a[:1] != "-" or "=" in a)), "")
    if command in CONTINUED:
        return _fail(INTERRUPTED, "interrupted, nothing is lost; run the same command again to continue")
    return _fail(INTERRUPTED, "interrupted; run the same command again, which then begins from the start")
