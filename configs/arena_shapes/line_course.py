"""A line through points, which becomes straights and arcs before anything is drawn."""

from configs.arena_shapes.curves import UnfitError, rounded, spline
from configs.arena_shapes.short_forms import checked_alone
from configs.schema.arena import LineCourse
from configs.schema.base import Section
from symolo.core.errors import InputError
from symolo.core.yaml.tree import FieldPath, Node, node_of

_PATH: FieldPath = ("arena", "line", "course")


class _Line(Section):
    course: LineCourse


class _Arena(Section):
    line: _Line


class _Alone(Section):
    """A tree with the points of the line alone, so that messages have their paths."""

    arena: _Arena


def with_course(root: Node) -> Node:
    """Return the tree with the pieces of the line in place of its points.

    Args:
        root: Tree of a scenario, or of a section, with all defaults.

    Raises:
        InputError: The course is wrong, stands beside pieces, or no line can be laid along it.
    """
    arena, line, written = (root.at(_PATH[:length]) for length in (1, 2, 3))
    if arena is None or line is None or written is None or not isinstance(line.value, dict):
        return root
    fields = {key: node for key, node in line.value.items() if key != "course"}
    if written.value is not None:
        pieces = fields.get("pieces")
        if pieces is not None and pieces.value:
            cure = "remove one of them"
            raise InputError("arena.line: both course and pieces", where=written.where, cure=cure)
        cure = "write numbers; to vary the line from run to run, use arena.generate"
        course = checked_alone(root, _PATH, _Alone, cure).arena.line.course
        fields["pieces"] = node_of(_pieces(course, written.where), written.where)
    new_line = Node(fields, line.where)
    new_arena = Node({**dict(_fields(arena)), "line": new_line}, arena.where)
    return Node({**dict(_fields(root)), "arena": new_arena}, root.where)


def _fields(node: Node) -> dict[str, Node]:
    return {str(key): child for key, child in node.children()}


def _pieces(course: LineCourse, where: str) -> list[dict[str, object]]:
    try:
        if course.shape == "spline":
            return spline(course.points, closed=course.closed)
        return rounded(course.points, course.bend_radius_m, closed=course.closed)
    except UnfitError as error:
        raise InputError(f"arena.line.course: {error}", where=where, cure=error.cure) from None
