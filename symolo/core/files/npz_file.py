"""Arrays of an npz archive that may come from a stranger.

numpy's reader believes what the headers say: it allocates as many numbers as an array announces, unpacks whatever an
entry holds, and some headers end its parser with errors that nobody expects. This one takes rows of numbers alone, as
`numpy.savez` writes them.
"""

import io
import math
import re
import struct
import zipfile
import zlib
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[Any]
"""(N,) or (N, K), of floating-point or whole numbers; numpy cannot say so."""

MAX_ENTRIES = 1000
"""Largest number of entries of an archive; a run has about thirty, two for each series."""
_ENTRY = b"PK\x01\x02"
"""Signature with which each entry of the archive's directory begins."""
_PLAIN = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Methods of compression of which zipfile unpacks no more than requested; of others it unpacks whole blocks."""
_MAGIC = b"\x93NUMPY\x01\x00"
_PIECE = 1 << 20
_HEADER = re.compile(
    rb"\{'descr': '([<>|][biuf][1248])', 'fortran_order': (True|False), 'shape': \((\d{1,12}), ?(\d{1,12})?\), \} *\n"
)
"""Header of version 1.0 of the format, with one or two dimensions (numpy.lib.format)."""


def arrays_of(data: bytes, max_bytes: int) -> dict[str, Numbers]:
    """Return the arrays of an archive by name, each (N,) or (N, K) and read-only.

    Args:
        data: The archive.
        max_bytes: Number of bytes that it may unpack to.

    Raises:
        ValueError: It unpacks to more, has too many arrays, or holds something else than rows of numbers.
        zipfile.BadZipFile: It is no whole archive.
    """
    # Before zipfile makes an object of each entry; the number of entries that the archive states may be wrong.
    if data.count(_ENTRY) > MAX_ENTRIES:
        raise ValueError(f"has more than {MAX_ENTRIES} arrays")
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
            if size > max_bytes:
                raise ValueError(f"unpacks to {size >> 20} MiB; at most {max_bytes >> 20} MiB can be read")
            return {entry.filename.removesuffix(".npy"): _array(archive, entry) for entry in archive.infolist()}
    except (zlib.error, struct.error, EOFError, RuntimeError) as error:  # a RuntimeError where it is encrypted
        raise zipfile.BadZipFile(str(error)) from None


def _array(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> Numbers:
    if entry.compress_type not in _PLAIN:
        raise zipfile.BadZipFile(f"{entry.filename} is packed in a way that numpy does not use")
    with archive.open(entry) as file:
        start = file.read(len(_MAGIC) + 2)
        text = file.read(int.from_bytes(start[-2:], "little"))
        header = _HEADER.fullmatch(text)
        if not start.startswith(_MAGIC) or header is None:
            raise ValueError(f"{entry.filename} holds no rows of numbers")
        kind, by_column, *counts = header.groups()
        try:
            dtype, shape = np.dtype(kind.decode()), tuple(int(count) for count in counts if count)
        except TypeError:  # such as f1
            raise ValueError(f"{entry.filename} holds no rows of numbers") from None
        if math.prod(shape) * dtype.itemsize != entry.file_size - len(start) - len(text):
            raise ValueError(f"{entry.filename} holds another number of rows than it announces")
        values = np.empty(math.prod(shape), dtype)
        _fill(values, file, entry.filename)
    values.flags.writeable = False
    return values.reshape(shape, order="F" if by_column == b"True" else "C")


def _fill(values: Numbers, file: IO[bytes], name: str) -> None:
    """Read an array in pieces, because zipfile holds what it unpacks at once in memory twice."""
    content = values.view(np.uint8)
    for begin in range(0, len(content), _PIECE):
        piece = content[begin : begin + _PIECE]
        data = file.read(len(piece))
        if len(data) < len(piece):
            raise zipfile.BadZipFile(f"{name} is shorter than announced")
        piece[:] = np.frombuffer(data, np.uint8)
