"""`symolo verify`: everything that can be found wrong with a dataset from its folder alone."""

from collections.abc import Iterator
from pathlib import Path

from pydantic import ValidationError

from configs.errors import InputError
from pipeline.dataset.checks import Finding, check_run
from pipeline.dataset.description import DESCRIPTION
from pipeline.dataset.manifest import MANIFEST, read_manifest, released_hashes
from pipeline.dataset.metadata import METADATA, Metadata


def verify(root: Path) -> Iterator[Finding]:
    """Each fault with the file that has it; nothing means that the dataset is whole.

    Raises:
        InputError: There is no such folder.
    """
    if not root.is_dir():
        raise InputError("no such folder", where=str(root), cure="name the folder that holds metadata.json")
    yield from _links(root)
    yield from _checksums(root)
    if not (root / DESCRIPTION).is_file():
        yield Finding(DESCRIPTION, "is missing")
    try:
        metadata = Metadata.model_validate_json((root / METADATA).read_bytes())
    except OSError as error:
        yield Finding(METADATA, f"cannot be read: {error.strerror}")
    except ValidationError as error:
        first = error.errors()[0]
        path = ".".join(map(str, first["loc"]))
        yield Finding(METADATA, f"{path}: {first['msg']}" if path else first["msg"])
    else:
        for record in metadata.runs:
            if record.run.startswith("/") or ".." in record.run.split("/"):
                yield Finding(METADATA, f"run {record.run!r} leads out of the dataset")
            else:
                yield from check_run(root, record)
        named = {record.run for record in metadata.runs}
        for folder in sorted(path.relative_to(root).as_posix() for path in root.glob("*/test_*")):
            if folder not in named:
                yield Finding(folder, f"is not named in {METADATA}")


def _links(root: Path) -> Iterator[Finding]:
    for path in sorted(root.rglob("*")):
        if path.is_symlink():
            yield Finding(path.relative_to(root).as_posix(), "is a symbolic link; a dataset holds files")


def _checksums(root: Path) -> Iterator[Finding]:
    try:
        expected = read_manifest((root / MANIFEST).read_bytes())
    except OSError as error:
        yield Finding(MANIFEST, f"cannot be read: {error.strerror}")
        return
    except ValueError as error:
        yield Finding(MANIFEST, str(error))
        return
    there = released_hashes(root)
    for name in sorted(expected.keys() | there.keys()):
        if name not in there:
            yield Finding(name, f"is missing; {MANIFEST} names it")
        elif name not in expected:
            yield Finding(name, f"is not named in {MANIFEST}")
        elif there[name] != expected[name]:
            yield Finding(name, f"was changed: its SHA-256 is not that of {MANIFEST}")
