"""Choice of the importer that reads a file or folder: the one that is named, or the one that recognises it."""

from collections.abc import Sequence
from pathlib import Path

from diagnosis.importers.base import Importer
from diagnosis.importers.paper import TABLES
from diagnosis.measured.case_files.nominal import NOMINAL, read_nominal
from diagnosis.measured.measurement import Measurement
from symolo.core.errors import InputError, nearest


def read_measurement(path: Path, importers: Sequence[Importer], name: str | None = None) -> Measurement:
    """Return the measured data, read by the importer of that name or by the one that recognises the path.

    Raises:
        InputError: There is no such path or importer, no importer recognises the path, or the data have a fault.
    """
    try:
        return _read_measurement(path, importers, name)
    except OSError as error:
        where = str(error.filename or path)
        raise InputError(f"cannot be read: {error.strerror}", where=where, cure="check its permissions") from None


def _read_measurement(path: Path, importers: Sequence[Importer], name: str | None) -> Measurement:
    names = [importer.name for importer in importers]
    if name is not None and name not in names:
        raise InputError("--importer", got=name, allowed=", ".join(names), nearest=nearest(name, names))
    if not path.exists() and path.as_posix() not in TABLES:
        close = nearest(path.as_posix(), TABLES)
        cure = "name a case, a log or a table; `symolo case example motor_step --out steps` makes a case to try"
        raise InputError("no such file or folder", where=str(path), nearest=close, cure=cure)
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise InputError("is neither file nor folder", where=str(path), cure="name a case, a log or a table")
    if path.is_file() and not path.stat().st_size:
        raise InputError("is empty", where=str(path), cure="record it again, or name another log")
    for importer in importers:
        if importer.name == name or (name is None and importer.recognises(path)):
            return importer.read(path)
    if (path / NOMINAL).is_file():
        read_nominal(path / NOMINAL)  # its message names the fault in the kind of the case
    raise InputError(
        "is not measured data of a known form",
        where=str(path),
        allowed=f"data for one of {', '.join(names)}",
        cure="make a case with `symolo case init LOG.csv`, write nominal.yaml and data.csv as in docs/measured.md, or "
        "choose the form with --importer",
    )
