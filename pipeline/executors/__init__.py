"""Executors do units of work. One protocol, one file for each executor; all give the same bytes."""

from pipeline.executors.base import Executor
from pipeline.executors.local import Local
from pipeline.executors.part import PartOfWork
from pipeline.executors.ray import CARD_SHARE, OnRay


def chosen(
    workers: int | None,
    memory_gb: float | None = None,
    part: str | None = None,
    address: str | None = None,
    card_share: float | None = None,
) -> Executor:
    """Return the executor for the options of a command.

    Args:
        workers: Number of child processes at a time; None for one per core.
        memory_gb: Largest memory of a worker; None for nine tenths of the machine's.
        part: `k/n` for one part of the work.
        address: Address of a Ray cluster; None for this machine.
        card_share: Share of a graphics card for a block on such a cluster; None for two blocks on a card.

    Raises:
        InputError: The part is not of the form k/n.
    """
    local = Local.from_options(workers, memory_gb)
    if address is not None:
        return OnRay(address, local.limits, card_share=card_share or CARD_SHARE)
    return local if part is None else PartOfWork.of_text(part, local)
