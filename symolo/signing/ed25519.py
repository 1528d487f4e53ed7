"""Ed25519 (RFC 8032) by the library cryptography, which the extra `sign` brings."""

from symolo.core.extras import optional_module

SEED_BYTES, PUBLIC_BYTES, SIGNATURE_BYTES = 32, 32, 64


def public_key(seed: bytes) -> bytes:
    """Return the public key (32 bytes) that belongs to the seed of a secret key (32 bytes).

    Raises:
        EnvironmentLacking: The library is not installed.
    """
    return _library().Ed25519PrivateKey.from_private_bytes(seed).public_key().public_bytes_raw()


def sign(seed: bytes, message: bytes) -> bytes:
    """Return the signature (64 bytes) of a message, which is the same each time.

    Raises:
        EnvironmentLacking: The library is not installed.
    """
    return _library().Ed25519PrivateKey.from_private_bytes(seed).sign(message)


def is_signature(public: bytes, signature: bytes, message: bytes) -> bool:
    """Return whether the owner of a public key has signed this message.

    Raises:
        EnvironmentLacking: The library is not installed.
    """
    invalid = optional_module("cryptography.exceptions").InvalidSignature
    try:
        _library().Ed25519PublicKey.from_public_bytes(public).verify(signature, message)
    except (invalid, ValueError):  # ValueError: bytes that are no point of the curve
        return False
    return True


def _library():  # noqa: ANN202 - a module that may be missing
    return optional_module("cryptography.hazmat.primitives.asymmetric.ed25519")
