"""Random streams keyed by the path of what they serve, such as a field or a sensor, not by the order of the draws."""

import hashlib
import json

import numpy as np


def stream(seed: int, *path: str | int) -> np.random.Generator:
    """Return a generator that depends on the seed and the path alone.

    A new field, run or sensor has a path of its own, so that it changes no other stream. The key is the SHA-256 of
    both as JSON, in which `("a", "b")`, `("a.b",)`, `1` and `"1"` all differ.
    """
    key = json.dumps([seed, *path], separators=(",", ":")).encode()
    return np.random.Generator(np.random.PCG64(int.from_bytes(hashlib.sha256(key).digest(), "big")))
