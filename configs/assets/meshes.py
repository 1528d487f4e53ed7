"""Meshes of the user that an arena names: read once and put into the tree as text, so that no file is needed later."""

import hashlib
import os
from pathlib import Path

from configs.assets.folder import place_in
from configs.assets.refusal import Refusal
from symolo.core.errors import InputError, nearest
from symolo.core.yaml.reader import displayed
from symolo.core.yaml.tree import FieldPath, Node, dotted, node_of

_FOLDER = "arena.assets"


def with_meshes(root: Node) -> Node:
    """Return the tree with the shape and the size of each obstacle whose mesh names a file.

    Args:
        root: Tree of a scenario, or of a section, with all defaults.

    Raises:
        InputError: A file does not exist, is outside the folder, or cannot be used.
    """
    arena = root.child("arena")
    if arena is None or not isinstance(arena.value, dict) or not isinstance(root.value, dict):
        return root
    fields = {key: node for key, node in arena.value.items() if key != "assets"}
    folder = arena.child("assets")
    obstacles = arena.child("obstacles")
    if obstacles is not None and isinstance(obstacles.value, tuple):
        items = [_obstacle(item, folder, index) for index, item in enumerate(obstacles.value)]
        fields["obstacles"] = Node(tuple(items), obstacles.where)
    return Node({**root.value, "arena": Node(fields, arena.where)}, root.where)


def _obstacle(item: Node, folder: Node | None, index: int) -> Node:
    mesh = item.child("mesh")
    if mesh is None or not isinstance(mesh.value, dict) or not isinstance(item.value, dict):
        return item
    name, packed = mesh.child("file"), mesh.child("packed")
    if name is None or not isinstance(name.value, str) or (packed is not None and packed.value):
        return item  # the schema reports a file that is no text; a mesh that is packed came from a release
    path: FieldPath = ("arena", "obstacles", index, "mesh", "file")
    try:
        digest, text, size = _packed(name.value, folder, mesh)
    except Refusal as refusal:
        close = nearest(name.value, _beside(folder)) if refusal.is_missing else ""
        what = f"{dotted(path)}: {refusal}"
        raise InputError(what, where=name.where, got=name.value, nearest=close, cure=refusal.cure) from None
    fields = {"sha256": digest, "packed": text}
    filled = Node({**mesh.value, **{key: Node(value, name.where) for key, value in fields.items()}}, mesh.where)
    return Node({**item.value, "mesh": filled, "size": node_of([*size], name.where)}, item.where)


def _packed(name: str, folder: Node | None, mesh: Node) -> tuple[str, str, tuple[float, float, float]]:
    """Return the SHA-256 of a file, its text for the specification, and its size [m]."""
    from configs.assets.mesh_files import FORMATS, GLTF, MAX_BYTES, read_mesh  # noqa: PLC0415 - only with meshes
    from configs.assets.reading import read_bytes  # noqa: PLC0415 - as above

    if folder is None or not isinstance(folder.value, str) or not os.path.isdir(folder.value):  # noqa: PTH112
        given = "" if folder is None else f", which is {displayed(Path(str(folder.value)))}"
        raise Refusal(f"there is no folder {_FOLDER}{given}", cure="name it, such as assets: my_meshes in the arena")
    ending = Path(name).suffix.lower()
    if ending not in FORMATS:
        raise Refusal(f"has none of the endings {', '.join(FORMATS)}", cure="save it as .glb, .obj or .stl")
    scale, up = (mesh.plain_at((key,)) for key in ("scale", "up"))
    factor = float(scale) if isinstance(scale, int | float) else 1.0
    axis = up if up in {"y", "z"} else ("y" if ending in GLTF else "z")
    data = read_bytes(place_in(Path(folder.value), name, _FOLDER), MAX_BYTES)
    try:
        body = read_mesh(data, ending, factor, axis)
    except ValueError as error:
        cure = "set mesh.scale, such as 0.001 for millimetres" if str(error).startswith("is ") else ""
        raise Refusal(str(error), cure=cure) from None
    return hashlib.sha256(data).hexdigest(), body.packed(), body.size


def _beside(folder: Node | None) -> list[str]:
    try:
        return [entry.name for entry in Path(str(folder.value)).iterdir()] if folder else []
    except OSError:
        return []
