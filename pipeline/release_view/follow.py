"""A page that is written again every few seconds until the release is finished."""

import time
from collections.abc import Callable
from pathlib import Path

from pipeline.release_view.page import release_page
from pipeline.release_view.snapshot import snapshot
from symolo.core.errors import InputError
from symolo.core.files.atomic_files import write_file
from symolo.dataset.layout import STAGES


def follow(out: Path, page: Path, every_s: float, on_written: Callable[[], None]) -> None:
    """Write the page of a release again and again until it is finished.

    Args:
        out: Output folder of `release`, `simulate`, `render` or `rerender`, in which another command works.
        page: File to write.
        every_s: Time between two versions of the page.
        on_written: Called after the first version.

    Raises:
        InputError: There is no such folder, or it is no output folder.
    """
    if not out.is_dir() or not ((out / STAGES).is_dir() or not any(out.iterdir())):
        raise InputError("is no output folder of release", where=str(out), cure="name the --out of the release")
    is_first = True
    while True:
        progress = snapshot(out, time.time())
        write_file(page, release_page(out.absolute().name, progress, every_s))
        if is_first:
            on_written()
            is_first = False
        if progress.finished:
            return
        time.sleep(every_s)
