"""Meshes of the user: glTF, OBJ and STL files, read from memory without opening any other file."""

import io
import json
import warnings

import numpy as np

from symolo.arena.mesh import MAX_TRIANGLES, TriangleMesh

MAX_BYTES = 32 << 20
MIN_SIZE_M, MAX_SIZE_M = 0.002, 20.0
FORMATS = {".glb": "glb", ".gltf": "gltf", ".obj": "obj", ".stl": "stl"}
"""Name of each format in trimesh by the ending of the file."""
GLTF = frozenset({".glb", ".gltf"})
"""Formats whose y axis points upwards (glTF 2.0, section 3.4)."""


class _OtherFileError(Exception):
    """A mesh refers to another file."""


class _TooManyError(Exception):
    """A mesh has more triangles than can be used."""


def _check_counts(data: bytes) -> None:
    """Refuse a glTF file that states a number of values which its reader would allocate before it reads any."""
    text = data[20 : 20 + int.from_bytes(data[12:16], "little")] if data.startswith(b"glTF") else data
    for accessor in json.loads(text).get("accessors", ()):
        if not 0 <= accessor["count"] <= 3 * MAX_TRIANGLES:
            raise _TooManyError("too many corners or")


class _NoFiles(dict[str, bytes]):
    def __missing__(self, name: str) -> bytes:
        raise _OtherFileError(name)

    def get(self, name: str, default: object = None) -> bytes:  # pyright: ignore[reportIncompatibleMethodOverride]
        del default
        raise _OtherFileError(name)


def read_mesh(data: bytes, ending: str, scale: float, up: str, *, is_standing: bool = True) -> TriangleMesh:
    """Return the triangles of a file's bytes.

    Args:
        data: The bytes of the file.
        ending: Ending of its name, which is one of `FORMATS`.
        scale: Factor from its lengths to metres.
        up: Axis that points upwards, y or z.
        is_standing: Whether it is moved so that it stands on the floor above the origin.

    Raises:
        ValueError: It cannot be read, refers to other files, has no triangles or too many, or is too large or small.
    """
    vertices, triangles = _triangles(data, ending)
    if not len(triangles):
        raise ValueError("has no triangles")
    if not np.isfinite(vertices).all():
        raise ValueError("has vertices that are not finite numbers")
    placed = vertices * scale
    if up == "y":  # to z up: x stays, y becomes z, z becomes -y
        placed = np.column_stack([placed[:, 0], -placed[:, 2], placed[:, 1]])
    low, high = placed.min(axis=0), placed.max(axis=0)
    smallest, largest = float((high - low).min()), float((high - low).max())
    if smallest < MIN_SIZE_M or largest > MAX_SIZE_M:
        sizes = " x ".join(f"{length:.4g}" for length in high - low)
        raise ValueError(f"is {sizes} m; each length must be from {MIN_SIZE_M:g} to {MAX_SIZE_M:g} m")
    if is_standing:
        placed = placed - (*(0.5 * (low + high))[:2], low[2])
    # As 32-bit numbers, so that the shape is that which a specification stores.
    return TriangleMesh(placed.astype(np.float32).astype(float), triangles)


def _triangles(data: bytes, ending: str) -> tuple[np.ndarray, np.ndarray]:
    import trimesh  # noqa: PLC0415 - only where there are meshes

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # The resolver has no files, so that a reference to another one fails. Materials would decode images.
            options = {"process": False, "resolver": _NoFiles()}
            options |= {"skip_materials": True} if ending != ".stl" else {}
            if ending in GLTF:
                _check_counts(data)
            scene = trimesh.load_scene(io.BytesIO(data), file_type=FORMATS[ending], **options)
            shown = [scene.graph[node][1] for node in scene.graph.nodes_geometry]
            count = sum(len(getattr(scene.geometry[name], "faces", ())) for name in shown)
            if count > MAX_TRIANGLES:
                raise _TooManyError(count)  # noqa: TRY301 - before its copies are made
            body = scene.to_mesh()
    except _OtherFileError as other:
        raise ValueError(f"refers to another file, {str(other)[:60]!r}; save it as one file, such as .glb") from None
    except _TooManyError as many:
        raise ValueError(f"has {many} triangles; at most {MAX_TRIANGLES} can be used") from None
    except Exception as error:  # noqa: BLE001 - the reader raises whatever a damaged file leads to
        raise ValueError(f"cannot be read as {FORMATS[ending]}: {type(error).__name__}: {error}"[:200]) from None
    vertices = np.array(body.vertices, dtype=float).reshape(-1, 3)
    triangles = np.array(body.faces, dtype=np.int64).reshape(-1, 3)
    if len(triangles) and not 0 <= triangles.min() <= triangles.max() < len(vertices):
        raise ValueError("has triangles with vertices that do not exist")
    used, numbers = np.unique(triangles, return_inverse=True)
    return vertices[used], numbers.reshape(-1, 3)
