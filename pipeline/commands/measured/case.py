"""Commands that make measured cases: `symolo case init`, `symolo case example`."""

import shlex
import sys
from collections.abc import Mapping
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.commands.options import NewFolder, checked_input, checked_new_folder, if_given
from symolo.core.errors import InputError, nearest

if TYPE_CHECKING:
    from diagnosis.new_case.new_case import NewCase

HELP = "Make a measured case, which is a folder that `symolo diagnose` reads."


def init(
    log: Annotated[
        Path, typer.Argument(metavar="LOG", callback=checked_input, help="Table with a header line, as CSV.")
    ],
    *,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="CASE",
            callback=if_given(checked_new_folder),
            help="Folder to make, new or empty; by default the name of the log without its ending.",
        ),
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="A number that you know, such as wheel_diameter_m=0.065; may be repeated. The command prints the keys "
            "that matter for the log.",
        ),
    ] = None,
    kind: Annotated[
        str | None,
        typer.Option(
            metavar="KIND",
            help="motor_steady, motor_step, tof_bench or drive_log; by default recognised from the columns.",
        ),
    ] = None,
    column: Annotated[
        list[str] | None,
        typer.Option(
            "--column",
            metavar="QUANTITY=COLUMN",
            help="Column of a quantity whose column is not recognised by its name, such as t_s=loop_ms; may be "
            "repeated. The others are recognised.",
        ),
    ] = None,
    unit: Annotated[
        list[str] | None,
        typer.Option(
            "--unit",
            metavar="QUANTITY=UNIT",
            help="Unit of a quantity in the log, such as t_s=ms or u_left_V=duty_255 for a duty cycle of which 255 is "
            "full; may be repeated. By default that of the name of the column, or the one that the values show.",
        ),
    ] = None,
    names: Annotated[
        str | None,
        typer.Option(
            "--names",
            metavar="NAME,NAME,...",
            help="Names of the columns of a log without a header line, from left to right.",
        ),
    ] = None,
    mapping: Annotated[
        Path | None,
        typer.Option(
            "--mapping",
            "--map",
            metavar="FILE",
            callback=if_given(checked_input),
            help="Mapping file: which column of the log, in which unit, is which quantity. By default it is proposed "
            "from the names of the columns.",
        ),
    ] = None,
) -> None:
    """Make a measured case from the log of your own robot or test bench, whatever its columns are called.

    The command recognises columns and units from names such as `time_ms`, `x_cm`, `heading_deg` or `encL`. It
    converts them to SI units, samples a drive 20 times a second, and holds out a quarter of the rows. It asks for the
    numbers that no log contains, such as the diameter of the wheels; press Enter for a number that you do not know.
    Without a terminal it asks nothing, and takes the numbers of --set.

    A number that you do not know is estimated from the log or set to a usual value, with a tolerance so wide that no
    effect is named in its place. The command prints what each of them would have allowed.

    CASE then has three files:

    - data.csv: the rows, in symolo's columns and units

    - nominal.yaml: parameters with tolerances, each with a comment

    - mapping.yaml: which column became which; correct it and give it with --mapping

    Example: symolo case init run.csv --out my_case --set wheel_diameter_m=0.065 --set track_m=0.14

    Example: symolo case init run.csv --column t_s=loop_ms --out my_case

    Example: symolo case init run.csv --unit u_left_V=duty_255 --unit u_right_V=duty_255 --out my_case

    Example: symolo case init run.csv --mapping my_case/mapping.yaml --out my_case_2
    """
    from diagnosis.measured.measurement import CaseKind
    from diagnosis.new_case.known_numbers import parsed
    from diagnosis.new_case.new_case import new_case
    from diagnosis.new_case.proposal import chosen_columns, propose, stated_units
    from diagnosis.new_case.quantities import KINDS
    from diagnosis.new_case.room_corner import from_corner
    from logs.log_file import read_log
    from logs.mapping import check_mapping, read_mapping
    from symolo.core.files.new_folder import check_new

    out = out or Path(log.stem)
    check_new(out)
    kinds = [str(one) for one in KINDS]
    if kind is not None and kind not in kinds:
        raise InputError("--kind", got=kind, allowed=", ".join(kinds), nearest=nearest(kind, kinds))
    known = parsed(settings or ())
    _check_origin(log)
    for option, values, what in (
        ("--column", column, "names every column that is to be read"),
        ("--unit", unit, "names the unit of every column"),
        ("--names", names, "has the names of the columns as header"),
    ):
        if values and mapping is not None:
            raise InputError(f"{option}: a mapping file {what}", cure="leave one of the two out, or edit the mapping")
    checked = None if mapping is None else read_mapping(mapping, list(KINDS.values()))
    header = [name.strip() for name in names.split(",")] if names else []
    table = read_log(log, header if checked is None else checked.header)
    stated_kind = None if kind is None else CaseKind(kind)
    units = stated_units(unit or (), stated_kind)
    columns = chosen_columns(column or (), table, stated_kind, units)
    if checked is not None:
        check_mapping(checked, KINDS[CaseKind(checked.kind)], table, str(mapping))

    def case_knowing(known: Mapping[str, float]) -> "tuple[NewCase, tuple[str, ...]]":
        """Return the case and the guesses of its mapping, which depend on the voltage of the supply."""
        chosen, warnings = checked, ()
        if chosen is None:
            proposal = propose(table, stated_kind, known.get("supply_voltage_V"), columns, units)
            chosen, warnings = proposal.mapping, proposal.warnings
        chosen = from_corner(chosen, known)
        return new_case(table, chosen, out.absolute().name).knowing(known), warnings

    case, warnings = case_knowing(known)
    if sys.stdin.isatty() and sys.stdout.isatty():
        case, warnings = case_knowing({**known, **_typed_numbers(case)})
    measurement = case.write(out)
    notes = [*case.measurement.notes, *(note for note in measurement.notes if not note.startswith("not logged"))]
    unused = sorted(case.known.keys() - {number.key for number in case.numbers})
    notes += [f"not needed for what was logged: {', '.join(unused)}"] if unused else []
    _print(case, out, (*warnings, *dict.fromkeys(notes)))


def _check_origin(log: Path) -> None:
    """Refuse a table of a run of symolo, whose other tables and noise are known to the diagnosis.

    Raises:
        InputError: It is such a table.
    """
    from logs.recognition import first_line
    from symolo.dataset.layout import DATA, SIDE
    from symolo.dataset.tables.side_tables import WHEELS

    header = first_line(log).split(",")
    run = log.parent.parent if log.parent.name == SIDE else log.parent
    if header == list(WHEELS.header) or (log.name == DATA and (log.parent / SIDE / WHEELS.file).is_file()):
        cure = "diagnose the folder of the run from which it was copied, the one with data.csv"
        if (run / DATA).is_file():
            cure = f"diagnose the run: {_diagnose(run, run.absolute().name)}"
        raise InputError("is a table of a run of symolo, which needs no case", where=str(log), cure=cure)


def _typed_numbers(case: "NewCase") -> dict[str, float]:
    """Return the numbers that the user types; Enter leaves one out."""
    from diagnosis.new_case.known_numbers import missing, value_of

    typer.echo("Please enter the numbers that you know. Press Enter for a number that you do not know.")
    answers = {}
    for number in missing(case.numbers, case.known):
        while True:
            text = typer.prompt(f"{number.title}, {number.key}", default="", show_default=False).strip()
            try:
                answers |= {number.key: value_of(text, number)} if text else {}
            except InputError as error:
                typer.echo(str(error))
            else:
                break
    return answers


def _print(case: "NewCase", out: Path, notes: tuple[str, ...]) -> None:
    from diagnosis.measured.measurement import CHECK
    from diagnosis.measured.overview import summary_line
    from logs.mapping import unused_columns

    checks = tuple(note for note in notes if note.startswith(CHECK))
    typer.echo(summary_line(case.measurement))
    for check in checks:
        typer.echo(check)
    if checks:
        typer.echo(f"If that is a mistake, correct {out / 'mapping.yaml'} or a number, and make the case again.\n")
    for name, source in case.mapping.columns.items():
        typer.echo(f"  {name:16}from {source.text}")
    unused = unused_columns(case.mapping, case.log)
    for line in (*([f"not used: {', '.join(unused)}"] if unused else []), *case.compared()):
        typer.echo(line)
    for note in notes:
        if note not in checks:
            typer.echo(f"note: {note}")
    unknown = case.unknown()
    if unknown:
        typer.echo("\nNot given; each can be added with --set KEY=VALUE, or in nominal.yaml:")
        for line in unknown:
            typer.echo(f"  {line}")
    typer.echo(f"\n{out}: look at its nominal.yaml, then\n\n{_diagnose(out, str(out))}")


def example(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="Name of an example, or a kind of case, such as motor_steady.")
    ],
    *,
    out: NewFolder,
) -> None:
    """Copy a small example case, on which the diagnosis can be tried without a robot.

    A simulation with hidden effects made the examples. There are two or more of each kind: motor_steady, motor_step,
    tof_bench and drive_log. The command prints which effects the case hides, so that you can compare the diagnosis with
    the truth.

    Example: symolo case example motor_steady --out my_case
    """
    from diagnosis.examples.example import example_of

    case = example_of(name)
    case.copy(out)
    typer.echo(f"{out}: the example {case.name} of the kind {case.kind}")
    note = f" {case.note}" if case.note else ""
    text = f"It hides {_hidden(case.hidden)}.{note} See whether the diagnosis names that:"
    typer.echo("\n".join(wrap(text, 118, break_long_words=False, break_on_hyphens=False)) + "\n")
    typer.echo(_diagnose(out, str(out)))


def _diagnose(folder: Path, name: str) -> str:
    """Return the command that diagnoses a folder, as the user can type it."""
    return shlex.join(["symolo", "diagnose", str(folder), "--out", f"{name}-diagnosis"])


def _hidden(effects: Mapping[str, Mapping[str, object]]) -> str:
    texts = []
    for name, parameters in effects.items():
        numbers = ", ".join(
            f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}" for key, value in parameters.items()
        )
        texts.append(f"{name} ({numbers})" if numbers else name)
    return " and ".join(texts) or "no effect"


COMMANDS = (init, example)
