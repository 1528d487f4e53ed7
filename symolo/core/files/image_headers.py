"""Width and height of PNG and JPEG images, read from their bytes before anything is unpacked.

A small file may unpack to any number of pixels, and a progressive JPEG goes over all of them again for each of its
scans: 470 kB with 1,000 scans keep a decoder busy for minutes. Encoders write about ten scans.
"""

import re
import struct
import zlib

PNG = b"\x89PNG\r\n\x1a\n"
JPEG = b"\xff\xd8\xff"
MAX_SCANS = 100
MAX_DECODED_PIXELS = 640_000_000
"""Pixels times scans; a decoder takes some seconds for them."""

_SIZES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""JPEG markers of frames, which contain the image's size (ITU-T T.81, table B.1)."""
_MARKER = re.compile(rb"\xff[^\x00\xff\xd0-\xd7]")
"""What ends the data of a scan: no stuffed byte, no filling and no restart."""


def image_size(data: bytes, max_pixels: int) -> tuple[int, int]:
    """Return width and height of an image that has an end and is no larger than can be decoded in seconds.

    Raises:
        ValueError: Neither PNG nor JPEG, without pixels, too large, cut short or damaged.
    """
    if data.startswith(PNG):
        (width, height), scans = _png_size(data), 1
    elif data.startswith(JPEG):
        width, height, scans = _jpeg_size(data)
    else:
        raise ValueError("is neither a PNG nor a JPEG image")
    if width * height == 0:
        raise ValueError("contains no pixel")
    if width * height > max_pixels:
        raise ValueError(f"has {width} x {height} pixels; at most {max_pixels // 1_000_000} million can be read")
    if scans > MAX_SCANS or scans * width * height > MAX_DECODED_PIXELS:
        raise ValueError(f"is a JPEG of {width} x {height} pixels in {scans} scans, which takes too long to decode")
    return width, height


def _png_size(data: bytes) -> tuple[int, int]:
    """Return width and height after a check of all chunks and their checksums (PNG specification, 5.3 and 5.6)."""
    at, size = len(PNG), (0, 0)
    while at + 12 <= len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        body, check = data[at + 4 : at + 8 + length], data[at + 8 + length : at + 12 + length]
        if len(check) < 4:
            break
        if zlib.crc32(body) != int.from_bytes(check, "big"):
            raise ValueError("is damaged: a checksum of the PNG does not hold")
        # The header must be the first chunk, and no other chunk may be a header.
        if (kind == b"IHDR") != (at == len(PNG)):
            raise ValueError("is damaged: the PNG's header is not first, or not alone")
        if kind == b"IHDR" and length == 13:
            size = struct.unpack_from(">II", body, 4)
        if kind == b"IEND":
            return size[0], size[1]
        at += 12 + length
    raise ValueError("is cut short: the PNG has no end")


def _jpeg_size(data: bytes) -> tuple[int, int, int]:
    """Return width, height and number of scans after a check that the image has an end (ITU-T T.81, annex B)."""
    at, size, scans = 2, None, 0
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
            return *size, scans
        length = int.from_bytes(data[at + 2 : at + 4], "big")
        if marker in _SIZES and at + 9 <= len(data):
            if size is not None:
                raise ValueError("is damaged: the JPEG has two frames")
            height, width = struct.unpack_from(">HH", data, at + 5)
            size = width, height
        at += 2 + length
        if marker == 0xDA:  # the data of the scan follow, without a length
            scans += 1
            end = _MARKER.search(data, at)
            at = end.start() if end else len(data)
    raise ValueError("is cut short: the JPEG has no end")
