"""The command `symolo model`: robot and arena of a run as URDF and SDF."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import Scenario, Settings, checked_new_folder, names


def model(
    scenario: Scenario,
    *,
    out: Annotated[
        Path, typer.Option("--out", metavar="DIR", callback=checked_new_folder, help="Output folder: new or empty.")
    ],
    route: Annotated[
        str | None, typer.Option("--route", metavar="NAME", help="Route of the run; by default the first one.")
    ] = None,
    run: Annotated[
        int, typer.Option("--run", min=1, max=100_000, metavar="N", help="Number of the run on that route.")
    ] = 1,
    formats: Annotated[
        str, typer.Option("--format", metavar="NAMES", help="urdf, sdf, or both with a comma between them.")
    ] = ("urdf,sdf"),
    settings: Settings = None,
) -> None:
    """Write robot and arena of a run as URDF and SDF files for ROS, Gazebo, PyBullet and others.

    robot.urdf and robot.sdf hold the simulated bodies, the rendered shapes and the frames of the sensors. arena.sdf
    holds floor, line, walls and obstacles; world.sdf adds the robot at its start. Randomised values are those of this
    run. Nothing is simulated.

    Example: symolo model symolo --route CCW --out model
    """
    from configs.draw import draw_run
    from configs.loader import load_scenario
    from pipeline.models.files import formats_of, model_files
    from symolo.core.errors import InputError
    from symolo.core.files.atomic_files import write_file
    from symolo.core.files.new_folder import check_new, new_folder

    wanted = formats_of(names(formats, "--format"), "--format")
    loaded = load_scenario(scenario, settings or ())
    chosen = route or loaded.routes[0].name
    runs = {item.name: item.runs for item in loaded.routes}
    if run > runs.get(chosen, run):
        raise InputError("--run", got=run, allowed=f"1 to {runs[chosen]} on route {chosen}")
    check_new(out)
    spec = draw_run(loaded, chosen, run)
    files = model_files(spec, wanted)
    with new_folder(out) as folder:
        for name, data in files.items():
            write_file(folder / name, data)
    typer.echo(f"{out}: {', '.join(files)} of {spec.key}")
    if moving := [obstacle.name for obstacle in spec.arena.obstacles if obstacle.motion is not None]:
        typer.echo(f"these obstacles move in the run; the files show them at t = 0: {', '.join(moving)}")
