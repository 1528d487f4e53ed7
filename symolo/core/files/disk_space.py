"""Check that a disk has room for what will be written, before any work starts."""

import shutil
import tempfile
from pathlib import Path

from symolo.core.errors import EnvironmentLacking
from symolo.core.files.file_hashes import sizes_below
from symolo.core.files.paths import nearest_existing


def check_disk(out: Path, needed_bytes: int, or_else: str = "lower render.width_px and render.height_px") -> None:
    """Raise EnvironmentLacking when there is no room for `needed_bytes` where `out` is or will be."""
    present = sum(size for _, size in sizes_below(out))
    cure = f"name a folder on another disk, or {or_else}"
    _check_room(nearest_existing(out), needed_bytes - present, f"--out {out}", needed_bytes, cure)


def check_room(out: Path, lacking_bytes: int) -> None:
    """Raise EnvironmentLacking when there is no room for that many more bytes where `out` will be."""
    cure = "or name a folder on another disk"
    _check_room(nearest_existing(out), lacking_bytes, f"--out {out}", lacking_bytes, cure)


def check_scratch(needed_bytes: int, cure: str) -> None:
    """Raise EnvironmentLacking when the folder for temporary files has no room for `needed_bytes`."""
    scratch = Path(tempfile.gettempdir())
    _check_room(scratch, needed_bytes, f"temporary files in {scratch}", needed_bytes, f"set TMPDIR, or {cure}")


def _check_room(folder: Path, lacking_bytes: int, where: str, needed_bytes: int, cure: str) -> None:
    free = shutil.disk_usage(folder).free
    if free < lacking_bytes:
        needed = f"about {_size(needed_bytes)} are needed and {_size(free)} are free"
        raise EnvironmentLacking(f"{where}: {needed}; free some space, {cure}")


def _size(number_bytes: int) -> str:
    """Return a size in whole MB, or in kB below one MB."""
    return f"{number_bytes / 1e6:.0f} MB" if number_bytes >= 1e6 else f"{number_bytes / 1e3:.0f} kB"
