"""Where units of work are done. One protocol, one file for each kind; the same bytes come of each."""

from pipeline.executors.base import Executor
from pipeline.executors.local import Local
from pipeline.executors.part import PartOfWork
from pipeline.executors.ray import CARD_SHARE, OnRay


def chosen(
    workers: int | None,
    memory_gb: float | None,
    part: str | None,
    address: str | None,
    card_share: float | None = None,
) -> Executor:
    """What the options of a command ask for.

    Args:
        workers: Child processes at a time; all cores where None.
        memory_gb: That a worker may take; what the machine bears where None.
        part: `k/n` for one part of the work.
        address: Of a Ray cluster; None for this machine.
        card_share: Of a graphics card that a block takes on such a cluster; None for the share of two on a card.

    Raises:
        InputError: The part is none.
    """
    local = Local.of(workers, memory_gb)
    if address is not None:
        return OnRay(address, local.limits, card_share=card_share or CARD_SHARE)
    return local if part is None else PartOfWork.of_text(part, local)
