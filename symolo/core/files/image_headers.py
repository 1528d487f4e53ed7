"""Width and height of PNG and JPEG images, read from their bytes before anything is unpacked.

A small file may unpack to any number of pixels, and a progressive JPEG goes over all of them again for each of its
scans: 470 kB with 1,000 scans keep a decoder busy for minutes. Encoders write about ten scans.
"""

import re
import struct
import zlib
from dataclasses import dataclass

PNG = b"\x89PNG\r\n\x1a\n"
JPEG = b"\xff\xd8\xff"
MAX_PARTS = 100_000
"""Chunks of a PNG, or markers and filling bytes of a JPEG; 64 MiB in chunks of 8 KiB, as libpng writes, are 8,192."""
MAX_SCANS = 100
MAX_DECODED_PIXELS = 350_000_000
"""Pixels times scans; a decoder takes two seconds for as many, where the scans refine all coefficients."""
MAX_DECODER_BYTES = 512_000_000
"""Memory that OpenCV takes to decode an image; 403 MB for colours of 8 bits of the largest one that can be rendered."""

_SIZES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""JPEG markers of frames, which contain the image's size (ITU-T T.81, table B.1)."""
_BASELINE, _EXTENDED, _PROGRESSIVE = 0xC0, 0xC1, 0xC2
"""The three frames that encoders write; arithmetic coding takes several times longer to decode."""
_MARKER = re.compile(rb"\xff[^\x00\xff\xd0-\xd7]")
"""Marker that ends the data of a scan: no stuffed byte, no filling and no restart."""
_COPIES = 2
"""Number of times that OpenCV holds the decoded image."""
_COPIES_AND_COEFFICIENTS = 3
"""The same number if no scan has the whole image: two bytes for each coefficient, before the second copy is made."""
_CHANNELS = {0: 1, 2: 3}
"""Number of values of a decoded pixel by the colour type of a PNG, grey or colours; of others four, with opacity."""


@dataclass(frozen=True)
class _Header:
    """Size of an image by its header, and the resources that its decoder needs."""

    width: int
    height: int
    decoder_bytes: int
    scans: int = 1


def image_size(data: bytes, max_pixels: int) -> tuple[int, int]:
    """Return width and height of an image that has an end and is no larger than can be decoded in seconds.

    Raises:
        ValueError: Neither PNG nor JPEG, without pixels, too large, cut short or damaged.
    """
    if data.startswith(PNG):
        header = _png_header(data)
    elif data.startswith(JPEG):
        header = _jpeg_header(data)
    else:
        raise ValueError("is neither a PNG nor a JPEG image")
    pixels, size = header.width * header.height, f"{header.width} x {header.height} pixels"
    if pixels == 0:
        raise ValueError("contains no pixel")
    if pixels > max_pixels:
        raise ValueError(f"has {size}; at most {max_pixels // 1_000_000} million can be read")
    if header.scans > MAX_SCANS or header.scans * pixels > MAX_DECODED_PIXELS:
        raise ValueError(f"is a JPEG of {size} in {header.scans} scans, which takes too long to decode")
    if header.decoder_bytes > MAX_DECODER_BYTES:
        raise ValueError(f"has {size}, which take {header.decoder_bytes // 1_000_000} MB to decode")
    return header.width, header.height


def _png_header(data: bytes) -> _Header:
    """Return the header after a check of all chunks and their checksums (PNG specification, 5.3 and 5.6)."""
    at, width, height, depth, channels = len(PNG), 0, 0, 0, 0
    for _ in range(MAX_PARTS):
        if at + 12 > len(data):
            raise ValueError("is cut short: the PNG has no end")
        length, kind = struct.unpack_from(">I4s", data, at)
        body, check = data[at + 4 : at + 8 + length], data[at + 8 + length : at + 12 + length]
        if len(check) < 4:
            raise ValueError("is cut short: the PNG has no end")
        if zlib.crc32(body) != int.from_bytes(check, "big"):
            raise ValueError("is damaged: a checksum of the PNG does not hold")
        # The header must be the first chunk, and no other chunk may be a header.
        if (kind == b"IHDR") != (at == len(PNG)):
            raise ValueError("is damaged: the PNG's header is not first, or not alone")
        if kind == b"IHDR" and length == 13:
            width, height, depth, colour_type = struct.unpack_from(">IIBB", body, 4)
            channels = _CHANNELS.get(colour_type, 4)
        if kind == b"tRNS":  # colours that are transparent
            channels = 4
        if kind == b"acTL":
            raise ValueError("is an animation")
        if kind == b"IEND":
            return _Header(width, height, _COPIES * width * height * channels * max(1, depth // 8))
        at += 12 + length
    raise ValueError(f"is a PNG of more than {MAX_PARTS} chunks")


def _jpeg_header(data: bytes) -> _Header:
    """Return the header after a check that the image has an end (ITU-T T.81, annex B)."""
    at, frame, components_of_scans = 2, None, bytearray()
    for _ in range(MAX_PARTS):
        if at + 2 > len(data):
            raise ValueError("is cut short: the JPEG has no end")
        marker = data[at + 1]
        if data[at] != 0xFF:
            raise ValueError("is damaged: the JPEG has no marker where one should be")
        if marker == 0xFF:  # filling
            at += 1
            continue
        if marker == 0xD9:
            return _header(frame, bytes(components_of_scans))
        length = int.from_bytes(data[at + 2 : at + 4], "big")
        if marker in _SIZES and at + 10 <= len(data):
            if frame is not None:
                raise ValueError("is damaged: the JPEG has two frames")
            frame = marker, *struct.unpack_from(">HHB", data, at + 5)
        if marker == 0xDA:
            components_of_scans += data[at + 4 : at + 5]
        at += 2 + length
        if marker == 0xDA:  # the data of the scan follow, without a length
            end = _MARKER.search(data, at)
            at = end.start() if end else len(data)
    raise ValueError(f"is a JPEG of more than {MAX_PARTS} markers")


def _header(frame: tuple[int, int, int, int] | None, components_of_scans: bytes) -> _Header:
    if frame is None:
        raise ValueError("is damaged: the JPEG has no frame")
    marker, height, width, components = frame
    if marker not in {_BASELINE, _EXTENDED, _PROGRESSIVE}:
        raise ValueError("is a JPEG of a rare kind: arithmetic, lossless or hierarchical")
    is_whole = marker != _PROGRESSIVE and components_of_scans == bytes([components])
    copies = _COPIES if is_whole else _COPIES_AND_COEFFICIENTS
    return _Header(width, height, copies * width * height * components, len(components_of_scans))
