"""The command `symolo model`: robot and arena of a run as URDF and SDF."""

from typing import Annotated

import typer

from pipeline.commands.options import NewFolder, Scenario, Settings, names


def model(
    scenario: Scenario,
    *,
    out: NewFolder,
    route: Annotated[
        str | None, typer.Option(metavar="NAME", help="Route of the run; by default the first one.")
    ] = None,
    run: Annotated[int, typer.Option(min=1, max=100_000, metavar="N", help="Number of the run on that route.")] = 1,
    formats: Annotated[
        str, typer.Option("--format", metavar="NAMES", help="urdf, sdf, or both, separated by a comma.")
    ] = "urdf,sdf",
    settings: Settings = None,
) -> None:
    """Write robot and arena of a run as URDF and SDF files for ROS, Gazebo, PyBullet and others.

    robot.urdf and robot.sdf hold the simulated bodies, the rendered shapes and the frames of the sensors. arena.sdf
    holds floor, line, walls and obstacles; world.sdf adds the robot at its start. Values that the scenario draws at
    random are those of this run. Nothing is simulated.

    Example: symolo model symolo --route CCW --out model
    """
    from configs.draw import draw_run
    from configs.loader import load_scenario
    from pipeline.models.files import formats_of, model_files
    from symolo.core.errors import InputError
    from symolo.core.files.atomic_files import write_file
    from symolo.core.files.new_folder import check_new, new_folder

    format_names = formats_of(names(formats, "--format"), "--format")
    loaded = load_scenario(scenario, settings or ())
    route_name = route or loaded.routes[0].name
    runs = {item.name: item.runs for item in loaded.routes}
    if run > runs.get(route_name, run):
        raise InputError("--run", got=run, allowed=f"1 to {runs[route_name]} on route {route_name}")
    check_new(out)
    spec = draw_run(loaded, route_name, run)
    files = model_files(spec, format_names)
    with new_folder(out) as folder:
        for name, data in files.items():
            write_file(folder / name, data)
    typer.echo(f"{out}: {', '.join(files)} of {spec.key}")
    if moving := [obstacle.name for obstacle in spec.arena.obstacles if obstacle.motion is not None]:
        typer.echo(f"these obstacles move in the run; the files show them at t = 0: {', '.join(moving)}")
