"""`symolo assemble`: assembles the dataset from rendered runs."""

from pipeline.commands.options import (
    Like,
    OnDevice,
    Out,
    Replace,
    Scenario,
    Settings,
    Workers,
    with_device,
    with_like,
)
from pipeline.commands.stages import make


def assemble(
    scenario: Scenario,
    out: Out,
    *,
    settings: Settings = None,
    like: Like = None,
    workers: Workers = None,
    device: OnDevice = None,
    replace: Replace = False,
) -> int:
    """Assemble the dataset from the rendered runs, with description, metadata and checksums.

    Example: symolo assemble smoke --out data
    """
    from pipeline.executors import chosen

    overrides = with_device(with_like(settings, like), device)
    return make(["assemble"], scenario, overrides, out, chosen(workers), replace=replace)
