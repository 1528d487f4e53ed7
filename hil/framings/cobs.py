"""Consistent overhead byte stuffing: bytes without a zero, so that a zero ends a frame (Cheshire and Baker 1999)."""

_BLOCK = 254
"""Largest number of bytes other than zero after one code byte."""


def stuffed(data: bytes) -> bytes:
    """Return the data without zeros; it is longer by one byte, and by one more for each 254 bytes."""
    out = bytearray()
    # A phantom zero ends the last block; what follows it is never sent.
    for block in bytes(data + b"\0").split(b"\0")[:-1]:
        left = block
        while len(left) >= _BLOCK:
            out += bytes([_BLOCK + 1]) + left[:_BLOCK]
            left = left[_BLOCK:]
        out += bytes([len(left) + 1]) + left
    return bytes(out)


def unstuffed(data: bytes) -> bytes | None:
    """Return the data before stuffing, or None where `data`, which holds no zero, is not stuffed data."""
    out = bytearray()
    at = 0
    while at < len(data):
        code = data[at]
        block = data[at + 1 : at + code]
        if code == 0 or len(block) != code - 1:
            return None
        out += block
        at += code
        if code <= _BLOCK and at < len(data):
            out.append(0)
    return bytes(out) if data else None
