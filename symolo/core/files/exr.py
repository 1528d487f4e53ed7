"""Reader of OpenEXR scan-line files, uncompressed or compressed by ZIP; a file is read completely or refused.

Blender reports success when a disk is full and leaves a truncated file, so a file with a missing line is refused.
Format: OpenEXR file layout, https://openexr.com/en/latest/OpenEXRFileLayout.html

The OpenEXR library (3.5) was tried in its place and is not used. It reads files only by name; it decodes all channels
before a caller can limit size and channels; and it answers a damaged file with a warning on the terminal and an object
without parts. It would also be one more compiled library that reads untrusted files.
"""

import struct
import zlib
from collections.abc import Callable, Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_MAGIC = 20000630
_LINES = {0: 1, 2: 1, 3: 16}
"""Scan lines in a block by kind of compression: none, ZIPS, ZIP."""
_MAX_CHANNELS = 16
"""Maximum number of channels of a compressed file."""
_TYPES = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}

Channels = dict[str, NDArray[np.generic]]


def is_exr(data: bytes) -> bool:
    return len(data) >= 8 and struct.unpack_from("<i", data)[0] == _MAGIC


def read_exr(
    data: bytes, check_size: Callable[[int, int], None] | None = None, wanted: Collection[str] | None = None
) -> Channels:
    """Return the arrays (H, W) of the channels by name, as stored.

    Args:
        data: Content of the file.
        check_size: Called with width and height before memory of that size is taken; may raise ValueError.
        wanted: Channels to read, all of which must be there; None for all.

    Raises:
        ValueError: Not a single-part scan-line file, compressed in another way, truncated, or without a wanted channel.
    """
    if not is_exr(data):
        raise ValueError("not an OpenEXR file")
    if struct.unpack_from("<i", data, 4)[0] & 0x1A00:
        raise ValueError("a tiled, deep or multi-part OpenEXR file; expected single-part scan lines")
    try:
        attributes, at = _header(data)
        x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
        if x1 < x0 or y1 < y0:
            raise ValueError("damaged OpenEXR file: no pixels")
        if check_size is not None:
            check_size(x1 - x0 + 1, y1 - y0 + 1)
        line = _line(attributes, x1 - x0 + 1)
        names = line.names or ()
        chosen = tuple(names if wanted is None else wanted)
        if not set(chosen) <= set(names):
            there = ", ".join(ascii(name)[1:-1] for name in sorted(names)[:8]) or "none"
            raise ValueError(f"has the channels {there}; expected {', '.join(chosen)}")
        lines = _lines if attributes["compression"] == b"\0" else _blocks
        return lines(data, at, _Layout(attributes["compression"][0], line, (y0, y1), chosen))
    except (struct.error, IndexError, KeyError) as error:
        raise ValueError(f"truncated OpenEXR file of {len(data)} bytes") from error


def _header(data: bytes) -> tuple[dict[str, bytes], int]:
    attributes, at = {}, 8
    while data[at]:
        name, at = _text(data, at)
        _, at = _text(data, at)
        size = struct.unpack_from("<i", data, at)[0]
        if size < 0:
            raise IndexError(size)
        attributes[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    return attributes, at + 1


@dataclass(frozen=True)
class _Layout:
    compression: int
    line: np.dtype
    """Type of one scan line."""
    rows: tuple[int, int]
    """First and last row."""
    chosen: tuple[str, ...]
    """Names of the channels to read."""


def _lines(data: bytes, at: int, layout: _Layout) -> Channels:
    line, (y0, y1) = layout.line, layout.rows
    height = y1 - y0 + 1
    record = np.dtype([("y", "<i4"), ("size", "<i4"), ("values", line)])
    at += 8 * height
    if len(data) - at != height * record.itemsize:
        raise ValueError(
            f"truncated OpenEXR file: {len(data) - at} bytes of lines, expected {height * record.itemsize}"
        )
    lines = np.frombuffer(data, record, height, at)
    if not np.array_equal(lines["y"], np.arange(y0, y1 + 1)) or np.any(lines["size"] != line.itemsize):
        raise ValueError("damaged OpenEXR file: scan lines out of order")
    return {name: lines["values"][name] for name in layout.chosen}


def _blocks(data: bytes, at: int, layout: _Layout) -> Channels:
    """Read compressed lines from the blocks to which the table of offsets points."""
    kind, line, (y0, y1), chosen = layout.compression, layout.line, layout.rows, layout.chosen
    if kind not in _LINES:
        raise ValueError("an OpenEXR file compressed otherwise than by ZIP; save it with ZIP compression or none")
    if len(line.names or ()) > _MAX_CHANNELS:  # a small file may unpack to any number of them
        raise ValueError(f"an OpenEXR file of {len(line.names or ())} channels; at most {_MAX_CHANNELS} are unpacked")
    whole = np.empty(y1 - y0 + 1, [(name, line[name]) for name in chosen])
    for first in range(y0, y1 + 1, _LINES[kind]):
        (place,) = struct.unpack_from("<Q", data, at)
        at += 8
        if place > len(data):
            raise IndexError(place)
        y, size = struct.unpack_from("<ii", data, place)
        count = min(_LINES[kind], y1 + 1 - first)
        if y != first or not 0 <= size <= len(data) - place - 8:
            raise ValueError("truncated or damaged OpenEXR file: a block of lines is not where it should be")
        block = np.frombuffer(_unpacked(data[place + 8 : place + 8 + size], line.itemsize * count), line)
        for name in chosen:
            whole[name][first - y0 : first - y0 + count] = block[name]
    return {name: whole[name] for name in chosen}


def _unpacked(packed: bytes, expected: int) -> bytes:
    """Return the lines of a block: differences of bytes, even ones before odd ones, deflated unless that is longer."""
    if len(packed) == expected:
        return packed
    try:
        flat = zlib.decompressobj().decompress(packed, expected + 1)
    except zlib.error:
        flat = b""
    if len(flat) != expected:
        raise ValueError("truncated or damaged OpenEXR file: a block of lines cannot be unpacked")
    steps = np.frombuffer(flat, np.uint8).copy()
    steps[1:] -= 128  # modulo 256, as the sums are
    apart = np.add.accumulate(steps, dtype=np.uint8)
    joined = np.empty(expected, np.uint8)
    half = (expected + 1) // 2
    joined[0::2], joined[1::2] = apart[:half], apart[half:]
    return joined.tobytes()


def _line(attributes: dict[str, bytes], width: int) -> np.dtype:
    """Return the type of one scan line."""
    channels = _channels(attributes["channels"])
    if not channels or len({name for name, _ in channels}) < len(channels):
        raise ValueError("damaged OpenEXR file: no channels, or two of one name")
    return np.dtype([(name, _TYPES[kind], (width,)) for name, kind in channels])


def _channels(data: bytes) -> list[tuple[str, int]]:
    channels, at = [], 0
    while data[at]:
        name, at = _text(data, at)
        channels.append((name, struct.unpack_from("<i", data, at)[0]))
        at += 16
    return channels


def _text(data: bytes, at: int) -> tuple[str, int]:
    end = data.find(0, at)
    if end < 0:
        raise IndexError(at)
    return data[at:end].decode("latin-1"), end + 1  # which takes any bytes
