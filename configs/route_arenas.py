"""Arenas of single routes: `routes: [{name: A, start: ..., arena: hall}]`.

Such a route has an arena of its own in place of that of the scenario. What is done with `arena` of a scenario is done
with the arena of each route as well, as if it stood at the top.
"""

from collections.abc import Callable, Sequence

from symolo.core.errors import FaultList, InputError, apart
from symolo.core.yaml.tree import FieldPath, Node, dotted

ROUTES, ARENA = "routes", "arena"


def arena_path(root: Node, index: int) -> FieldPath:
    """Return the path of the arena of a route in the tree of a scenario: its own, or that of the scenario."""
    path: FieldPath = (ROUTES, index, ARENA)
    return (ARENA,) if root.plain_at(path) is None else path


def check_arena_is_used(root: Node, file: str, overrides: Sequence[str]) -> None:
    """Refuse settings of the arena of a scenario if each of its routes has an arena of its own.

    Args:
        root: Tree of the scenario.
        file: The file of the scenario. What it inherits from other files is for their routes, and not refused.
        overrides: Texts of the command line, such as `arena.line.width_m=0.02`.

    Raises:
        InputError: There is such a setting, which no run would have.
    """
    routes, arena = root.child(ROUTES), root.child(ARENA)
    items = [route for _, route in routes.children()] if routes is not None else []
    if arena is None or not items or any(route.plain_at((ARENA,)) is None for route in items):
        return
    written = (text.partition("=")[0].strip() for text in overrides)
    unused = [(f"--set {field}", field) for field in written if field.split(".")[0] == ARENA]
    leaves = ((path, node) for path, node in arena.walk((ARENA,)) if not any(node.children()))
    unused += [(node.where, dotted(path)) for path, node in leaves if node.where.startswith(f"{file}:")]
    if unused:
        where, field = unused[0]
        names = [str(route.plain_at(("name",))) for route in items]
        each = f"{', '.join(names)} has" if len(names) > 1 else f"the route {names[0]} has"
        raise InputError(
            f"{field}: no route uses it, because {'each of ' if len(names) > 1 else ''}{each} an arena of its own",
            where=where,
            cure=f"set {ROUTES}.{names[0]}.{field} in its place, or leave it out (the file may name an arena alone,"
            f" such as {ARENA}: symolo)",
        )


def with_each_arena(root: Node, change: Callable[[Node], Node]) -> Node:
    """Return a tree whose arenas are changed, that at the top and those of routes.

    Args:
        root: Tree of a scenario, or of a section, which has no routes.
        change: Changes what is below `arena` of a tree.
    """
    return with_route_arenas(change(root), lambda arena, _: change(Node({ARENA: arena}, arena.where)).child(ARENA))


def with_route_arenas(root: Node, change: Callable[[Node, str], Node | None]) -> Node:
    """Return a tree in which the arenas of routes are changed; `change` gets an arena and its path as text.

    Raises:
        InputError: An arena cannot be changed; the faults of all are reported.
    """
    routes = root.child(ROUTES)
    if routes is None or not isinstance(routes.value, tuple) or not isinstance(root.value, dict):
        return root
    items, faults = list(routes.value), FaultList()
    for index, route in enumerate(items):
        arena = route.child(ARENA)
        if arena is not None and arena.value is not None and isinstance(route.value, dict):
            path = f"{ROUTES}.{index}.{ARENA}"
            try:
                items[index] = Node({**route.value, ARENA: change(arena, path) or arena}, route.where)
            except InputError as error:
                faults.faults += [fault.below(ARENA, path) for fault in apart(error)]
    faults.check()
    return Node({**root.value, ROUTES: Node(tuple(items), routes.where)}, root.where)


def single_route_root(root: Node, route: Node) -> Node:
    """Return the tree of a scenario with one route alone, and with the arena of this route."""
    fields = {str(key): node for key, node in root.children()}
    arena = route.child(ARENA)
    if arena is not None and arena.value is not None:
        fields[ARENA] = arena
        route = Node({str(key): node for key, node in route.children() if key != ARENA}, route.where)
    return Node({**fields, ROUTES: Node((route,), route.where)}, root.where)
