"""Where units of work are done. One protocol, one file for each kind; the same bytes come of each."""

from pipeline.executors.base import Executor
from pipeline.executors.local import Local
from pipeline.executors.part import Part
from pipeline.executors.ray import OnRay


def chosen(workers: int | None, memory_gb: float | None, part: str | None, address: str | None) -> Executor:
    """What the options of a command ask for.

    Args:
        workers: Child processes at a time; all cores where None.
        memory_gb: That a worker may take; what the machine bears where None.
        part: `k/n` for one part of the work.
        address: Of a Ray cluster; None for this machine.

    Raises:
        InputError: The part is none.
    """
    local = Local.of(workers, memory_gb)
    if address is not None:
        return OnRay(address, local.limits)
    return local if part is None else Part.of_text(part, local)
