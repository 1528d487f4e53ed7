"""OpenEXR scan-line files, uncompressed or compressed by ZIP, read whole or refused.

Blender reports success when a disk is full and leaves a truncated file, so nothing short of every line is accepted.
Format: OpenEXR file layout, https://openexr.com/en/latest/OpenEXRFileLayout.html
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
"""Of a compressed file."""
_TYPES = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}

Channels = dict[str, NDArray[np.generic]]


def is_exr(data: bytes) -> bool:
    return len(data) >= 8 and struct.unpack_from("<i", data)[0] == _MAGIC


def read_exr(
    data: bytes, check_size: Callable[[int, int], None] | None = None, wanted: Collection[str] | None = None
) -> Channels:
    """Channel name -> (H, W) array, as stored.

    Args:
        data: Of the whole file.
        check_size: Told width and height before anything of that size is made; may refuse them by a ValueError.
        wanted: Channels to keep, all of which must be there; None keeps every one.

    Raises:
        ValueError: Not a single-part scan-line file, otherwise compressed, not a whole one, or without what is wanted.
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
        kept = tuple(names if wanted is None else wanted)
        if not set(kept) <= set(names):
            there = ", ".join(ascii(name)[1:-1] for name in sorted(names)[:8]) or "none"
            raise ValueError(f"has the channels {there}; expected {', '.join(kept)}")
        lines = _lines if attributes["compression"] == b"\0" else _blocks
        return lines(data, at, _Layout(attributes["compression"][0], line, (y0, y1), kept))
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
    """Of one scan line's bytes."""
    rows: tuple[int, int]
    """First and last."""
    kept: tuple[str, ...]


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
    return {name: lines["values"][name] for name in layout.kept}


def _blocks(data: bytes, at: int, layout: _Layout) -> Channels:
    """Of compressed lines, wherever in the file the table of offsets says that their blocks stand."""
    kind, line, (y0, y1), kept = layout.compression, layout.line, layout.rows, layout.kept
    if kind not in _LINES:
        raise ValueError("an OpenEXR file compressed otherwise than by ZIP; save it with ZIP compression or none")
    if len(line.names or ()) > _MAX_CHANNELS:  # a small file may unpack to any number of them
        raise ValueError(f"an OpenEXR file of {len(line.names or ())} channels; at most {_MAX_CHANNELS} are unpacked")
    whole = np.empty(y1 - y0 + 1, [(name, line[name]) for name in kept])
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
        for name in kept:
            whole[name][first - y0 : first - y0 + count] = block[name]
    return {name: whole[name] for name in kept}


def _unpacked(packed: bytes, expected: int) -> bytes:
    """A block's lines: deflated differences of bytes, the even ones before the odd ones; stored where that is less."""
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
    """Of one scan line's bytes."""
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
