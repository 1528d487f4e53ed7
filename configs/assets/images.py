"""PNG and JPEG images: complete, of limited size, as 8-bit sRGB in their EXIF orientation."""

import struct
import zlib

import cv2
import numpy as np
from numpy.typing import NDArray

from configs.assets.quiet import decoded

MAX_BYTES = 64 << 20
MAX_PIXELS = 64_000_000
MAX_SIDE_PX = 4096
"""Longest side after averaging down; cameras seldom resolve the floor finer than a quarter of a millimetre."""

_PNG = b"\x89PNG\r\n\x1a\n"
_JPEG = b"\xff\xd8\xff"
_SIZES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""JPEG markers of frames, which contain the image's size (ITU-T T.81, table B.1)."""

Bytes = NDArray[np.uint8]

_s = np.arange(256) / 255
LINEAR = np.where(_s <= 0.04045, _s / 12.92, ((_s + 0.055) / 1.055) ** 2.4)
"""(256,), linear value of each sRGB component (IEC 61966-2-1)."""


def read_image(data: bytes) -> Bytes:
    """Return the image of a file, averaged down to `MAX_SIDE_PX`."""
    return averaged_down(whole_image(data))


def whole_image(data: bytes) -> Bytes:
    """Return the image (H, W, 3), sRGB, of a file's bytes in its EXIF orientation, first row at the top; no opacity.

    Raises:
        ValueError: Neither PNG nor JPEG, too large, cut short or damaged.
    """
    if data.startswith(_PNG):
        width, height = _png_size(data)
    elif data.startswith(_JPEG):
        width, height = _jpeg_size(data)
    else:
        raise ValueError("is neither a PNG nor a JPEG image")
    if width * height == 0:
        raise ValueError("contains no pixel")
    if width * height > MAX_PIXELS:
        raise ValueError(f"has {width} x {height} pixels; at most {MAX_PIXELS // 1_000_000} million can be read")
    image = decoded(data, cv2.IMREAD_COLOR, (width, height), is_strict=data.startswith(_JPEG))
    return np.asarray(image[..., ::-1], np.uint8)


def averaged_down(image: Bytes) -> Bytes:
    shrunk = MAX_SIDE_PX / max(image.shape[:2])
    if shrunk < 1:
        size = [max(1, round(side * shrunk)) for side in image.shape[1::-1]]
        return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8)
    return np.ascontiguousarray(image)


def mean_of(image: Bytes) -> tuple[float, float, float]:
    """Return the mean linear colour of an sRGB image (H, W, 3); white is 1."""
    counts = (np.bincount(image[..., channel].ravel(), minlength=256) for channel in range(3))
    red, green, blue = (float(count @ LINEAR) / image[..., 0].size for count in counts)
    return red, green, blue


def _png_size(data: bytes) -> tuple[int, int]:
    """Return width and height after a check of all chunks and their checksums (PNG specification, 5.3 and 5.6)."""
    at, size = len(_PNG), (0, 0)
    while at + 12 <= len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        body, check = data[at + 4 : at + 8 + length], data[at + 8 + length : at + 12 + length]
        if len(check) < 4:
            break
        if zlib.crc32(body) != int.from_bytes(check, "big"):
            raise ValueError("is damaged: a checksum of the PNG does not hold")
        # The header must be the first chunk, and no other chunk may be a header.
        if (kind == b"IHDR") != (at == len(_PNG)):
            raise ValueError("is damaged: the PNG's header is not first, or not alone")
        if kind == b"IHDR" and length == 13:
            size = struct.unpack_from(">II", body, 4)
        if kind == b"IEND":
            return size[0], size[1]
        at += 12 + length
    raise ValueError("is cut short: the PNG has no end")


def _jpeg_size(data: bytes) -> tuple[int, int]:
    """Return width and height after a check that the image has an end (ITU-T T.81, annex B)."""
    at, size = 2, None
    while at + 2 <= len(data):
        marker = data[at + 1]
        if data[at] != 0xFF:
            raise ValueError("is damaged: the JPEG has no marker where one should be")
        if marker == 0xFF:  # filling
            at += 1
            continue
        if marker == 0xD9:
            if size is None:
                raise ValueError("is damaged: the JPEG has no frame")
            return size
        length = int.from_bytes(data[at + 2 : at + 4], "big")
        if marker in _SIZES and at + 9 <= len(data):
            if size is not None:
                raise ValueError("is damaged: the JPEG has two frames")
            height, width = struct.unpack_from(">HH", data, at + 5)
            size = width, height
        at += 2 + length
        if marker == 0xDA:  # the data of the scan follow, without a length
            at = _end_of_scan(data, at)
    raise ValueError("is cut short: the JPEG has no end")


def _end_of_scan(data: bytes, at: int) -> int:
    """Return the place of the next marker that is neither a stuffed byte nor a restart."""
    while 0 <= (at := data.find(b"\xff", at)) < len(data) - 1:
        if data[at + 1] not in {0x00, 0xFF, *range(0xD0, 0xD8)}:
            return at
        at += 1 if data[at + 1] == 0xFF else 2
    return len(data)
