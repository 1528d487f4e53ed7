"""Values from the command line: `--set look.sun.elevation_deg=30`."""

import re
from collections.abc import Sequence
from pathlib import Path

from configs.assets.folder import anchored
from configs.posterior.reading import KEY as LIKE
from configs.posterior.reading import anchored_posterior
from configs.references import SECTIONS, resolve_camera, resolve_section, with_resolved_routes
from configs.route_arenas import ARENA, ROUTES
from configs.user_files import KEYS, anchored_files
from symolo.core.errors import InputError, nearest
from symolo.core.yaml.reader import MAX_DEPTH, parse_yaml
from symolo.core.yaml.tree import ALTERNATIVES, FieldPath, Node, dotted, merge

CAMERA = "look.camera"
_ROUTE_ARENA = re.compile(rf"{ROUTES}\.[^.]+\.{ARENA}")


def apply_override(root: Node, text: str) -> Node:
    """Return the tree with one `field.path=value` merged over it: YAML, with list items by index or name.

    Raises:
        InputError: The text has another form, or the path leads through a value without fields.
    """
    name, equals, value = text.partition("=")
    name = name.strip()
    where = f"--{LIKE}" if name == LIKE else f"--set {name}"
    keys = name.split(".")
    if not equals or not all(keys) or len(keys) > MAX_DEPTH:
        raise InputError("--set", got=text, allowed="field.path=value, such as look.sun.elevation_deg=30")
    if keys[-1] == "extends":
        cure = "set the fields, or the section's name"
        raise InputError("'extends' is read from files alone", where=where, cure=cure)
    node = parse_yaml(value, where, with_lines=False)
    if name in SECTIONS and isinstance(root.value, dict):
        node, is_complete = resolve_section(name, node, Path.cwd())
        if is_complete:
            return Node({**root.value, name: node}, root.where)
    if name == CAMERA:
        node = resolve_camera(node, Path.cwd())
    if name == "look.assets":
        node = anchored(Node({"assets": node}, where), Path.cwd()).child("assets") or node
    if name == LIKE:
        node = anchored_posterior(Node({LIKE: node}, where), Path.cwd()).child(LIKE) or node
    if keys[0] == "robot" and keys[1:] in [[key] for key in KEYS]:
        node = anchored_files(Node({keys[1]: node}, where), Path.cwd()).child(keys[1]) or node
    return _set_in_routes(root, keys, node, where) if keys[0] == ROUTES else _set(root, keys, (), node, where)


def _set_in_routes(root: Node, keys: list[str], value: Node, where: str) -> Node:
    """Return the tree with a value in its routes, whose arenas may be names; paths start at the current folder."""
    if keys[2:3] == [ARENA] and len(keys) > 3:
        _check_own_arena(root, keys, where)
    return with_resolved_routes(_set(root, keys, (), value, where), Path.cwd())


def _check_own_arena(root: Node, keys: list[str], where: str) -> None:
    """Refuse to set a field in the arena of a route that has none of its own."""
    routes = root.child(ROUTES)
    items = routes.value if routes is not None and isinstance(routes.value, tuple) else ()
    if items and items[_index(items, keys[1], (ROUTES,), where)].plain_at((ARENA,)) is None:
        arena = ".".join(keys[:3])
        field = ".".join([ARENA, *keys[3:]])
        cure = f"name one first, such as --set {arena}=hall, or set {field} for the arena of the scenario"
        raise InputError(f"{arena}: the route has no arena of its own", where=where, cure=cure)


def names_camera(text: str) -> bool:
    """Return whether an override replaces the camera of the look by a named one."""
    return text.partition("=")[0].strip() == CAMERA and _is_named(text)


def replaced_section(text: str) -> str:
    """Return the section that an override replaces by a name or `extends`; empty if it sets fields."""
    name = text.partition("=")[0].strip()
    return name if (name in SECTIONS or _ROUTE_ARENA.fullmatch(name)) and _is_named(text) else ""


def _is_named(text: str) -> bool:
    """Return whether the value of an override is a name, or has `extends`."""
    name, _, value = text.partition("=")
    content = parse_yaml(value, f"--set {name.strip()}", with_lines=False).value
    return isinstance(content, str) or (isinstance(content, dict) and "extends" in content)


def with_route_index(root: Node, text: str) -> str:
    """Return an override with the index of a route in place of its name; any other override as it is."""
    name, equals, value = text.partition("=")
    keys = name.strip().split(".")
    routes = root.child(ROUTES)
    if keys[0] != ROUTES or len(keys) < 2 or routes is None or not isinstance(routes.value, tuple):
        return text
    keys[1] = str(_index(routes.value, keys[1], (ROUTES,), f"--set {name.strip()}"))
    return ".".join(keys) + equals + value


def check_order(overrides: Sequence[str], indexed: Sequence[str]) -> None:
    """Refuse texts one of which replaces a whole section, camera or list in which an earlier one has set something.

    Args:
        overrides: Texts as the user wrote them.
        indexed: The same with an index for each route, so that texts about one route begin alike.

    Raises:
        InputError: The earlier one would have no effect.
    """
    for number, text in enumerate(indexed):
        replaced = CAMERA if names_camera(text) else replaced_section(text)
        lost = [i for i, each in enumerate(indexed[:number]) if replaced and _sets(each, replaced)]
        if list_name := _replaced_list(text):
            lost += [i for i, each in enumerate(indexed[:number]) if each.startswith(f"{list_name}.")]
        if lost:
            name, _, value = overrides[number].partition("=")
            raise InputError(
                f"discards the earlier --set {overrides[lost[0]].partition('=')[0].strip()}",
                where=f"--set {name.strip()}={value.strip()}",
                cure=f"put the option with the {'list' if list_name else 'name'} first",
            )


def _replaced_list(text: str) -> str:
    """Return the field that an override replaces by a list; empty if its value is no list."""
    name, _, value = text.partition("=")
    node = parse_yaml(value, f"--set {name.strip()}", with_lines=False)
    return name.strip() if isinstance(node.value, tuple) else ""


def _sets(text: str, section: str) -> bool:
    """Return whether an override sets something in a section, other than by a name that it replaces as well."""
    name, _, value = text.partition("=")
    name = name.strip()
    if name.startswith(f"{section}."):
        return True
    if name == section:
        return not _is_named(text)
    if not section.startswith(f"{name}."):
        return False
    content = parse_yaml(value, f"--set {name}", with_lines=False).value
    return isinstance(content, dict) and section.removeprefix(f"{name}.") in content


def _set(node: Node, rest: list[str], path: FieldPath, value: Node, where: str) -> Node:
    if not rest:
        return merge(node, value)
    if node.value is None:  # a section that is absent by default
        node = Node({}, where)
    if isinstance(node.value, dict):
        fresh = Node({} if len(rest) > 1 else None, where)
        inner = _set(node.value.get(rest[0], fresh), rest[1:], (*path, rest[0]), value, where)
        others = {key: child for key, child in node.value.items() if ALTERNATIVES.get(key) != rest[0]}
        return Node({**others, rest[0]: inner}, node.where)
    if isinstance(node.value, tuple):
        index = _index(node.value, rest[0], path, where)
        items = list(node.value)
        items[index] = _set(items[index], rest[1:], (*path, index), value, where)
        return Node(tuple(items), node.where)
    raise InputError(f"{dotted(path)} is a single value and has no field '{rest[0]}'", where=where, got=node.plain())


def _index(items: tuple[Node, ...], key: str, path: FieldPath, where: str) -> int:
    names = [name.value if (name := item.child("name")) else None for item in items]
    indices = [str(index) for index in range(len(items))]
    if key in indices:
        return indices.index(key)
    if key in names:
        return names.index(key)
    known = [name for name in names if isinstance(name, str)]
    allowed = f"an index from 0 to {len(items) - 1}" if items else "nothing, the list is empty"
    allowed += f", or a name of {', '.join(known[:12])}" if known else ""
    raise InputError(f"{dotted(path)}: item", where=where, got=key, allowed=allowed, nearest=nearest(key, known))
