"""Files of the user that a look names: looked up in its folder, read, and described by their content."""

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

from configs.assets.refusal import Refusal
from configs.schema.appearance.asset import Asset, AssetKind
from configs.schema.base import FILE_KEY
from configs.validation.shapes import Shape
from symolo.core.errors import InputError, nearest
from symolo.core.yaml.reader import displayed
from symolo.core.yaml.tree import FieldPath, Node, dotted, node_of

_FOLDER: FieldPath = ("look", "assets")
_MAX_NAME_LENGTH = 255


def anchored(section: Node, folder: Path) -> Node:
    """Return a section with an absolute path of its `assets`, which is relative to `folder` in a file."""
    assets, fields = section.child("assets"), section.value
    if assets is None or not isinstance(assets.value, str) or not assets.value or not isinstance(fields, dict):
        return section
    place = os.path.abspath(folder / os.path.expanduser(assets.value))  # noqa: PTH100, PTH111 - no link is followed yet
    return Node({**fields, "assets": Node(place, assets.where)}, section.where)


def with_assets(root: Node, shape: Shape) -> tuple[Node, dict[str, Path]]:
    """Return the tree with the files that its look names in place of their folder, and their paths by SHA-256.

    Args:
        root: Tree of a scenario, or of a section.
        shape: Shape of its model.

    Raises:
        InputError: A named file does not exist, is outside the folder, or cannot be used.
    """
    look = root.child("look")
    if look is None or not isinstance(look.value, dict):
        return root, {}
    folder = _Folder.from_node(look.child("assets"))
    for path, kind, known, node in _named(look, shape):
        for name in _names(node, path):
            if name not in known:
                folder.take(name, kind, known, Node(name, node.where), path)
    fields = {key: node for key, node in look.value.items() if key != "assets"}
    if folder.taken:
        assets = [asset.model_dump(mode="json") for _, asset in sorted(folder.taken.items())]
        fields["assets"] = node_of(assets, folder.where)
    if not isinstance(root.value, dict):
        return root, {}
    return Node({**root.value, "look": Node(fields, look.where)}, root.where), folder.places


def fields_with_files(shape: Shape) -> frozenset[str]:
    """Return the field paths of a look whose value may be the name of a file, and that of the folder."""
    inner = shape.child("look")
    leaves = inner.leaves_with_files if inner else ()
    return frozenset({dotted(_FOLDER), *(dotted(("look", *path)) for path, _ in leaves)})


def _named(look: Node, shape: Shape) -> Iterator[tuple[FieldPath, AssetKind, tuple[str, ...], Node]]:
    """Yield the fields of the look that take a file: path, kind, shipped names, and the node."""
    inner = shape.child("look")
    for path, leaf in inner.leaves_with_files if inner else ():
        node = look.at(path)
        if node is not None and node.value is not None:
            yield ("look", *path), leaf.schema[FILE_KEY], tuple(leaf.schema.get("enum", ())), node


def _names(node: Node, path: FieldPath) -> list[str]:
    """Return the possible values of a leaf: its value, or each option of a choice; others are refused later."""
    options = node.child("choice") if node.is_distribution else node
    items = options.value if options else ()
    if isinstance(items, tuple):
        return [item.value for item in items if isinstance(item.value, str)]
    if not isinstance(items, str):
        if node.is_distribution:
            return []
        raise InputError(dotted(path), where=node.where, got=node.plain(), allowed="the name of a file")
    return [items]


def place_in(folder: Path, name: str, key: str) -> Path:
    """Return the path of a file in a folder of the user, after following links.

    Raises:
        Refusal: It is outside the folder that `key` names, or there is no such file.
    """
    parts = PurePosixPath(name).parts
    if PurePosixPath(name).is_absolute() or ".." in parts:
        raise Refusal(f"leads out of the folder of {key}", cure="name a file inside, without '..'")
    if not parts or len(name) > _MAX_NAME_LENGTH or not name.isprintable():
        raise Refusal("is no name of a file")
    try:
        place = (folder / name).resolve(strict=True)
        inside = place.is_relative_to(folder.resolve(strict=True))
    except (OSError, RuntimeError, ValueError):
        raise Refusal(f"no such file in {displayed(folder)}", is_missing=True) from None
    if not inside:
        raise Refusal(f"is a link that leads out of the folder of {key}", cure="put the file itself there")
    if not place.is_file():
        raise Refusal("is no file", cure="name a file in the folder")
    return place


@dataclass
class _Folder:
    path: Path | None
    where: str = ""
    taken: dict[tuple[str, AssetKind], Asset] = field(default_factory=dict)
    """Files by name and kind."""
    places: dict[str, Path] = field(default_factory=dict)
    """Paths by SHA-256."""

    @classmethod
    def from_node(cls, node: Node | None) -> "_Folder":
        if node is None or node.value is None:
            return cls(None)
        what = dotted(_FOLDER)
        if not isinstance(node.value, str) or not node.value:
            raise InputError(what, where=node.where, got=node.plain(), allowed="the path of a folder")
        if not os.path.isdir(node.value):  # noqa: PTH112 - pathlib raises for a name that the system refuses
            raise InputError(f"{what}: no such folder", where=node.where, got=displayed(Path(node.value)))
        return cls(Path(node.value), node.where)

    def take(self, name: str, kind: AssetKind, known: tuple[str, ...], node: Node, path: FieldPath) -> None:
        """Read a file and record it."""
        if self.path is None:
            allowed = f"one of {', '.join(known)}, or a file" if known else "a file"
            raise InputError(
                dotted(path),
                where=node.where,
                got=name,
                allowed=f"{allowed} in the folder that look.assets names",
                nearest=nearest(name, known),
                cure="name the folder, such as assets: my_photos in the look" if not nearest(name, known) else "",
            )
        if (name, kind) in self.taken:
            return
        from configs.assets.reading import read_asset  # noqa: PLC0415 - OpenCV, only where there are files to read

        try:
            place = place_in(self.path, name, dotted(_FOLDER))
            self.taken[name, kind] = asset = read_asset(kind, name, place)
        except Refusal as refusal:
            what = f"{dotted(path)}: {refusal}"
            close = nearest(name, [*known, *self._beside(self.path)]) if refusal.is_missing else ""
            cure = "" if close else refusal.cure
            raise InputError(what, where=node.where, got=name, nearest=close, cure=cure) from None
        self.places[asset.sha256] = place

    @staticmethod
    def _beside(folder: Path) -> list[str]:
        try:
            return [entry.name for entry in folder.iterdir()]
        except OSError:
            return []
