"""A body of triangles, and its text in a specification, which needs no other file.

The text is base64 of a zlib stream: two counts, the vertices as 32-bit floats and the triangles as 32-bit numbers.
"""

import base64
import binascii
import zlib
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import Array

MAX_TRIANGLES = 20_000
_MAX_BYTES = 8 + 12 * 3 * MAX_TRIANGLES + 12 * MAX_TRIANGLES


@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """A body with its origin below the middle of its bounding box, on the floor; z is up."""

    vertices: Array
    """(N, 3) [m]."""
    triangles: NDArray[np.int64]
    """(M, 3), numbers of vertices, counter-clockwise seen from outside."""

    def __post_init__(self) -> None:
        self.vertices.flags.writeable = False
        self.triangles.flags.writeable = False

    @property
    def size(self) -> tuple[float, float, float]:
        """Lengths [m] of the bounding box."""
        length, width, height = np.ptp(self.vertices, axis=0).tolist()
        return length, width, height

    def packed(self) -> str:
        counts = np.array([len(self.vertices), len(self.triangles)], dtype="<u4")
        data = counts.tobytes() + self.vertices.astype("<f4").tobytes() + self.triangles.astype("<u4").tobytes()
        return base64.b64encode(zlib.compress(data, 9)).decode()


@lru_cache(maxsize=64)
def unpacked(text: str) -> TriangleMesh:
    """Return the body of a text.

    Raises:
        ValueError: It is damaged, or has more than `MAX_TRIANGLES`.
    """
    try:
        packed = base64.b64decode(text, validate=True)
        reader = zlib.decompressobj()
        data = reader.decompress(packed, _MAX_BYTES + 1)
    except (binascii.Error, zlib.error) as error:
        raise ValueError(f"is no packed mesh: {error}") from None
    if len(data) < 8 or len(data) > _MAX_BYTES or not reader.eof:
        raise ValueError("is no packed mesh, or a part of one")
    vertex_count, triangle_count = np.frombuffer(data, "<u4", 2).tolist()
    if triangle_count > MAX_TRIANGLES or len(data) != 8 + 12 * vertex_count + 12 * triangle_count:
        raise ValueError("is no packed mesh: its counts are not those of its content")
    vertices = np.frombuffer(data, "<f4", 3 * vertex_count, 8).astype(float).reshape(-1, 3)
    triangles = np.frombuffer(data, "<u4", 3 * triangle_count, 8 + 12 * vertex_count).astype(np.int64).reshape(-1, 3)
    if not triangle_count or not np.isfinite(vertices).all() or triangles.max() >= vertex_count:
        raise ValueError("is no packed mesh: it has no triangles, or values that are not numbers")
    return TriangleMesh(vertices, triangles)
