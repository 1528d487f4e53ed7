"""Uncompressed OpenEXR scan-line files, read whole or refused.

Blender reports success when a disk is full and leaves a truncated file, so nothing short of every line is accepted.
Format: OpenEXR file layout, https://openexr.com/en/latest/OpenEXRFileLayout.html
"""

import struct

import numpy as np
from numpy.typing import NDArray

_MAGIC = 20000630
_TYPES = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}


def read_exr(data: bytes) -> dict[str, NDArray[np.generic]]:
    """Channel name -> (H, W) array, as stored.

    Raises:
        ValueError: Not an uncompressed single-part scan-line file, or not a whole one.
    """
    if len(data) < 8 or struct.unpack_from("<i", data)[0] != _MAGIC:
        raise ValueError("not an OpenEXR file")
    if struct.unpack_from("<i", data, 4)[0] & 0x1A00:
        raise ValueError("a tiled, deep or multi-part OpenEXR file; expected single-part scan lines")
    try:
        attributes, at = _header(data)
        return _lines(data, at, attributes)
    except (struct.error, IndexError, KeyError) as error:
        raise ValueError(f"truncated OpenEXR file of {len(data)} bytes") from error


def _header(data: bytes) -> tuple[dict[str, bytes], int]:
    attributes, at = {}, 8
    while data[at]:
        name, at = _text(data, at)
        _, at = _text(data, at)
        size = struct.unpack_from("<i", data, at)[0]
        attributes[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def _lines(data: bytes, at: int, attributes: dict[str, bytes]) -> dict[str, NDArray[np.generic]]:
    if attributes["compression"] != b"\0":
        raise ValueError("a compressed OpenEXR file; expected none")
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    line = np.dtype([(name, _TYPES[kind], (width,)) for name, kind in _channels(attributes["channels"])])
    record = np.dtype([("y", "<i4"), ("size", "<i4"), ("values", line)])
    at += 8 * height
    if len(data) - at != height * record.itemsize:
        raise ValueError(
            f"truncated OpenEXR file: {len(data) - at} bytes of lines, expected {height * record.itemsize}"
        )
    lines = np.frombuffer(data, record, height, at)
    if not np.array_equal(lines["y"], np.arange(y0, y1 + 1)) or np.any(lines["size"] != line.itemsize):
        raise ValueError("damaged OpenEXR file: scan lines out of order")
    return {name: lines["values"][name] for name in line.names or ()}


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
    return data[at:end].decode(), end + 1
