"""Commands that compare a part of the simulated robot with the real one."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.commands.options import Out, Robot, Seed, checked_input, if_given

if TYPE_CHECKING:
    from diagnosis.validation.experiment import ValidatedPart

HELP = "Compare a part of the simulated robot with formulas, tables and recordings; write JSON files and figures."


def motor(out: Out, robot: Robot = "nominal", seed: Seed = 1) -> None:
    """Check motor and gearbox: Table 1 of the paper and its fits, step responses, stiction, energy.

    The command writes motor.json and motor.png.

    Example: symolo validate motor --out validation
    """
    from diagnosis.validation.motor.experiments import MOTOR

    _validate((MOTOR,), out, robot, seed)


def line_sensor(out: Out, robot: Robot = "nominal", seed: Seed = 1) -> None:
    """Check the line sensor: readings across the tape at two heights, spread of the channels, converter, threshold.

    The command writes line-sensor.json and line-sensor.png.

    Example: symolo validate line-sensor --out validation
    """
    from diagnosis.validation.line_sensor.experiments import LINE_SENSOR

    _validate((LINE_SENSOR,), out, robot, seed)


def range_sensor(
    out: Out,
    robot: Robot = "nominal",
    seed: Seed = 1,
    *,
    scan: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            callback=if_given(checked_input),
            help="Folder of real scans across an edge, as tables with the columns x, y, lidar.",
        ),
    ] = None,
    static: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", callback=if_given(checked_input), help="Folder of long real recordings of a sensor at rest."
        ),
    ] = None,
    readings: Annotated[
        int,
        typer.Option(
            min=10,
            max=1_000_000,
            metavar="N",
            help="Number of readings of each surface at 100 mm. Tables 3 and 4 need at least 5000.",
        ),
    ] = 5001,
) -> None:
    """Check the range sensor: experiments 1 to 5 of the paper, and real scans and recordings compared with the model.

    The command writes range-sensor.json and range-sensor.png; with --scan or --static also range-sensor-recordings.json
    and range-sensor-recordings.png. It takes about two minutes.

    Example: symolo validate range-sensor --out validation
    """
    from diagnosis.validation.range_sensor import experiments
    from diagnosis.validation.range_sensor.recordings.experiments import recordings

    recorded = recordings(scan, static)
    simulated = experiments.range_sensor(readings)
    _validate((simulated, recorded) if recorded else (simulated,), out, robot, seed)


COMMANDS = (motor, line_sensor, range_sensor)
"""Commands in the order of `symolo validate --help`."""


def _validate(parts: "tuple[ValidatedPart, ...]", out: Path, robot: str, seed: int) -> None:
    """Run all experiments of the parts and write a JSON file and a figure for each part.

    A robot or folder that cannot be used is refused before any work starts.
    """
    from configs.draw import draw_robot
    from configs.loader import load_section
    from diagnosis.validation.experiment import result_json
    from diagnosis.validation.panels import figure
    from pipeline.run_folder.output import check_out
    from pipeline.run_folder.workspace import Workspace
    from symolo.core.files.atomic_files import write_file
    from symolo.dataset.folder_kind import Kind

    config, _ = draw_robot(load_section("robot", robot), seed, "bench")
    for part in parts:
        part.require(config)
    check_out(out, Kind.VALIDATION)
    lines = []
    with Workspace(out.absolute(), Kind.VALIDATION).locked():
        for part in parts:
            results = {experiment: experiment.run(config, seed) for experiment in part.experiments}
            panels = [panel for result in results.values() for panel in result.panels]
            write_file(out / f"{part.name}.png", figure(f"{part.name}: robot {config.name}", panels))
            write_file(out / f"{part.name}.json", result_json(part.name, config, seed, results))
            typer.echo(f"{out / part.name}.json, {out / part.name}.png")
            for experiment, result in results.items():
                lines += [f"{experiment.name}: {experiment.shows}", *(f"  {line}" for line in result.lines()), ""]
    typer.echo("\n".join(lines).rstrip())
