"""The command `symolo next`: the trial that distinguishes the remaining explanations of a diagnosis."""

import os
import shlex
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import Json, NewFolder, checked_input, in_one_thread, load_effects
from symolo.core.errors import InputError


def next_trial(
    diagnosis: Annotated[
        Path,
        typer.Argument(
            metavar="DIAGNOSIS",
            # The check of --out loads NumPy, whose threads must be limited before.
            is_eager=True,
            callback=in_one_thread(checked_input),
            help="Output folder of `symolo diagnose`, with made_from.json.",
        ),
    ],
    *,
    out: NewFolder,
    seconds: Annotated[
        float | None,
        typer.Option(min=0.1, max=3600.0, metavar="S", help="Time of the whole trial; 15 s by default."),
    ] = None,
    rows: Annotated[
        int | None,
        typer.Option(min=1, max=400, metavar="N", help="Number of rows, runs or manoeuvres, in place of --seconds."),
    ] = None,
    row_seconds: Annotated[
        float | None,
        typer.Option(
            "--row-seconds",
            min=0.01,
            max=600.0,
            metavar="S",
            help="Time of one row of a bench, by default that of the old rows; of one run of a step log, by default 3 "
            "s; or of one manoeuvre of a drive, by default 5 s.",
        ),
    ] = None,
    max_voltage: Annotated[
        float | None,
        typer.Option(
            "--max-voltage",
            min=0.01,
            max=60.0,
            metavar="V",
            help="Highest voltage of a motor, in both directions; by default the largest of the old data, of either "
            "sign.",
        ),
    ] = None,
    one_direction: Annotated[
        bool, typer.Option("--one-direction", help="Never reverse the motor, in which case no voltage is negative.")
    ] = False,
    distances: Annotated[
        str | None,
        typer.Option(
            metavar="NEAR:FAR", help="Distances of a range bench in metres; by default those of the old data."
        ),
    ] = None,
    floor: Annotated[
        str | None,
        typer.Option(
            metavar="WxH",
            help="Size in metres of the free floor of a drive along x and y, around the middle of the room; by default "
            "the room of nominal.yaml, or else the rectangle around the old poses.",
        ),
    ] = None,
    max_speed: Annotated[
        float | None,
        typer.Option(
            "--max-speed",
            min=0.01,
            max=5.0,
            metavar="M/S",
            help="Highest speed of a wheel of a drive over the floor; by default the highest of the old data.",
        ),
    ] = None,
    effects: Annotated[
        list[Path] | None,
        typer.Option("--effects", metavar="FILE", help="File of an effect of your own that the diagnosis tried, too."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Design the trial that distinguishes the remaining explanations of a diagnosis.

    A diagnosis may leave several effects that explain the data equally well. This command designs the measurement in
    which their predictions differ most, within your limits, and says how surely it will decide. Where one effect
    remains, the trial determines its parameters as precisely as possible. The cases may be steady states or step logs
    of a motor, a range bench, or drives.

    The command diagnoses the old case again, which takes as long as it did before, and writes these files into OUT:

    - trial.md: what to set, what to log, and what to expect; the command prints it

    - trial_1/: a case to fill; data.csv has the inputs of each row, and empty cells for your readings

    - voltages.h: the voltages of a motor as C arrays, for the program of a board

    - wheel_speeds.h, path.csv, path.png: the set points of the wheels of a drive, and its path

    - scenario.yaml, next_drive.py: a scenario and a controller with which `symolo release` simulates the drive

    - predictions.csv, expected.json: what each explanation predicts, and all figures for programs

    Then diagnose the old and the new case together.

    Example: symolo next diagnosis --out next

    Ten rows of 2 s, forward only: symolo next diagnosis --rows 10 --row-seconds 2 --one-direction --out next

    A drive of 20 s on a small floor: symolo next diagnosis --seconds 20 --floor 1.2x0.8 --out next

    Then: symolo diagnose bench next/trial_1 --together --out diagnosis_2
    """
    import json

    from diagnosis.next_trial.design import design_trial
    from diagnosis.next_trial.files import INSTRUCTIONS, case_name, trial_files
    from diagnosis.next_trial.files import as_json as in_json
    from diagnosis.next_trial.limits import limits_of
    from pipeline.diagnosing.diagnose import diagnosed_again, read_case
    from pipeline.diagnosing.made_from import read_made_from
    from symolo.core.files.new_folder import check_new
    from symolo.core.progress import report_here

    check_new(out)
    if seconds is not None and rows is not None:
        raise InputError("--seconds and --rows", cure="give one of them")
    load_effects(effects or ())
    made_from = read_made_from(diagnosis)
    settings = made_from.settings
    measurement = read_case(made_from.paths[0], settings)
    distances_m = None if distances is None else _range(distances)
    floor_m = None if floor is None else _floor(floor)
    with _placed_in(diagnosis):
        limits = limits_of(
            measurement,
            seconds=seconds,
            rows=rows,
            row_s=row_seconds,
            max_voltage_V=max_voltage,
            one_direction=one_direction,
            distances_m=distances_m,
            floor_m=floor_m,
            max_speed_m_s=max_speed,
        )
    report = report_here()
    diagnosed = diagnosed_again(measurement, settings, report)
    with _placed_in(diagnosis):
        design = design_trial(diagnosed, limits, report.say)
    command = _command(made_from.paths, out / case_name(design))
    contents = trial_files(design, command, _simulation(out, diagnosis))
    _write(contents, out)
    if as_json:
        typer.echo(json.dumps(in_json(design), ensure_ascii=False))
        return
    typer.echo(contents[INSTRUCTIONS].decode("utf-8"))
    typer.echo(f"{out / INSTRUCTIONS}, {out / case_name(design) / 'data.csv'}")


def _write(contents: Mapping[str, bytes], out: Path) -> None:
    """Write the files of a trial into a new folder, all of them or none."""
    from symolo.core.files.atomic_files import make_folder, write_file
    from symolo.core.files.new_folder import new_folder

    with new_folder(out) as folder:
        for name, data in contents.items():
            make_folder((folder / name).parent)
            write_file(folder / name, data)


@contextmanager
def _placed_in(diagnosis: Path) -> Iterator[None]:
    """Add the folder of the diagnosis to an InputError of the block, which knows only the measured data."""
    try:
        yield
    except InputError as error:
        raise InputError(str(error), where=str(diagnosis)) from error


def _range(text: str) -> tuple[float, float]:
    """Return two numbers that are joined with a colon."""
    try:
        near, far = (float(part) for part in text.split(":"))
    except ValueError:
        raise InputError("--distances", got=text, allowed="two numbers of metres, such as 0.05:1.2") from None
    if not 0.0 < near < far <= 10.0:
        raise InputError("--distances", got=text, allowed="0 < NEAR < FAR, up to 10 m")
    return near, far


def _floor(text: str) -> tuple[float, float]:
    """Return two sizes that are joined with an x."""
    try:
        along, across = (float(part) for part in text.lower().split("x"))
    except ValueError:
        raise InputError("--floor", got=text, allowed="two numbers of metres, such as 1.2x0.8") from None
    if not (0.0 < along <= 50.0 and 0.0 < across <= 50.0):
        raise InputError("--floor", got=text, allowed="sizes above 0, up to 50 m")
    return along, across


def _simulation(out: Path, diagnosis: Path) -> str:
    """Return the command that simulates a designed drive with the robot of the diagnosis."""
    from diagnosis.extended_robot import FILE
    from diagnosis.next_trial.drive_files import CONTROLLER, SCENARIO

    paths = (out / CONTROLLER, out / SCENARIO, diagnosis / FILE, f"{out}-driven")
    controller, scenario, robot, driven = (shlex.quote(str(path)) for path in paths)
    return f"symolo --controller-file {controller} release {scenario} --set robot={robot} --out {driven}"


def _command(old: Sequence[Path], new: Path) -> str:
    """Return the command that diagnoses the old and the new data together."""
    cases = " ".join(shlex.quote(os.path.relpath(path) if path.exists() else str(path)) for path in old)
    out = f"{new.parent}-diagnosis"
    return f"symolo diagnose {cases} {shlex.quote(str(new))} --together --out {shlex.quote(out)}"
