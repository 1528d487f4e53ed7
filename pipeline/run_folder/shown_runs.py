"""The runs of a folder that people look at: released, or simulated and not released yet."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from symolo.core.errors import InputError
from symolo.core.files.plain_files import check_folders
from symolo.dataset.bag import DECLARATION
from symolo.dataset.documents.metadata import METADATA
from symolo.dataset.layout import DATA, SPEC, STAGES
from symolo.exporters.export import open_release
from symolo.reader.dataset import Dataset, load
from symolo.reader.run import Run


@contextmanager
def shown_runs(path: Path, pattern: str | None = None) -> Iterator[Dataset]:
    """Yield the runs of a folder, or only those whose name matches a pattern.

    Args:
        path: A release, a run of it, an unfinished output folder, a run in its `.stages`, another folder with runs,
            or a data.csv. Checksums are not verified.
        pattern: A pattern of names such as `CW/*`.

    Raises:
        InputError: It is nothing of that kind, it is damaged, or no run matches.
    """
    if path.is_file() and path.name != DATA:
        cure = f"name a dataset, a run folder, or the {DATA} of a run"
        raise InputError(f"is neither a folder nor a {DATA}", where=str(path), cure=cure)
    root = path.parent if path.is_file() else path
    if _is_unreleased(root):
        yield from _unreleased(root, pattern)
    elif runs := _several(root):
        yield Dataset(root, None, runs).matching(pattern)
    else:
        yield load(root).matching(pattern)


@contextmanager
def checked_runs(root: Path, pattern: str | None) -> Iterator[Dataset]:
    """Yield the runs of a release whose checksums hold, or of an unfinished output folder.

    Raises:
        InputError: It is neither, it is damaged, or no run matches the pattern.
    """
    if _is_unreleased(root):
        yield from _unreleased(root, pattern)
    else:
        yield open_release(root, pattern)


def failed_runs_note(data: Dataset) -> str:
    """Return lines on the runs that failed, which a release does not contain; empty if there are none."""
    shown = set(data.failures) & {run.name for run in data}
    lines = [f"{run} failed: {data.failures[run]}" for run in sorted(shown)]
    failed = [one.run for one in data.metadata.failed_runs] if data.metadata else []
    if failed:
        reason = "not shown, because failed runs are not released"
        lines.append(f"{reason}: {', '.join(failed)}; see `symolo status {data.root}`")
    return "\n".join(lines)


def _is_unreleased(root: Path) -> bool:
    """Return whether a folder is a run in `.stages/simulate`, or an output folder that holds no release yet."""
    if STAGES in root.absolute().parts:
        return True
    return (root / STAGES / "simulate").is_dir() and not ((root / METADATA).exists() or (root / DECLARATION).exists())


def _unreleased(root: Path, pattern: str | None) -> Iterator[Dataset]:
    # What reads simulations takes a second to load, which is not spent on a release.
    from pipeline.run_folder.stored_runs import trajectory_folders  # noqa: PLC0415
    from pipeline.run_folder.unreleased import unreleased  # noqa: PLC0415

    folders = [_run_in_stages(root)] if STAGES in root.absolute().parts else trajectory_folders(root)
    if not folders:
        raise InputError("holds no simulated run", where=str(root), cure="wait until the first run is simulated")
    with unreleased(folders) as data:
        yield data.matching(pattern)


def _run_in_stages(folder: Path) -> Path:
    """Return a folder within `.stages`, which must be that of a simulated run.

    Raises:
        InputError: It is another one.
    """
    parts = folder.absolute().parts
    within = parts[parts.index(STAGES) + 1 :]
    if len(within) == 3 and within[0] == "simulate":
        return folder
    above = folder
    while STAGES in above.absolute().parts:
        above = above.parent
    first = next(iter(sorted((above / STAGES / "simulate").glob(f"*/*/{SPEC}"))), None)
    cure = f"name {above}" + (f", or a run such as {first.parent}" if first else "")
    raise InputError("is no simulated run", where=str(folder), cure=cure)


def _several(root: Path) -> tuple[Run, ...]:
    """Return the runs below a folder without metadata, such as a dataset of somebody else."""
    if not root.is_dir() or any((root / name).exists() for name in (DATA, METADATA, DECLARATION)):
        return ()
    names = sorted(path.parent.relative_to(root).as_posix() for path in root.rglob(DATA))
    for name in names:
        check_folders(root, name)
    return tuple(Run(root / name, name) for name in names)
