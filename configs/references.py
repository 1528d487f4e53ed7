"""Names and paths of scenarios, arenas, robots and looks, and files that extend others by `extends:`."""

import os
import re
from pathlib import Path

from configs.assets.folder import anchored
from configs.posterior.reading import anchored_posterior
from configs.route_arenas import ROUTES, with_route_arenas
from configs.scaling import MODELS, scaled
from configs.schema.appearance.camera_look import CameraLook
from configs.user_files import anchored_files, with_files_of_both
from configs.validation.shapes import Shape, with_defaults
from symolo.core.errors import InputError, nearest
from symolo.core.yaml.reader import displayed, read_yaml
from symolo.core.yaml.tree import FieldPath, Node, dotted, merge

FOLDERS = {"scenario": "scenarios", "arena": "arenas", "robot": "robots", "look": "looks", "camera": "cameras"}
SECTIONS = ("arena", "robot", "look")
WITH_FILES = ("arena", "robot", "look")
"""Sections with a key `assets`, which names a folder of the user."""
_TEXTS = frozenset({"name", "description"})
"""Fields of a scenario that a scenario which extends it does not inherit, since they would describe another one."""
_SEVERAL = {
    "arena": "give routes an `arena` of their own, or draw one for each run with arena: random (docs/arenas.md)",
    "robot": "make a release for each robot",
    "look": "render the runs under other looks afterwards: symolo rerender DIR --looks NAME,NAME",
}
"""What to do for a dataset with several of a section."""
_MAX_CHAIN = 32
_SHIPPED = Path(__file__).parent


def shipped_names(kind: str) -> tuple[str, ...]:
    """Return the names of the shipped files of a kind, for example `("classroom", "lab")` for `look`."""
    return tuple(sorted(path.stem for path in (_SHIPPED / FOLDERS[kind]).glob("*.yaml")))


def locate(kind: str, reference: str, *, folder: Path, what: str, where: str = "") -> Path:
    """Return the file for a name or a path.

    Args:
        kind: scenario, arena, robot, look or camera.
        reference: The name of a shipped file, or a path, which has a slash or ends in .yaml.
        folder: Start of relative paths.
        what: Field path or argument with the reference, for the message.
        where: `file:line` of the reference.
    """
    names = shipped_names(kind)
    if reference in names:
        return _SHIPPED / FOLDERS[kind] / f"{reference}.yaml"
    # For names that the system refuses, os.path returns False, while pathlib raises.
    if "/" in reference or reference.endswith((".yaml", ".yml")):
        path = folder / os.path.expanduser(reference)  # noqa: PTH111 - as above
        if os.path.isfile(path):  # noqa: PTH113 - as above
            return path
        problem = "a folder, not a file" if os.path.isdir(path) else "no such file"  # noqa: PTH112 - as above
        close = _nearest_file(path, reference, names)
        raise InputError(
            f"{what}: {problem}", where=where, got=displayed(path), allowed=_references(kind), nearest=close
        )
    beside = folder / f"{reference}.yaml"
    close = f"./{beside.name}" if os.path.isfile(beside) else nearest(reference, names)  # noqa: PTH113 - as above
    raise InputError(what, where=where, got=reference, allowed=_references(kind), nearest=close)


def _references(kind: str) -> str:
    return f"the name of a shipped {kind} ({', '.join(shipped_names(kind))}) or the path of a YAML file"


def _nearest_file(path: Path, reference: str, names: tuple[str, ...]) -> str:
    """Return the shipped name or the file in the folder of `path` that is most similar to it."""
    try:
        beside = {entry.stem: entry.name for entry in path.parent.iterdir() if entry.suffix in {".yaml", ".yml"}}
    except (OSError, ValueError):
        beside = {}
    beside.pop(path.stem, None)
    close = nearest(path.stem, [*beside, *names])
    return close if close in names or not close else str(Path(reference).with_name(beside[close]))


def read_file(
    kind: str, path: Path, chain: tuple[Path, ...] = (), failed: list[tuple[str, InputError]] | None = None
) -> Node:
    """Return the tree of a file with `extends:` and, for a scenario, named sections resolved.

    A scenario that extends another one and has no name is named after its file. Sections of a scenario that cannot be
    resolved stay as they are, and are added to `failed`; without such a list, the first one ends with its error.
    """
    prefix = () if kind == "scenario" else (kind,)
    written = read_yaml(path).root
    root = resolve(kind, written, path.parent, (*chain, path.resolve()), prefix, failed=failed)
    if kind != "scenario" or root.child("name") or not written.child("extends"):
        return root
    name = re.sub(r"[^A-Za-z0-9_-]+", "-", path.stem).strip("-_") or kind
    fields = {str(key): node for key, node in root.children()}
    return Node({**fields, "name": Node(name, written.where)}, root.where)


def resolve(
    kind: str,
    root: Node,
    folder: Path,
    chain: tuple[Path, ...] = (),
    prefix: FieldPath = (),
    *,
    failed: list[tuple[str, InputError]] | None = None,
) -> Node:
    """Return a mapping merged over what it extends; relative paths in it start at `folder`; `failed` as above."""
    root = _anchored(kind, root, folder)
    root = with_camera(root, folder) if kind == "look" else root
    fields = {str(key): node for key, node in root.children()}
    complete = _resolve_sections(fields, folder, failed) if kind == "scenario" else set()
    base, scale = fields.pop("extends", None), fields.pop("scale", None)
    if base is None and scale is not None:
        raise InputError("scale", where=scale.where, cure=f"name the {kind} that it scales: extends: ...")
    if base is None:
        return Node(fields, root.where)
    what = dotted((*prefix, "extends"))
    if not isinstance(base.value, str):
        allowed = f"the name or path of one {kind}"
        raise InputError(what, where=base.where, got=base.plain(), allowed=allowed)
    if len(chain) > _MAX_CHAIN:
        raise InputError(f"{what}: too many files extend each other", where=base.where, allowed=str(_MAX_CHAIN))
    path = locate(kind, base.value, folder=folder, what=what, where=base.where)
    if path.resolve() in chain:
        turns = [displayed(file) for file in (*chain[chain.index(path.resolve()) :], path)]
        cure = "remove one of these 'extends:'"
        raise InputError(f"{what}: files extend each other, {' -> '.join(turns)}", where=base.where, cure=cure)
    beneath = scaled(kind, read_file(kind, path, chain, failed), scale)
    # A section that is complete by itself replaces the inherited one; any other is merged over it field by field.
    complete |= _TEXTS if kind == "scenario" else set()
    inherited = {str(key): node for key, node in beneath.children() if key not in complete}
    base_node, over = Node(inherited, beneath.where), Node(fields, root.where)
    return with_files_of_both(base_node, over, merge(base_node, over)) if kind == "robot" else merge(base_node, over)


def _resolve_sections(fields: dict[str, Node], folder: Path, failed: list[tuple[str, InputError]] | None) -> set[str]:
    """Resolve the sections among the fields of a scenario, and return those that are then complete."""
    complete = set()
    for section in SECTIONS:
        if section not in fields:
            continue
        try:
            fields[section], is_complete = resolve_section(section, fields[section], folder)
        except InputError as error:
            if failed is None:
                raise
            failed.append((section, error))
            is_complete = True
        complete |= {section} if is_complete else set()
    try:
        routes = with_resolved_routes(Node(fields, ""), folder).child(ROUTES)
        fields |= {} if routes is None else {ROUTES: routes}
    except InputError as error:
        if failed is None:
            raise
        failed.append((ROUTES, error))
    return complete


def with_resolved_routes(root: Node, folder: Path) -> Node:
    """Return the tree of a scenario with all settings of the arenas that its routes name or extend."""
    return with_route_arenas(root, lambda arena, path: resolve_section("arena", arena, folder, path)[0])


def _anchored(kind: str, node: Node, folder: Path) -> Node:
    """Return a section with absolute paths of the files that it names."""
    node = anchored_files(node, folder) if kind == "robot" else node
    node = anchored_posterior(node, folder) if kind == "scenario" else node
    return anchored(node, folder) if kind in WITH_FILES else node


def resolve_section(kind: str, node: Node, folder: Path, what: str = "") -> tuple[Node, bool]:
    """Return a section with its name or `extends:` resolved, and whether it is then complete.

    Args:
        kind: arena, robot or look.
        node: What is written in its place.
        folder: Start of relative paths.
        what: Field path of the section, for messages; `kind` by default.
    """
    what = what or kind
    if isinstance(node.value, str):
        return read_file(kind, locate(kind, node.value, folder=folder, what=what, where=node.where)), True
    if not isinstance(node.value, dict):
        allowed = f"{_references(kind)}, or a mapping"
        raise InputError(what, where=node.where, got=node.plain(), allowed=allowed)
    if node.is_distribution:
        raise InputError(
            f"{what}: one {kind} for all runs, which no distribution draws",
            where=node.where,
            got=node.plain(),
            allowed=f"{_references(kind)}, or a mapping, in which single fields may be drawn",
            cure=_SEVERAL.get(kind, ""),
        )
    if "extends" in node.value or (kind in MODELS and "scale" in node.value):
        return resolve(kind, node, folder, prefix=(what,)), True
    node = with_camera(node, folder) if kind == "look" else node
    return _anchored(kind, node, folder), False


def with_camera(look: Node, folder: Path) -> Node:
    """Return a look whose camera, if it is a name or has `extends:`, is replaced by all settings of that camera."""
    camera = look.child("camera")
    if camera is None or not isinstance(look.value, dict):
        return look
    return Node({**look.value, "camera": resolve_camera(camera, folder)}, look.where)


def resolve_camera(node: Node, folder: Path) -> Node:
    """Return all settings of the camera that a node names or extends; any other node as it is."""
    if isinstance(node.value, str):
        what = "look.camera"
        camera = read_file("camera", locate("camera", node.value, folder=folder, what=what, where=node.where))
    elif isinstance(node.value, dict) and "extends" in node.value:
        camera = resolve("camera", node, folder, prefix=("look", "camera"))
    else:
        return node
    # With its defaults, nothing remains of a camera that it is merged over, nor of a field that is absent by default.
    complete = with_defaults(camera, Shape.from_model(CameraLook))
    absent = {name: Node(None, camera.where) for name in CameraLook.model_fields}
    return merge(Node(absent, camera.where), complete)
