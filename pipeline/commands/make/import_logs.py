"""`symolo import`: makes a dataset of logs of other programs."""

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.commands.log_options import (
    BodyAt,
    Forward,
    HeadingFromPath,
    LogFormat,
    Logs,
    Mapping,
    PoseHz,
    RowHz,
    Topics,
    Up,
    Yes,
    checked_name,
    describe_logs,
    read_settings,
)
from pipeline.commands.options import (
    DryRun,
    Out,
    Replace,
    absent_file_check,
    if_given,
)
from symolo.core.errors import InputError

if TYPE_CHECKING:
    from logs.trajectories.base import ReadSettings
    from pipeline.importing.imported_runs import ImportedDataset, ImportRequest


def import_logs(
    logs: Logs,
    *,
    out: Out,
    form: LogFormat = None,
    mapping: Mapping = None,
    yes: Yes = False,
    arena: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Shipped arena, or a YAML file, in which the robot drove; by default an empty floor that fits the "
            "paths, or that of SyMoLo for a data.csv.",
        ),
    ] = None,
    robot: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="Shipped robot, or a YAML file, whose camera would take images; by default nominal."
        ),
    ] = None,
    up: Up = None,
    forward: Forward = None,
    heading_from_path: HeadingFromPath = False,
    body_at: BodyAt = None,
    pose_hz: PoseHz = None,
    row_hz: RowHz = None,
    topic: Topics = None,
    route: Annotated[str, typer.Option(metavar="NAME", help="Name of the route, and of the folder of the runs.")] = (
        "imported"
    ),
    name: Annotated[
        str | None, typer.Option(metavar="NAME", help="Name of the dataset; by default that of the first log.")
    ] = None,
    licence: Annotated[
        str, typer.Option(metavar="SPDX", help="Licence of the logs, such as CC-BY-4.0.")
    ] = "NOASSERTION",
    save_map: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.yaml",
            callback=if_given(absent_file_check(".yaml", ".yml", option="--save-map")),
            help="Write the mapping with which a table is read into a new file, to edit it and give it with --map; "
            "also with --dry-run.",
        ),
    ] = None,
    replace: Replace = False,
    dry_run: DryRun = False,
) -> None:
    """Import logs of other programs as a dataset: tables with any columns, TUM, KITTI, EuRoC, Motive, bags of ROS.

    Times and poses are enough. What a log also holds, such as speeds and ranges, gets its column in data.csv; other
    columns of numbers get a table of their own. Images, laser scans and IMUs of a bag become sensors of the robot. What
    nobody measured is absent, and nothing is invented.

    Of a table, the command recognises columns and units from names such as `time_ms`, `x [mm]` or `heading_deg`, and
    units that no name states from the motion that they would give. It prints what it guessed and asks; --yes accepts
    it, and --map gives a file that says it.

    `verify`, `report`, `export` and `diagnose` take the dataset, and `rerender` renders images for a run of it.

    Example: symolo import run.csv --out measured

    Images for it: symolo rerender measured/imported/test_1 --looks classroom,lab --camera-hz 5
    """
    from pipeline.importing.imported_runs import ImportRequest, imported_dataset
    from pipeline.importing.write import check_place, write_dataset
    from symolo.core.files.atomic_files import write_file
    from symolo.core.progress import plural, report_here

    settings = read_settings(mapping, up, forward, pose_hz, topic, heading_from_path=heading_from_path, body_at=body_at)
    request = ImportRequest(
        tuple(logs), form, settings, row_hz, arena, robot, checked_name("--route", route), name, licence
    )
    if name is not None:
        checked_name("--name", name)
    dataset = imported_dataset(request)
    report = report_here()
    check_place(dataset, out, report, replace=replace, dry_run=dry_run)
    saved_map = _mapping_text(dataset, _command_with(save_map, request, out)) if save_map is not None else ""
    describe_logs(dataset, yes=yes or dry_run)
    if save_map is not None:
        write_file(save_map, saved_map.encode())
        typer.echo(f"{save_map}: which column is which quantity, for --map")
    if dry_run:
        return
    write_dataset(dataset, out, report, replace=replace)
    rows = sum(len(run.rows.t_ms) for run in dataset.runs)
    typer.echo(f"{out}: {plural(len(dataset.runs), 'run')}, {plural(rows, 'row')}")
    first = out / dataset.runs[0].spec.key
    command = [
        "symolo",
        "rerender",
        str(first),
        "--looks",
        "classroom,lab",
        "--camera-hz",
        "5",
        "--out",
        f"{out}-images",
    ]
    typer.echo(f"\n{shlex.join(command)}")


def _mapping_text(dataset: "ImportedDataset", command: Sequence[str]) -> str:
    """Return the mapping file of the only log; `command` reads the log with it.

    Raises:
        InputError: There are several logs, or the log is no table.
    """
    from logs.log_file import read_log
    from logs.mapping import mapping_text
    from logs.trajectories.quantities import TRAJECTORY

    log, *others = dataset.logs
    if others or log.trajectory.mapping is None:
        got = f"{len(dataset.logs)} trajectories" if others else log.origin.format
        raise InputError("--save-map", got=got, allowed="one table, which alone has a mapping")
    return mapping_text(log.trajectory.mapping, TRAJECTORY, read_log(log.path, log.trajectory.mapping.header), command)


def _command_with(mapping: Path, request: "ImportRequest", out: Path) -> list[str]:
    """Return the command that imports a table with a mapping file and the other options of a request."""
    settings, usual = request.settings, type(request)(request.paths)
    options = {
        "--format": (request.format, usual.format),
        "--up": (settings.up, usual.settings.up),
        "--forward": (settings.forward, usual.settings.forward),
        "--body-at": (_body_at(settings), _body_at(usual.settings)),
        "--row-hz": (request.row_hz, usual.row_hz),
        "--arena": (request.arena, usual.arena),
        "--robot": (request.robot, usual.robot),
        "--route": (request.route, usual.route),
        "--name": (request.name, usual.name),
        "--licence": (request.licence, usual.licence),
    }
    words = [word for option, (value, default) in options.items() if value != default for word in (option, f"{value}")]
    heading = ["--heading-from-path"] if settings.heading_from_path else []
    logs = [str(path) for path in request.paths]
    return ["symolo", "import", *logs, "--map", str(mapping), *words, *heading, "--out", str(out)]


def _body_at(settings: "ReadSettings") -> str:
    return "" if settings.body_at_m is None else "{:g},{:g}".format(*settings.body_at_m)
