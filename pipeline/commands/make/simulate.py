"""`symolo simulate`: simulates every run of a scenario."""

from pipeline.commands.options import (
    Like,
    Out,
    Part,
    Scenario,
    Settings,
    WorkerMemory,
    Workers,
    with_like,
)
from pipeline.commands.stages import make


def simulate(
    scenario: Scenario,
    out: Out,
    *,
    settings: Settings = None,
    like: Like = None,
    workers: Workers = None,
    memory: WorkerMemory = None,
    part: Part = None,
) -> int:
    """Simulate every run in PyBullet, and store its trajectory and sensor readings.

    They are in the hidden folder DIR/.stages, for `view`, `video`, `baselines` and the next stage.

    Example: symolo simulate smoke --out data

    As a dataset without images: symolo release smoke --set rates.camera_hz=0 --out tables

    Robots that agree with a diagnosis: symolo simulate smoke --like diagnosis --out data
    """
    from pipeline.executors import chosen

    return make(["simulate"], scenario, with_like(settings, like), out, chosen(workers, memory, part), part=part)
