"""`symolo render`: renders the images of simulated runs."""

from pipeline.commands.options import (
    Like,
    OnDevice,
    Out,
    Part,
    Scenario,
    Settings,
    WorkerMemory,
    Workers,
    with_device,
    with_like,
)
from pipeline.commands.stages import make


def render(
    scenario: Scenario,
    out: Out,
    *,
    settings: Settings = None,
    like: Like = None,
    workers: Workers = None,
    device: OnDevice = None,
    memory: WorkerMemory = None,
    part: Part = None,
) -> int:
    """Render the images of every simulated run in Blender, and make the annotations that the scenario names.

    Example: symolo render smoke --out data

    One of ten jobs on different machines: symolo render smoke --out data --part 3/10
    """
    from pipeline.executors import chosen

    return make(
        ["render"],
        scenario,
        with_device(with_like(settings, like), device),
        out,
        chosen(workers, memory, part),
        part=part,
    )
