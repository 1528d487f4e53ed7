"""Meshes of the user that an arena names: read once and put into the tree as text, so that no file is needed later."""

import hashlib
import os
from pathlib import Path

from configs.assets.folder import place_in
from configs.assets.refusal import Refusal
from symolo.core.errors import InputError, nearest
from symolo.core.yaml.reader import displayed
from symolo.core.yaml.tree import FieldPath, Node, dotted, node_of

Size = tuple[float, float, float]


def with_meshes(root: Node) -> Node:
    """Return the tree with the shape and the size of each obstacle, and of the robot's body, whose mesh names a file.

    Args:
        root: Tree of a scenario, or of a section, with all defaults.

    Raises:
        InputError: A file does not exist, is outside the folder, or cannot be used.
    """
    if not isinstance(root.value, dict):
        return root
    fields = dict(root.value)
    for kind in ("arena", "robot"):
        section = root.child(kind)
        if section is not None and isinstance(section.value, dict):
            folder = section.child("assets")
            inner = {key: node for key, node in section.value.items() if key != "assets"}
            fields[kind] = Node(_WITH_SHAPES[kind](inner, folder), section.where)
    return Node(fields, root.where)


def _with_obstacles(arena: dict[str, Node], folder: Node | None) -> dict[str, Node]:
    obstacles = arena.get("obstacles")
    if obstacles is None or not isinstance(obstacles.value, tuple):
        return arena
    items = []
    for index, item in enumerate(obstacles.value):
        mesh, size = _filled(item.child("mesh"), folder, ("arena", "obstacles", index, "mesh", "file"))
        if mesh is not None and size is not None and isinstance(item.value, dict):
            items.append(Node({**item.value, "mesh": mesh, "size": node_of([*size], mesh.where)}, item.where))
        else:
            items.append(item)
    return {**arena, "obstacles": Node(tuple(items), obstacles.where)}


def _with_body(robot: dict[str, Node], folder: Node | None) -> dict[str, Node]:
    body = robot.get("body")
    if body is None or not isinstance(body.value, dict):
        return robot
    mesh, _ = _filled(body.child("mesh"), folder, ("robot", "body", "mesh", "file"))
    return robot if mesh is None else {**robot, "body": Node({**body.value, "mesh": mesh}, body.where)}


_WITH_SHAPES = {"arena": _with_obstacles, "robot": _with_body}


def _filled(mesh: Node | None, folder: Node | None, path: FieldPath) -> tuple[Node | None, Size | None]:
    """Return a mesh with its shape, and its size [m]; nothing where there is none, or where it has its shape."""
    if mesh is None or not isinstance(mesh.value, dict):
        return None, None
    name, packed = mesh.child("file"), mesh.child("packed")
    if name is None or not isinstance(name.value, str) or (packed is not None and packed.value):
        return None, None  # the schema reports a file that is no text; a mesh that is packed came from a release
    key = f"{path[0]}.assets"
    try:
        digest, text, size = _packed(name.value, folder, mesh, key)
    except Refusal as refusal:
        close = nearest(name.value, _beside(folder)) if refusal.is_missing else ""
        what = f"{dotted(path)}: {refusal}"
        raise InputError(what, where=name.where, got=name.value, nearest=close, cure=refusal.cure) from None
    fields = {key: Node(value, name.where) for key, value in (("sha256", digest), ("packed", text))}
    return Node({**mesh.value, **fields}, mesh.where), size


def _packed(name: str, folder: Node | None, mesh: Node, key: str) -> tuple[str, str, Size]:
    """Return the SHA-256 of a file, its text for the specification, and its size [m]."""
    from configs.assets.mesh_files import FORMATS, GLTF, MAX_BYTES, read_mesh  # noqa: PLC0415 - only with meshes
    from configs.assets.reading import read_bytes  # noqa: PLC0415 - as above

    if folder is None or not isinstance(folder.value, str) or not os.path.isdir(folder.value):  # noqa: PTH112
        where = "" if folder is None else f", which is {displayed(Path(str(folder.value)))}"
        cure = f"name it, such as assets: my_meshes in the {key.partition('.')[0]}"
        raise Refusal(f"there is no folder {key}{where}", cure=cure)
    ending = Path(name).suffix.lower()
    if ending not in FORMATS:
        raise Refusal(f"has none of the endings {', '.join(FORMATS)}", cure="save it as .glb, .obj or .stl")
    scale, up = (mesh.plain_at((key,)) for key in ("scale", "up"))
    factor = float(scale) if isinstance(scale, int | float) else 1.0
    axis = up if up in {"y", "z"} else ("y" if ending in GLTF else "z")
    data = read_bytes(place_in(Path(folder.value), name, key), MAX_BYTES)
    try:
        body = read_mesh(data, ending, factor, axis, is_standing=key == "arena.assets")
    except ValueError as error:
        cure = "set mesh.scale, such as 0.001 for millimetres" if str(error).startswith("is ") else ""
        raise Refusal(str(error), cure=cure) from None
    return hashlib.sha256(data).hexdigest(), body.packed(), body.size


def _beside(folder: Node | None) -> list[str]:
    try:
        return [entry.name for entry in Path(str(folder.value)).iterdir()] if folder else []
    except OSError:
        return []
