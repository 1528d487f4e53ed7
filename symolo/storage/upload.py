"""A release sent to a store: what is there is not sent again, and the lists of checksums come last."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from symolo.core.errors import InputError
from symolo.core.progress import Report
from symolo.dataset.folder_kind import check_outside
from symolo.storage.base import LocalFile, Store
from symolo.storage.comparison import Comparison, compare, released_files
from symolo.storage.folder import Folder
from symolo.storage.side_by_side import side_by_side
from symolo.verification.inventory import LISTS

ANOTHER_PLACE = "name another prefix, or remove what is there by the tools of the store"


def check_apart(root: Path, store: Store) -> None:
    """Raise InputError where the store lies within the release or another one, or around it."""
    if not isinstance(store, Folder):
        return
    place, release = store.root.resolve(), root.resolve()
    if place.is_relative_to(release) or release.is_relative_to(place):
        how = "within" if place.is_relative_to(release) else "around"
        raise InputError(f"lies {how} the release", where=store.url, cure="name a folder beside it")
    check_outside(store.root, store.url)


def files_to_upload(root: Path, store: Store) -> tuple[LocalFile, ...]:
    """All of a release that is whole, and that the store lies apart from.

    Raises:
        InputError: It is damaged, or the store does not.
    """
    check_apart(root, store)
    return released_files(root)


def planned(
    files: Sequence[LocalFile], store: Store, report: Report, known: Mapping[str, str] = MappingProxyType({})
) -> Comparison:
    """What an upload would send; sends nothing. `known` is as of `compare`.

    Raises:
        InputError: What the store holds there is something else.
        EnvironmentLacking: The store cannot be reached.
    """
    found = compare(files, store, report, known)
    if any(name in found.other for name in LISTS):
        raise another_release(store)
    refuse_extra(found, store)
    return found


def another_release(store: Store, what: str = "") -> InputError:
    """The refusal of a place that holds one; `what` tells it."""
    return InputError("holds another release" + (f": {what}" if what else ""), where=store.url, cure=ANOTHER_PLACE)


def refuse_extra(found: Comparison, store: Store) -> None:
    """Raise InputError where a place holds what is no part of the release."""
    if found.extra:
        first, *others = found.extra
        what = f"holds what is no part of this release: {first}" + (f" and {len(others)} more" if others else "")
        raise InputError(what, where=store.url, cure=ANOTHER_PLACE)


def upload(files: Sequence[LocalFile], store: Store, report: Report) -> Comparison:
    """Send what the store lacks; what it had before that.

    Until the last list is there nobody takes the store for finished, so that a kill at any instant harms nothing.

    Raises:
        InputError: As `planned`; or a file of the release changed meanwhile.
        EnvironmentLacking: The store cannot be reached.
    """
    with store.held():
        return send(files, store, report)


def send(
    files: Sequence[LocalFile], store: Store, report: Report, known: Mapping[str, str] = MappingProxyType({})
) -> Comparison:
    """The same to a store that this process holds; `known` is as of `compare`."""
    found = planned(files, store, report, known)
    store.sweep()
    content = [file for file in found.to_send if file.name not in LISTS]
    lists = [file for file in found.to_send if file.name in LISTS]
    with report.stage("upload", len(content) + len(lists), "files") as stage:
        for sent, _ in enumerate(side_by_side(store.put, content), start=1):
            stage.update("all", sent)
        for sent, file in enumerate(lists, start=len(content) + 1):
            store.put(file)
            stage.update("all", sent)
    return found
