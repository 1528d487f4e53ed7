"""Public keys and signatures as minisign writes them: a line of comment, then a line of Base64.

A signature file has four lines: a comment that anybody may change, the signature of the data, a trusted comment, and
the signature of both. The data is hashed with BLAKE2b first (`ED`); the older form without the hash (`Ed`) is read too.
"""

import base64
import binascii
import hashlib
from dataclasses import dataclass

from symolo.signing.ed25519 import PUBLIC_BYTES, SIGNATURE_BYTES, is_signature

MAX_BYTES = 1 << 14
"""Largest size [byte] of a file that is read; the comments of minisign have at most 8 KiB."""
KEY_ALGORITHM, HASHED, UNHASHED = b"Ed", b"ED", b"Ed"
KEY_ID_BYTES = 8
UNTRUSTED, TRUSTED = "untrusted comment: ", "trusted comment: "


@dataclass(frozen=True)
class PublicKey:
    """The key that proves who has signed."""

    key_id: bytes
    """(8,) random id of the pair of keys."""
    key: bytes
    """(32,), public key of Ed25519."""

    @classmethod
    def from_text(cls, text: str) -> "PublicKey":
        """Read a public key file, or its second line alone.

        Raises:
            ValueError: It is none; the text says why.
        """
        lines = text.strip().splitlines()
        if len(lines) > 1 and not lines[0].startswith(UNTRUSTED):
            raise ValueError(f"its first line does not begin with `{UNTRUSTED.strip()}`")
        if len(lines) not in {1, 2}:
            raise ValueError(f"a public key has two lines, this has {len(lines)}")
        data = decoded(lines[-1], len(KEY_ALGORITHM) + KEY_ID_BYTES + PUBLIC_BYTES)
        if not data.startswith(KEY_ALGORITHM):
            raise ValueError("it is of another algorithm than Ed25519")
        start = len(KEY_ALGORITHM)
        return cls(data[start : start + KEY_ID_BYTES], data[start + KEY_ID_BYTES :])

    @property
    def name(self) -> str:
        """The number of the key as minisign prints it."""
        return name_of(self.key_id)

    def to_text(self) -> str:
        """Return the content of a public key file."""
        data = encoded(KEY_ALGORITHM + self.key_id + self.key)
        return f"{UNTRUSTED}minisign public key {self.name}\n{data}\n"


@dataclass(frozen=True)
class Signature:
    """A signature of some data and of a comment."""

    algorithm: bytes
    """`ED` where the data is hashed first, `Ed` where it is not."""
    key_id: bytes
    """(8,) id of the key that signed."""
    data_signature: bytes
    """(64,) signature of the data."""
    comment: str
    """The trusted comment, one line."""
    whole_signature: bytes
    """(64,) signature of `data_signature` and the comment."""

    @classmethod
    def from_bytes(cls, data: bytes) -> "Signature":
        """Read a signature file.

        Raises:
            ValueError: It is none, or not a whole one; the text says why.
        """
        try:
            lines = data.decode().split("\n")
        except UnicodeDecodeError:
            raise ValueError("it is no text") from None
        lines = [line.removesuffix("\r") for line in (lines[:-1] if lines[-1] == "" else lines)]
        if len(lines) != 4:
            raise ValueError(f"it has four lines, this has {len(lines)}")
        for number, start in ((1, UNTRUSTED), (3, TRUSTED)):
            if not lines[number - 1].startswith(start):
                raise ValueError(f"line {number} does not begin with `{start.strip()}`")
        signed = _decoded_line(lines, 2, len(HASHED) + KEY_ID_BYTES + SIGNATURE_BYTES)
        algorithm, key_id = signed[:2], signed[2 : 2 + KEY_ID_BYTES]
        if algorithm not in {HASHED, UNHASHED}:
            raise ValueError("line 2 is of another algorithm than Ed25519")
        comment, whole_signature = lines[2].removeprefix(TRUSTED), _decoded_line(lines, 4, SIGNATURE_BYTES)
        return cls(algorithm, key_id, signed[2 + KEY_ID_BYTES :], comment, whole_signature)

    def to_bytes(self, untrusted: str) -> bytes:
        """Return the content of a signature file; `untrusted` is its first comment."""
        first = encoded(self.algorithm + self.key_id + self.data_signature)
        return f"{UNTRUSTED}{untrusted}\n{first}\n{TRUSTED}{self.comment}\n{encoded(self.whole_signature)}\n".encode()

    def problem(self, key: PublicKey, data: bytes) -> str:
        """Return why this is no signature of the data by the key, in words; empty where it is one."""
        if self.key_id != key.key_id:
            return f"was made by the key {name_of(self.key_id)}, not by the key {key.name}"
        signs_data = is_signature(key.key, self.data_signature, message_of(data, self.algorithm))
        signs_comment = is_signature(key.key, self.whole_signature, self.data_signature + self.comment.encode())
        if signs_data and signs_comment:
            return ""
        if signs_data:
            return "was changed: its trusted comment is not the one that was signed"
        if signs_comment:  # the file is whole and of this key, so it signs other data
            return f"is by this key, but of other content; it was made for `{self.comment}`"
        return f"was not made by the key {key.name}, or was changed"


def message_of(data: bytes, algorithm: bytes) -> bytes:
    """Return what is signed in place of the data."""
    return hashlib.blake2b(data).digest() if algorithm == HASHED else data


def name_of(key_id: bytes) -> str:
    """Return the number of a key as minisign prints it."""
    return f"{int.from_bytes(key_id, 'little'):X}"


def encoded(data: bytes) -> str:
    """Return bytes as Base64."""
    return base64.b64encode(data).decode()


def decoded(line: str, length: int) -> bytes:
    """Return the bytes of a line of Base64.

    Raises:
        ValueError: It is none, or of another number of bytes.
    """
    try:
        data = base64.b64decode(line, validate=True)
    except (binascii.Error, ValueError):
        raise ValueError("its Base64 cannot be read") from None
    if len(data) != length:
        raise ValueError(f"its Base64 holds {len(data)} bytes in place of {length}")
    return data


def _decoded_line(lines: list[str], number: int, length: int) -> bytes:
    try:
        return decoded(lines[number - 1], length)
    except ValueError as error:
        raise ValueError(f"line {number}: {error}") from None
