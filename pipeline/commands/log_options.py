"""Options with which `import` and `rerender` read logs of other programs, and what they print about these."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from logs.axis import Axis
from pipeline.commands.options import (
    checked_input,
    checked_inputs,
    if_given,
    names,
)
from symolo.core.errors import InputError

if TYPE_CHECKING:
    from logs.trajectories.base import ReadSettings
    from pipeline.importing.imported_runs import ImportedDataset
    from pipeline.importing.log_files import ReadLog
    from pipeline.stages.run_tables import ExternalRun


Logs = Annotated[
    list[Path],
    typer.Argument(metavar="LOG...", callback=checked_inputs, help="Logs: each is one run, or several."),
]


LogFormat = Annotated[
    str | None,
    typer.Option(
        "--format",
        metavar="NAME",
        help="Form of the logs: symolo, tum, kitti, euroc, motive, bag or table; by default recognised from each.",
    ),
]


Mapping = Annotated[
    Path | None,
    typer.Option(
        "--map",
        "--mapping",
        metavar="FILE",
        callback=if_given(checked_input),
        help="Mapping file of a table: which column, in which unit, is which quantity. By default it is proposed from "
        "the names and the values of the columns.",
    ),
]


Yes = Annotated[bool, typer.Option("--yes", help="Accept the guesses that the command prints, without a question.")]


Up = Annotated[
    Axis | None,
    typer.Option(help="Axis of the log's world frame that points up; by default recognised from the poses."),
]


Forward = Annotated[
    Axis | None,
    typer.Option(help="Axis of the tracked body along which the robot drives; by default recognised from the path."),
]


HeadingFromPath = Annotated[
    bool,
    typer.Option(
        "--heading-from-path",
        help="Take the direction of the path for the heading, if none was measured. It is that of the robot only if "
        "the places are those of the middle of the axle, so --body-at is refused beside it.",
    ),
]


PoseHz = Annotated[
    float | None,
    typer.Option(min=0.01, max=100_000, metavar="HZ", help="Rate of the poses of a file without times, as of KITTI."),
]


RowHz = Annotated[
    float | None,
    typer.Option(
        min=0.01, max=1000, metavar="HZ", help="Sample the trajectory again at this rate; by default its times stay."
    ),
]


BodyAt = Annotated[
    str | None,
    typer.Option(
        "--body-at",
        metavar="X,Y",
        help="Place of the tracked body on the robot, in m: x ahead and y to the left of the middle of the axle, such "
        "as 0.05,0 for the camera of the nominal robot; by default 0,0. It needs headings of the log, so "
        "--heading-from-path is refused beside it.",
    ),
]


Topics = Annotated[
    str | None,
    typer.Option(
        "--topic",
        metavar="NAME,...",
        help="Bodies of Motive, topics of a bag or two of its frames such as map:base_link that give the poses; by "
        "default all bodies, or the most likely topic.",
    ),
]


def read_settings(
    mapping: Path | None,
    up: Axis | None,
    forward: Axis | None,
    pose_hz: float | None,
    topic: str | None,
    *,
    heading_from_path: bool,
    body_at: str | None,
) -> "ReadSettings":
    """Return the settings with which a command reads logs, from its options.

    Raises:
        InputError: An option has a wrong value, or the headings are to follow the path of a body beside the axle.
    """
    from logs.trajectories.base import ReadSettings
    from symolo.core.progress import report_here

    if heading_from_path and body_at is not None:
        # Ahead of the axle, the direction of the path differs from the heading by atan(yaw rate * x / speed).
        what = "the direction of the path of a body is the heading of the robot only at the middle of the axle"
        cure = "import headings that were measured, or leave one of the two options out"
        raise InputError(what, where="--heading-from-path and --body-at", cure=cure)
    topics = names(topic, "--topic") if topic is not None else ()
    place_m = _place(body_at) if body_at is not None else None
    return ReadSettings(mapping, up, forward, heading_from_path, pose_hz, place_m, topics, report_here())


def _place(text: str) -> tuple[float, float]:
    """Return the place of a body on the robot, from the text of --body-at."""
    from symolo.core.tables.table import number_of

    x_m, y_m, *others = (*map(number_of, text.split(",")), float("nan"), float("nan"))
    if len(others) != 2 or not (abs(x_m) <= 10 and abs(y_m) <= 10):
        raise InputError("--body-at", got=text, allowed="two lengths in m up to 10, such as 0.05,0")
    return x_m, y_m


def checked_name(option: str, name: str) -> str:
    """Return the name of a folder or dataset.

    Raises:
        InputError: It has other characters than letters, digits, `-` and `_`.
    """
    import re

    from symolo.dataset.layout import NAME_PATTERN

    if not re.match(NAME_PATTERN, name):
        allowed = "letters, digits, '_' and '-', at most 64, beginning with a letter or digit"
        raise InputError(option, got=name, allowed=allowed)
    return name


def describe_logs(dataset: "ImportedDataset", *, yes: bool) -> None:
    """Print how each log is read, and let the user confirm what was guessed.

    Raises:
        InputError: Something was guessed, and nobody confirms it.
    """
    for log, run in zip(dataset.logs, dataset.runs, strict=True):
        _describe(log, run)
    guessed = any(log.trajectory.guesses for log in dataset.logs)
    if not guessed or yes:
        return
    if sys.stdin.isatty() and sys.stdout.isatty():
        if typer.confirm("Is that right?"):
            return
        cure = "write a mapping file, and give it with --map (docs/import.md)"
        raise InputError("nothing was written", cure=cure)
    cure = "repeat the command with --yes if they are right, or give a file that says it with --map (docs/import.md)"
    raise InputError("some columns or units are guesses, see above", cure=cure)


def _describe(log: "ReadLog", run: "ExternalRun") -> None:
    """Print what is probably wrong in a log, which column becomes what, changes, guesses and warnings."""
    from logs.trajectories.table import LOG_TABLE
    from symolo.core.progress import plural
    from symolo.dataset.layout import SIDE

    seconds = run.rows.t_ms[-1] / 1000
    typer.echo(f"{log.title}: {log.origin.format}, {plural(len(run.rows.t_ms), 'pose')}, {seconds:.1f} s")
    changes = (run.spec.origin and run.spec.origin.log and run.spec.origin.log.changes) or ()
    checks = [change for change in changes if change.startswith("CHECK")]
    for check in checks:
        typer.echo(f"  {check}")
    for quantity, source in log.origin.quantities.items():
        typer.echo(f"  {quantity:16} from {source}")
    for table in log.trajectory.tables:
        if table.name == LOG_TABLE:
            typer.echo(f"  {f'{SIDE}/{table.name}.csv':16} from {', '.join(table.columns)}, as they are")
    for change in changes:
        if change not in checks:
            typer.echo(f"  note: {change}")
    for guess in log.trajectory.guesses:
        typer.echo(f"  GUESS {guess}")
    for warning in run.outcome.suspicions:
        typer.echo(f"  WARNING {warning}")
