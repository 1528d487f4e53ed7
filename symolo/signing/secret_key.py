"""Secret keys as minisign writes them, with or without a passphrase."""

import hashlib
import os
from dataclasses import dataclass

from symolo.signing.ed25519 import PUBLIC_BYTES, SEED_BYTES, public_key, sign
from symolo.signing.minisign import (
    HASHED,
    KEY_ALGORITHM,
    KEY_ID_BYTES,
    UNTRUSTED,
    PublicKey,
    Signature,
    decoded,
    encoded,
    message_of,
)

SCRYPT, NO_PASSPHRASE, CHECKSUM = b"Sc", b"\0\0", b"B2"
SALT_BYTES, CHECKSUM_BYTES = 32, 32
SECRET_BYTES = KEY_ID_BYTES + SEED_BYTES + PUBLIC_BYTES + CHECKSUM_BYTES
HEAD_BYTES = len(KEY_ALGORITHM + SCRYPT + CHECKSUM) + SALT_BYTES + 8 + 8
OPERATIONS, MEMORY_BYTES = 1 << 25, 1 << 30
"""Limits of minisign for scrypt: some seconds and 1 GiB of memory for each passphrase that is tried."""
MAX_MEMORY_BYTES = (1 << 31) - (1 << 20)
"""Largest memory that `hashlib.scrypt` may be allowed; a file that asks for more is refused."""
MAX_OPERATIONS = 4 * OPERATIONS
"""Largest number of operations, 4 N r p, for a passphrase; a file could ask for hours of them in little memory."""


@dataclass(frozen=True)
class SecretKey:
    """The key that signs."""

    key_id: bytes
    """(8,) random id of the pair of keys."""
    seed: bytes
    """(32,), seed of the secret key of Ed25519."""

    @classmethod
    def new(cls) -> "SecretKey":
        """Return a new key from random bytes of the operating system."""
        return cls(os.urandom(KEY_ID_BYTES), os.urandom(SEED_BYTES))

    @property
    def public(self) -> PublicKey:
        return PublicKey(self.key_id, public_key(self.seed))

    def sign(self, data: bytes, comment: str) -> Signature:
        """Return the signature of data and of a comment of one line."""
        data_signature = sign(self.seed, message_of(data, HASHED))
        return Signature(
            HASHED, self.key_id, data_signature, comment, sign(self.seed, data_signature + comment.encode())
        )

    def to_text(self, passphrase: str, operations: int = OPERATIONS, memory_bytes: int = MEMORY_BYTES) -> str:
        """Return the content of a secret key file; it is not encrypted where the passphrase is empty."""
        secret = self.key_id + self.seed + self.public.key
        if not passphrase:
            head = KEY_ALGORITHM + NO_PASSPHRASE + CHECKSUM + bytes(SALT_BYTES + 16)
            data = encoded(head + secret + bytes(CHECKSUM_BYTES))  # minisign writes no checksum here
            return f"{UNTRUSTED}minisign secret key without a passphrase\n{data}\n"
        salt = os.urandom(SALT_BYTES)
        head = KEY_ALGORITHM + SCRYPT + CHECKSUM + salt
        head += operations.to_bytes(8, "little") + memory_bytes.to_bytes(8, "little")
        hidden = _combined(secret + _checksum(secret), _stretched(passphrase, salt, operations, memory_bytes))
        return f"{UNTRUSTED}minisign encrypted secret key\n{encoded(head + hidden)}\n"


@dataclass(frozen=True)
class SecretKeyFile:
    """What a secret key file holds before the passphrase is known."""

    encrypted: bool
    salt: bytes
    """(32,) salt of scrypt."""
    operations: int
    memory_bytes: int
    secret: bytes
    """(104,) id of the key, seed, public key and checksum."""

    @classmethod
    def from_text(cls, text: str) -> "SecretKeyFile":
        """Read a secret key file.

        Raises:
            ValueError: It is none; the text says why.
        """
        lines = text.strip().splitlines()
        if len(lines) != 2 or not lines[0].startswith(UNTRUSTED):
            raise ValueError(f"a secret key has two lines, the first of which begins with `{UNTRUSTED.strip()}`")
        data = decoded(lines[1], HEAD_BYTES + SECRET_BYTES)
        if data[:2] != KEY_ALGORITHM or data[2:4] not in {SCRYPT, NO_PASSPHRASE} or data[4:6] != CHECKSUM:
            raise ValueError("it is of another algorithm than Ed25519 with scrypt and BLAKE2b")
        numbers = data[6 + SALT_BYTES : HEAD_BYTES]
        operations, memory_bytes = int.from_bytes(numbers[:8], "little"), int.from_bytes(numbers[8:], "little")
        return cls(data[2:4] == SCRYPT, data[6 : 6 + SALT_BYTES], operations, memory_bytes, data[HEAD_BYTES:])

    def opened(self, passphrase: str) -> SecretKey:
        """Return the key.

        Raises:
            ValueError: The passphrase is wrong, or the file is damaged.
        """
        secret = self.secret
        if self.encrypted:
            secret = _combined(secret, _stretched(passphrase, self.salt, self.operations, self.memory_bytes))
        content, checksum = secret[:-CHECKSUM_BYTES], secret[-CHECKSUM_BYTES:]
        if self.encrypted and checksum != _checksum(content):
            raise ValueError("the passphrase is wrong")
        key = SecretKey(content[:KEY_ID_BYTES], content[KEY_ID_BYTES : KEY_ID_BYTES + SEED_BYTES])
        if content != key.key_id + key.seed + key.public.key:
            raise ValueError("its public key is not that of its secret key")
        return key


def _checksum(content: bytes) -> bytes:
    return hashlib.blake2b(KEY_ALGORITHM + content, digest_size=CHECKSUM_BYTES).digest()


def _combined(secret: bytes, stream: bytes) -> bytes:
    return bytes(one ^ other for one, other in zip(secret, stream, strict=True))


def _stretched(passphrase: str, salt: bytes, operations: int, memory_bytes: int) -> bytes:
    """Return (104,): the bytes that hide the secret.

    Raises:
        ValueError: The machine does not take these limits.
    """
    n, r, p = scrypt_parameters(operations, memory_bytes)
    if 128 * n * r > MAX_MEMORY_BYTES:
        raise ValueError(f"its passphrase would take {128 * n * r / (1 << 30):.3g} GiB of memory to check")
    if 4 * n * r * p > MAX_OPERATIONS:
        raise ValueError(f"its passphrase would take {4 * n * r * p / OPERATIONS:.3g} times as long to check as usual")
    options = {"n": n, "r": r, "p": p, "maxmem": MAX_MEMORY_BYTES, "dklen": SECRET_BYTES}
    return hashlib.scrypt(passphrase.encode(), salt=salt, **options)


def scrypt_parameters(operations: int, memory_bytes: int) -> tuple[int, int, int]:
    """Return N, r and p of scrypt as libsodium chooses them for these limits (`crypto_pwhash_scryptsalsa208sha256`)."""
    operations, r = max(operations, 1 << 15), 8
    few_operations = operations < memory_bytes // 32
    largest = operations // (4 * r) if few_operations else memory_bytes // (128 * r)
    power = 1
    while power < 63 and 1 << power <= largest // 2:
        power += 1
    p = 1 if few_operations else min(operations // 4 // (1 << power), 0x3FFFFFFF) // r
    return 1 << power, r, max(p, 1)
