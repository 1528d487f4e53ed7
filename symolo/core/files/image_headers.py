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
MAX_DECODED_BYTES = 420_000_000
"""Memory of the decoded image; 8192 x 8192 pixels of three channels with 16 bits take 403 MB."""

_SIZES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""JPEG markers of frames, which contain the image's size (ITU-T T.81, table B.1)."""
_CHANNELS = {0: 1, 2: 3, 3: 4, 4: 4, 6: 4}
"""Channels of a decoded PNG image by its type of colour (PNG specification, 11.2.1)."""
_MARKER = re.compile(rb"\xff[^\x00\xff\xd0-\xd7]")
"""What ends the data of a scan: no stuffed byte, no filling and no restart."""


def image_size(data: bytes, max_pixels: int) -> tuple[int, int]:
    """Return width and height of an image that has an end and is no larger than can be decoded in seconds.

    Raises:
        ValueError: Neither PNG nor JPEG, without pixels, too large, cut short or damaged.
    """
    if data.startswith(PNG):
        (width, height, pixel_bytes), scans = _png_size(data), 1
    elif data.startswith(JPEG):
        width, height, components, scans = _jpeg_size(data)
        # A decoder of several scans holds a coefficient of 16 bits for each component until the last one.
        pixel_bytes = 3 + (2 * components if scans > 1 else 0)
    else:
        raise ValueError("is neither a PNG nor a JPEG image")
    if width * height == 0:
        raise ValueError("contains no pixel")
    if width * height > max_pixels:
        raise ValueError(f"has {width} x {height} pixels; at most {max_pixels // 1_000_000} million can be read")
    if width * height * pixel_bytes > MAX_DECODED_BYTES:
        raise ValueError(f"has {width} x {height} pixels of {pixel_bytes} bytes each, which takes too much memory")
    if scans > MAX_SCANS or scans * width * height > MAX_DECODED_PIXELS:
        raise ValueError(f"is a JPEG of {width} x {height} pixels in {scans} scans, which takes too long to decode")
    return width, height


def _png_size(data: bytes) -> tuple[int, int, int]:
    """Return width, height and bytes of a decoded pixel after a check of all chunks and their checksums.

    See the PNG specification, 5.3 and 5.6.
    """
    at, size = len(PNG), (0, 0, 0)
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
            width, height, depth, colour = struct.unpack_from(">IIBB", body, 4)
            # What has a palette or fewer than eight bits is decoded to 8 bits for each of up to four channels.
            size = width, height, max(1, depth // 8) * _CHANNELS.get(colour, 4)
        if kind == b"IEND":
            return size
        at += 12 + length
    raise ValueError("is cut short: the PNG has no end")


def _jpeg_size(data: bytes) -> tuple[int, int, int, int]:
    """Return width, height and numbers of components and of scans after a check that the image has an end.

    See ITU-T T.81, annex B.
    """
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
        if marker in _SIZES and at + 10 <= len(data):
            if size is not None:
                raise ValueError("is damaged: the JPEG has two frames")
            height, width, components = struct.unpack_from(">HHB", data, at + 5)
            size = width, height, components
        at += 2 + length
        if marker == 0xDA:  # the data of the scan follow, without a length
            scans += 1
            end = _MARKER.search(data, at)
            at = end.start() if end else len(data)
    raise ValueError("is cut short: the JPEG has no end")
