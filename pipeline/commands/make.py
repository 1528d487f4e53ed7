"""Commands that make data: plan, simulate, render, assemble, release, rerender."""

from collections.abc import Sequence
from enum import IntEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.commands.options import Out, Scenario, Settings, Workers

if TYPE_CHECKING:
    from pipeline.stages.simulate_runs import RunProblem

RUN_FAILED = 3


class Until(IntEnum):
    """The stages in their order."""

    SIMULATE = 1
    RENDER = 2
    ASSEMBLE = 3


def plan(scenario: Scenario, settings: Settings = None) -> None:
    """Say what a scenario would make, how large and how long; write nothing.

    Example: symolo plan symolo --set render.samples=16
    """
    from configs.draw import draw_all  # noqa: PLC0415
    from configs.loader import load_scenario  # noqa: PLC0415
    from pipeline.plan import Plan  # noqa: PLC0415
    from pipeline.workers import cores  # noqa: PLC0415

    typer.echo(Plan.of(draw_all(load_scenario(scenario, settings or ())), cores()).text())


def simulate(scenario: Scenario, out: Out, settings: Settings = None, workers: Workers = None) -> int:
    """First stage: drive every run in PyBullet and store its trajectory and readings.

    Example: symolo simulate smoke --out data
    """
    return _make((Until.SIMULATE,), scenario, out, settings, workers)


def render(scenario: Scenario, out: Out, settings: Settings = None, workers: Workers = None) -> int:
    """Second stage: render the images of every simulated run in Blender.

    Example: symolo render smoke --out data
    """
    return _make((Until.RENDER,), scenario, out, settings, workers)


def assemble(scenario: Scenario, out: Out, settings: Settings = None, workers: Workers = None) -> int:
    """Third stage: put the dataset together, with description, metadata and checksums.

    Example: symolo assemble smoke --out data
    """
    return _make((Until.ASSEMBLE,), scenario, out, settings, workers)


def release(scenario: Scenario, out: Out, settings: Settings = None, workers: Workers = None) -> int:
    """All stages: from a scenario to a dataset. Given again, it continues where it stopped.

    Example: symolo release smoke --out data

    What is done and unchanged is not done again: with another look only the images are made anew.
    """
    return _make(tuple(Until), scenario, out, settings, workers)


def _make(
    stages: Sequence[Until], scenario: str, out: Path, settings: Sequence[str] | None, workers: int | None
) -> int:
    from pipeline.batch import Batch  # noqa: PLC0415
    from pipeline.progress import report_here  # noqa: PLC0415

    batch = Batch.open(scenario, settings or (), out, workers)
    problems = batch.simulated() if Until.SIMULATE not in stages else []
    if stages == (Until.ASSEMBLE,):
        batch.check_rendered(problems)
    report = report_here()
    with batch.workspace.locked():
        if Until.SIMULATE in stages:
            problems += batch.simulate(report)
        if Until.RENDER in stages:
            problems += batch.render(problems, report)
        if Until.ASSEMBLE in stages:
            batch.assemble(problems, report)
    return _conclude(problems, len(batch.specs), stages[-1].name.lower(), out)


def rerender(
    source: Annotated[
        Path, typer.Argument(metavar="RUN", help="Run folder of a dataset or of .stages, or a data.csv.")
    ],
    *,
    look: Annotated[str, typer.Option(metavar="NAME", help="Name of a shipped look, or a YAML file.")],
    out: Out,
    arena: Annotated[str | None, typer.Option(metavar="NAME", help="Arena; the run's own, else symolo.")] = None,
    robot: Annotated[str | None, typer.Option(metavar="NAME", help="Robot; the run's own, else nominal.")] = None,
    camera_hz: Annotated[
        float | None,
        typer.Option("--camera-hz", min=0.001, max=1000, metavar="HZ", help="Image rate; else the img column decides."),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, max=2**63 - 1, metavar="N", help="Seed of the look; the run's own by default.")
    ] = None,
    settings: Settings = None,
    workers: Workers = None,
) -> int:
    """Render a stored trajectory again under another look, without simulating.

    Example: symolo rerender data/CW/test_1 --look lab --out lab

    A data.csv alone: symolo rerender elsewhere/data.csv --look classroom --camera-hz 5 --out pictures
    """
    from pipeline.progress import report_here  # noqa: PLC0415
    from pipeline.rerender import Request, prepare, render_source  # noqa: PLC0415
    from pipeline.workers import cores  # noqa: PLC0415
    from pipeline.workspace import Workspace, check_out  # noqa: PLC0415

    request = Request(look, arena, robot, camera_hz, seed, tuple(settings or ()))
    found, appearance = prepare(source, request)
    check_out(out)
    problems = render_source(
        found, appearance, Workspace(out.absolute()), workers=workers or cores(), cores=cores(), report=report_here()
    )
    return _conclude(problems, 1, "rerender", out)


def _conclude(problems: "Sequence[RunProblem]", runs: int, stage: str, out: Path) -> int:
    for problem in problems:
        typer.echo(f"failed: {problem.run}: {problem.stage}: {problem.text}", err=True)
    failed = len({problem.run for problem in problems})
    good = f"{runs - failed} of {runs} runs" if runs > 1 or failed else "done"
    typer.echo(f"{stage}: {good}, in {out}")
    return RUN_FAILED if problems else 0
