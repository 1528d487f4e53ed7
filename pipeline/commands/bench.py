"""Commands that put a part of the robot on a bench: what the simulation makes of it, beside what is known."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.commands.options import Out, Robot, checked_input

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    from configs.schema.robot import RobotConfig

HELP = "Put a part of the robot on a bench: what the simulation makes of it, beside what is known, as JSON and plot."

Seed = Annotated[int, typer.Option("--seed", min=0, max=2**63 - 1, metavar="N", help="Seed of all that is drawn.")]


def _checked(path: Path | None) -> Path | None:
    return None if path is None else checked_input(path)


def motor(out: Out, robot: Robot = "nominal", seed: Seed = 1) -> None:
    """Motor and gearbox: Table 1 and its fits, steady states, steps, stiction, energy.

    Writes motor.json and motor.png. Example: symolo bench motor --out bench
    """
    from diagnosis.validation.motor.bench import check_motor, motor_bench, summary

    with _bench(out, robot, seed, check_motor) as bench:
        from diagnosis.validation.motor.plot import motor_picture

        result = motor_bench(bench.robot)
        bench.write("motor", result, motor_picture(result))
    for text in summary(result):
        typer.echo(text)


def line(out: Out, robot: Robot = "nominal", seed: Seed = 1) -> None:
    """Line sensor: across the tape at two heights, spread of the channels, converter, threshold.

    Writes line.json and line.png. Example: symolo bench line --out bench
    """
    from diagnosis.validation.line_sensor.bench import check_line, line_bench, summary

    with _bench(out, robot, seed, check_line) as bench:
        from diagnosis.validation.line_sensor.plot import line_picture

        result = line_bench(bench.robot, seed)
        bench.write("line", result, line_picture(result))
    for text in summary(result):
        typer.echo(text)


def tof(
    out: Out,
    robot: Robot = "nominal",
    seed: Seed = 1,
    *,
    scan: Annotated[
        Path | None,
        typer.Option(metavar="DIR", callback=_checked, help="Folder of real scans over an edge, columns x, y, lidar."),
    ] = None,
    static: Annotated[
        Path | None,
        typer.Option(metavar="DIR", callback=_checked, help="Folder of long real records of a sensor at rest."),
    ] = None,
    readings: Annotated[
        int,
        typer.Option(
            min=10,
            max=1_000_000,
            metavar="N",
            help="Of each surface at 100 mm. Tables 3 and 4 stay open with fewer than 5000.",
        ),
    ] = 5001,
) -> None:
    """Range sensor: the paper's experiments 1 to 5, and real scans and records beside the model.

    Writes tof.json and tof.png, and of real files tof_measured.json and tof_measured.png. Takes about two minutes.

    Example: symolo bench tof --out bench
    """
    from diagnosis.validation.range_sensor.experiments import check_tof, summary, tof_bench
    from diagnosis.validation.range_sensor.recordings.comparison import compare, read_measured

    measured = read_measured(scan, static)
    with _bench(out, robot, seed, check_tof) as bench:
        from diagnosis.validation.range_sensor.plot import tof_picture
        from diagnosis.validation.range_sensor.recordings.plot import measured_picture

        result = tof_bench(bench.robot, bench.seed, readings)
        bench.write("tof", result, tof_picture(result))
        lines = summary(result)
        if measured.scans or measured.static:
            found = compare(bench.robot, bench.seed, measured)
            bench.write("tof_measured", found, measured_picture(found))
            lines += [f"real    {finding}" for finding in found.findings]
    for text in lines:
        typer.echo(text)


COMMANDS = (motor, line, tof)
"""In the order of `symolo bench --help`."""


@dataclass(frozen=True)
class _Bench:
    """A robot on the bench, and the folder that takes what comes out."""

    robot: "RobotConfig"
    out: Path
    seed: int

    def write(self, name: str, result: "DataclassInstance", picture: bytes) -> None:
        """Put `name`.png and `name`.json in place; the result is a dataclass of numbers, texts, tuples and its like."""
        from dataclasses import asdict

        from symolo.core.atomic_files import write_file
        from symolo.core.file_hashes import canonical_json

        robot = self.robot.model_dump(mode="json", exclude_none=True)
        text = canonical_json({"bench": name, "seed": self.seed, "robot": robot, "result": asdict(result)})
        write_file(self.out / f"{name}.png", picture)
        write_file(self.out / f"{name}.json", text)
        typer.echo(f"{self.out / name}.json, {self.out / name}.png")


@contextmanager
def _bench(out: Path, robot: str, seed: int, check: "Callable[[RobotConfig], None]") -> "Iterator[_Bench]":
    """The robot, drawn and checked, and the folder held; what is wrong with either is said before any work starts."""
    from configs.draw import draw_robot
    from configs.loader import load_section
    from pipeline.run_folder.output import check_out
    from pipeline.run_folder.workspace import Workspace
    from symolo.dataset.folder_kind import Kind

    config, _ = draw_robot(load_section("robot", robot), seed, "bench")
    check(config)
    check_out(out, Kind.BENCH)
    with Workspace(out.absolute(), Kind.BENCH).locked():
        yield _Bench(config, out, seed)
