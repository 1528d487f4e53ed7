"""Upload of a release: files that the store has are not sent again, and the lists of checksums come last."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from symolo.core.errors import InputError
from symolo.core.progress import Report
from symolo.dataset.folder_kind import check_outside
from symolo.storage.base import LocalFile, Store
from symolo.storage.comparison import StoreComparison, compare
from symolo.storage.folder import Folder
from symolo.storage.side_by_side import side_by_side
from symolo.verification.inventory import LISTS

ANOTHER_PLACE = "give a different prefix, or remove these files with the tools of the store"


def check_apart(root: Path, store: Store) -> None:
    """Raise InputError where the store lies within the release or another one, or around it."""
    if not isinstance(store, Folder):
        return
    place, release = store.root.resolve(), root.resolve()
    if place.is_relative_to(release) or release.is_relative_to(place):
        how = "within" if place.is_relative_to(release) else "around"
        raise InputError(f"lies {how} the release", where=store.url, cure="name a folder next to it")
    check_outside(store.root, store.url)


def planned(
    files: Sequence[LocalFile], store: Store, report: Report, known: Mapping[str, str] = MappingProxyType({})
) -> StoreComparison:
    """Return what an upload would send; `known` is as in `compare`.

    Raises:
        InputError: The store holds something else there.
        EnvironmentLacking: The store cannot be reached.
    """
    comparison = compare(files, store, report, known)
    if any(name in comparison.different for name in LISTS):
        raise another_release(store)
    refuse_extra(comparison, store)
    return comparison


def another_release(store: Store, what: str = "") -> InputError:
    """Return the error for a place that holds a different release; `what` says how it differs."""
    return InputError("holds a different release" + (f": {what}" if what else ""), where=store.url, cure=ANOTHER_PLACE)


def refuse_extra(comparison: StoreComparison, store: Store) -> None:
    """Raise InputError where a place holds files that are no part of the release."""
    if comparison.extra:
        first, *others = comparison.extra
        what = f"contains files that are not part of this release: {first}" + (
            f" and {len(others)} more" if others else ""
        )
        raise InputError(what, where=store.url, cure=ANOTHER_PLACE)


def upload(files: Sequence[LocalFile], store: Store, report: Report) -> StoreComparison:
    """Send the files that the store lacks, and return the comparison from before.

    A store counts as finished only with the last list of checksums, so an interruption at any time does no harm.

    Raises:
        InputError: The store holds something else there, or a file of the release changed meanwhile.
        EnvironmentLacking: The store cannot be reached.
    """
    with store.locked():
        return send(files, store, report)


def send(
    files: Sequence[LocalFile], store: Store, report: Report, known: Mapping[str, str] = MappingProxyType({})
) -> StoreComparison:
    """Do the same as `upload` for a store that this process has locked; `known` is as in `compare`."""
    comparison = planned(files, store, report, known)
    store.sweep()
    content = [file for file in comparison.to_send if file.name not in LISTS]
    lists = [file for file in comparison.to_send if file.name in LISTS]
    with report.stage("upload", len(content) + len(lists), "files") as stage:
        for sent, _ in enumerate(side_by_side(store.put, content), start=1):
            stage.update("all", sent)
        for sent, file in enumerate(lists, start=len(content) + 1):
            store.put(file)
            stage.update("all", sent)
    return comparison
