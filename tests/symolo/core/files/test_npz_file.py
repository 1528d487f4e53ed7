"""An npz archive from a stranger takes neither time nor memory, whatever its headers say."""

import contextlib
import io
import struct
import time
import tracemalloc
import zipfile

import numpy as np
import pytest

from symolo.core.files.npz_file import MAX_ENTRIES, arrays_of
from symolo.core.finite import require_finite

MIB = 1 << 20
MAX_BYTES = 8 * MIB
ROWS = "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }"


def saved(**arrays):
    file = io.BytesIO()
    np.savez_compressed(file, **arrays)
    return file.getvalue()


@contextlib.contextmanager
def traced():
    """Yields a function that returns the largest number of bytes allocated within, once it is over."""
    peaks = []
    tracemalloc.start()
    try:
        yield lambda: peaks[0]
        peaks.append(tracemalloc.get_traced_memory()[1])
    finally:
        tracemalloc.stop()


def npy(header, content=bytes(48)):
    text = header.encode() + b"\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + content


def packed(content, packing=zipfile.ZIP_DEFLATED, name="pose.npy"):
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", packing) as archive:
        archive.writestr(name, content)
    return file.getvalue()


def with_size(data, announced):
    """The same archive, whose directory and entry announce another size of what is packed."""
    changed, at = bytearray(data), data.rfind(b"PK\x01\x02")
    struct.pack_into("<I", changed, at + 24, announced)
    struct.pack_into("<I", changed, 22, announced)
    return bytes(changed)


def with_flag(data, flag):
    changed, at = bytearray(data), data.rfind(b"PK\x01\x02")
    changed[at + 8] |= flag
    changed[6] |= flag
    return bytes(changed)


def with_many_entries(count):
    """An archive whose directory names one entry again and again."""
    data = packed(npy(ROWS))
    begin, end = data.rfind(b"PK\x01\x02"), data.rfind(b"PK\x05\x06")
    directory = data[begin:end] * count
    return data[:begin] + directory + struct.pack("<IHHHHIIH", 0x06054B50, 0, 0, 1, 1, len(directory), begin, 0)


@pytest.mark.parametrize(
    "array",
    [
        np.linspace(0, 1, 7),
        np.arange(6, dtype=np.int64).reshape(2, 3),
        np.asfortranarray(np.arange(6.0).reshape(2, 3)),
        np.arange(3, dtype=">i4"),
        np.zeros((0, 3)),
        np.array([True, False]),
    ],
)
def test_what_numpy_saves_is_what_is_read(array):
    read = arrays_of(saved(**{"series/a, b/m/s/values": array, "t_s": np.arange(3.0)}), MAX_BYTES)
    assert list(read) == ["series/a, b/m/s/values", "t_s"]
    np.testing.assert_array_equal(read["series/a, b/m/s/values"], array, strict=True)
    assert not read["t_s"].flags.writeable


NUMBERS = npy(ROWS)
BOMB = bytes(64 * MIB)
HOSTILE = {
    "more than allowed": lambda: packed(npy(ROWS, BOMB)),
    "as much as is allowed behind a wrong header": lambda: packed(npy(ROWS, bytes(MAX_BYTES - 200))),
    "more than it announces": lambda: with_size(packed(npy(ROWS, BOMB)), len(NUMBERS)),
    "less than it announces": lambda: with_size(packed(NUMBERS), 4 * MIB),
    "a block of lzma": lambda: with_size(packed(npy(ROWS, BOMB), zipfile.ZIP_LZMA), len(NUMBERS)),
    "a block of bzip2": lambda: with_size(packed(npy(ROWS, BOMB), zipfile.ZIP_BZIP2), len(NUMBERS)),
    "encrypted": lambda: with_flag(packed(NUMBERS), 1),
    "patched": lambda: with_flag(packed(NUMBERS), 0x20),
    "too many arrays": lambda: with_many_entries(MAX_ENTRIES + 1),
    "a million entries": lambda: with_many_entries(1_000_000),
    "72 terabytes of numbers": lambda: packed(npy(ROWS.replace("(3, 2)", "(10000000000000,)"))),
    "more rows than there are": lambda: packed(npy(ROWS.replace("(3, 2)", "(4, 2)"))),
    "no number of rows": lambda: packed(npy(ROWS.replace("(3, 2)", "(-3, 2)"))),
    "one number": lambda: packed(npy(ROWS.replace("(3, 2)", "()"), bytes(8))),
    "three dimensions": lambda: packed(npy(ROWS.replace("(3, 2)", "(3, 2, 1)"))),
    "objects": lambda: packed(npy(ROWS.replace("<f8", "|O"))),
    "text": lambda: saved(pose=np.array(["a", "b"])),
    "a type that is none": lambda: packed(npy(ROWS.replace("<f8", "<f1"), bytes(6))),
    "a header that never ends": lambda: packed(npy("(" * 3000)),
    "a header that fills the stack": lambda: packed(npy("-" * 9000 + "1")),
    "a header longer than the file": lambda: packed(b"\x93NUMPY\x01\x00\xff\xff" + ROWS.encode()),
    "no header": lambda: packed(b""),
    "no archive": lambda: b"PK\x03\x04",
    "cut short": lambda: saved(pose=np.arange(100.0))[:-30],
    "damaged": lambda: saved(pose=np.arange(100.0))[:60] + bytes(20) + saved(pose=np.arange(100.0))[80:],
}
"""Archives, each made by its test: some take seconds to pack."""


@pytest.mark.parametrize("make", HOSTILE.values(), ids=HOSTILE)
def test_a_hostile_archive_is_refused_at_once(make):
    data = make()
    begin = time.process_time()
    with traced() as peak, pytest.raises((ValueError, zipfile.BadZipFile)):
        arrays_of(data, MAX_BYTES)
    assert peak() < MAX_BYTES / 2
    assert time.process_time() - begin < 2.0


def test_the_largest_archive_needs_no_more_memory_than_its_arrays():
    """Infinite numbers are those about which a message could be as large as the array itself."""
    rows = MAX_BYTES // 8 - 100
    data = packed(npy(f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({rows},), }}", b"\xff" * (8 * rows)))
    with traced() as peak:
        values = arrays_of(data, MAX_BYTES)["pose"]
        with pytest.raises(ValueError, match=f"pose: nan at row 0, {rows} such in all"):
            require_finite(values, "pose", ["row"])
    assert peak() < 1.5 * MAX_BYTES
