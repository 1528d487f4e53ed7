"""The user's images and panoramas, copied once into the workspace, from which the renderers read them."""

from collections.abc import Iterable, Mapping
from hashlib import sha256
from pathlib import Path

from configs.schema.appearance.look import LookConfig
from symolo.core.errors import InputError
from symolo.core.files.atomic_files import make_folder, write_file
from symolo.core.files.file_hashes import sha256_of
from symolo.core.files.plain_files import FileKind, read_named_file
from symolo.core.yaml.reader import displayed


def copy_user_images(looks: Iterable[LookConfig], places: Mapping[str, Path], folder: Path) -> None:
    """Copy the files that the looks show into `folder`, each named by its SHA-256; unchanged copies stay.

    Args:
        looks: Looks with numbers only.
        places: Path of each file by SHA-256.
        folder: Folder of the copies; it is made if there is a file to copy.

    Raises:
        InputError: A file is missing, or has changed since the look was read.
    """
    for digest, name in sorted({file.sha256: file.name for look in looks for file in look.files}.items()):
        copy = folder / digest
        if copy.is_file() and sha256_of(copy) == digest:
            continue
        where = displayed(places[digest]) if digest in places else name
        try:
            data = read_named_file(places[digest], FileKind.ANY)
        except (KeyError, OSError):
            raise InputError("has disappeared since it was read", where=where, cure="put it back") from None
        if sha256(data).hexdigest() != digest:
            raise InputError("has changed since it was read", where=where, cure="run the command again")
        make_folder(folder)
        write_file(copy, data)
