"""A release sent to a store: what is there is not sent again, and the lists of checksums come last."""

from collections.abc import Sequence
from pathlib import Path

from configs.errors import InputError
from pipeline.dataset.inventory import LISTS
from pipeline.progress import Report
from pipeline.storage.base import LocalFile, Store
from pipeline.storage.comparison import Comparison, compare, released_files
from pipeline.storage.folder import Folder
from pipeline.storage.side_by_side import side_by_side

ANOTHER_PLACE = "name another prefix, or remove what is there by the tools of the store"


def files_to_upload(root: Path, store: Store) -> tuple[LocalFile, ...]:
    """All of a release that is whole, and that the store does not lie within.

    Raises:
        InputError: It is damaged, or the store does.
    """
    if isinstance(store, Folder) and store.root.resolve().is_relative_to(root.resolve()):
        raise InputError("lies within the release", where=store.url, cure="name a folder beside it")
    return released_files(root)


def planned(files: Sequence[LocalFile], store: Store, report: Report) -> Comparison:
    """What an upload would send; sends nothing.

    Raises:
        InputError: What the store holds there is something else.
        EnvironmentLacking: The store cannot be reached.
    """
    found = compare(files, store, report)
    if any(name in found.other for name in LISTS):
        raise InputError("holds another release", where=store.url, cure=ANOTHER_PLACE)
    if found.extra:
        first, *others = found.extra
        what = f"holds what is no part of this release: {first}" + (f" and {len(others)} more" if others else "")
        raise InputError(what, where=store.url, cure=ANOTHER_PLACE)
    return found


def upload(files: Sequence[LocalFile], store: Store, report: Report) -> Comparison:
    """Send what the store lacks; what it had before that.

    Until the last list is there nobody takes the store for finished, so that a kill at any instant harms nothing.

    Raises:
        InputError: As `planned`; or a file of the release changed meanwhile.
        EnvironmentLacking: The store cannot be reached.
    """
    with store.held():
        found = planned(files, store, report)
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
