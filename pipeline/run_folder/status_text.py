"""The lines that `symolo status` prints."""

from collections.abc import Iterator, Sequence

from pipeline.run_folder.losses import Losses, named_runs
from pipeline.run_folder.status import (
    FolderStatus,
    ImageCost,
    ReleaseStatus,
    RunStatus,
)
from pipeline.run_folder.worker import Worker
from symolo.core.progress import plural

MAX_DONE_RUNS = 20
"""Largest number of runs up to which those that are done have a line too."""


def reasons_of(runs: Sequence[RunStatus]) -> dict[str, tuple[str, ...]]:
    """Return the names of the runs by what the next release would do with them."""
    names: dict[str, tuple[str, ...]] = {}
    for run in runs:
        for reason in [f"{stage.stage}: {stage.again}" for stage in run.stages if stage.again]:
            names[reason] = (*names.get(reason, ()), run.run)
    return names


def next_release(runs: Sequence[RunStatus], losses: Losses | None, command: str = "release") -> Iterator[str]:
    """Yield lines with what the next command would take away, if a scenario is known, and what it would do."""
    if losses is not None and losses.text:
        yield f"would be lost by the next {command}: {losses.text}"
    for reason, names in reasons_of(runs).items():
        yield f"would be done by the next {command}, {named_runs(names)}: {reason}"


def dry_run(runs: Sequence[RunStatus], losses: Losses) -> Iterator[str]:
    """Yield lines with what a release would take away, do, keep and fail to do; `runs` are those of its scenario."""
    yield from next_release(runs, losses)
    finished = [run.run for run in runs if run.done]
    failed = [run.run for run in runs if any(stage.has_failed for stage in run.stages)]
    if finished:
        yield f"would be kept, as far as their settings show, {named_runs(finished)}"
    if failed:
        yield f"would fail again, {named_runs(failed)}"


def status_lines(status: FolderStatus, losses: Losses | None, *, check: bool) -> Iterator[str]:
    """Yield the status as lines of text.

    Args:
        status: The status.
        losses: Losses if the scenario were released; None without a scenario.
        check: As for `status`.
    """
    runs = status.runs
    yield _worker(status.worker)
    failed = sum(any(stage.has_failed for stage in run.stages) for run in runs)
    done = f"{sum(run.done for run in runs)} of {len(runs)} released and up to date"
    yield f"runs: {done}" + (f"; {failed} failed" if failed else "")
    for run in runs:
        if not run.done or check or len(runs) <= MAX_DONE_RUNS:
            yield f"{run.run}: " + "; ".join(f"{stage.stage} {stage.text}" for stage in run.stages)
    yield from next_release(runs, losses, status.command)
    for run, warning in status.mixed.items():
        yield f"{run}: {warning}"
    yield _release(status.release)
    if status.cost is not None:
        yield _cost(status.cost)
    parts = ", ".join(f"{part} {size / 1e6:.1f} MB" for part, size in status.disk_bytes.items())
    yield f"disk: {sum(status.disk_bytes.values()) / 1e6:.1f} MB: {parts}"


def _worker(worker: Worker) -> str:
    if worker.is_working:
        return "a command is working here now" + (f", process {worker.process}" if worker.process else "")
    if worker.has_stages:
        return "no command is working here now"
    return "no command is working here; .stages is missing, so the next release makes everything again"


def _release(release: ReleaseStatus) -> str:
    if release.missing_lists:
        return f"release: not finished, {' and '.join(release.missing_lists)} missing"
    if release.faults is None:
        return "release: finished; --check compares every file with its checksum"
    if release.faults:
        return f"release: {plural(release.faults, 'fault')}; `symolo verify` lists them"
    return "release: every file as it was released"


def _cost(cost: ImageCost) -> str:
    each_s = cost.core_s / cost.images
    took = f"{cost.core_s / 3600:.3g} core-hours, {each_s:.3g} core-seconds each"
    text = f"cost: {plural(cost.images, 'image')} took {took}"
    if cost.planned_core_s is None:
        return text
    return f"{text}; the plan was {cost.planned_core_s:.3g} each, including the starts of Blender"
