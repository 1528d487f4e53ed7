"""The user's images and panoramas, which renderers read from the workspace by their SHA-256 and from nowhere else."""

import hashlib
from pathlib import Path

from symolo.core.files.plain_files import FileKind, read_file


def read_user_image(folder: Path | None, sha256: str) -> bytes:
    """Return the bytes of the file in `folder` whose name is its SHA-256.

    Raises:
        ValueError: There is no such file, or its content has changed.
    """
    path = None if folder is None else folder / sha256
    if path is None or not path.is_file():
        raise ValueError(f"the image or panorama {sha256} is not in the workspace; run the same command again")
    data = read_file(path, FileKind.ANY)
    if hashlib.sha256(data).hexdigest() != sha256:
        raise ValueError(f"{path} has changed since it was put there; run the same command again")
    return data
