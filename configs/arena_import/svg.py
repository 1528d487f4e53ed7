"""An arena from an SVG drawing, whose groups, layers or elements are named after what they are.

Names are those of the attributes id, class and inkscape:label of an element or of a group around it.
"""

import io
import math
import re
from collections.abc import Iterator
from contextlib import suppress
from itertools import pairwise
from typing import Any

import numpy as np

from configs.arena_import.drawing import MAX_WALLS, Drawing, Point
from configs.arena_shapes.curves import UnfitError, along
from symolo.core.arrays import Array
from symolo.core.errors import InputError

MAX_BYTES = 8 << 20
MAX_ELEMENTS = 5000
MAX_PIECES = 5000
"""Largest number of pieces of the line."""
MAX_CURVES = 1000
"""Largest number of curves; fitting arcs to so many takes about a second."""
MAX_CURVE_M = 50.0
"""Length of a curve up to which arcs are fitted to it."""
CHORD_M = 0.02
"""Length of the straight pieces that stand for a curve to which no arcs are fitted."""
MAX_CHORDS = 200
"""Largest number of straight pieces of one curve."""
ROLES = ("line", "room", "pillar", "wall", "obstacle", "ramp")
_LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
_CONTROLS = {
    "CubicBezier": ("start", "control1", "control2", "end"),
    "QuadraticBezier": ("start", "control", "end"),
}
"""Control points of a curve, by the class of svgelements."""
MAX_DIGITS = 300
"""The reader of SVG takes a time that grows with the square of the digits of a number."""
_LONG_NUMBER = re.compile(rb"[0-9]{%d}" % (MAX_DIGITS + 1))
_ROUND = 1e-3
"""Relative difference of the half axes up to which an arc is a part of a circle."""


def drawing_from_svg(data: bytes, where: str, width_m: float | None) -> Drawing:
    """Return the arena of an SVG file.

    Args:
        data: Its bytes.
        where: The file, for messages.
        width_m: Width of the whole drawing; None for the one that the file states.

    Raises:
        InputError: It is no SVG, has no size, names nothing, or draws a ramp.
    """
    if len(data) > MAX_BYTES or b"<!ENTITY" in data:
        raise InputError("an SVG file", where=where, allowed=f"at most {MAX_BYTES >> 20} MiB, without entities")
    if _LONG_NUMBER.search(data):
        raise InputError("a number", where=where, allowed=f"at most {MAX_DIGITS} digits in a row")
    from svgelements import SVG  # noqa: PLC0415 - only for an SVG file

    try:
        # With 25.4 pixels per inch, a pixel of a drawing that has a physical size is a millimetre.
        svg = SVG.parse(io.BytesIO(data), ppi=25.4)
    except Exception as error:  # noqa: BLE001 - the reader raises whatever a damaged file leads to
        raise InputError(f"cannot be read: {type(error).__name__}: {error}"[:200], where=where) from None
    if not isinstance(svg, SVG):
        raise InputError("the first tag", where=where, allowed="svg")
    reader = _Reader(where, _scale(svg, data, where, width_m))
    for count, (element, names) in enumerate(_elements(svg, ())):
        if count > MAX_ELEMENTS:
            raise InputError("elements", where=where, got=f"more than {MAX_ELEMENTS}", allowed=str(MAX_ELEMENTS))
        reader.take(element, names)
    if reader.drawing.is_empty():
        names = ", ".join(ROLES[:-1])
        cure = f"name a group, a layer or an element after what it is: {names}"
        raise InputError("nothing of the drawing is an arena", where=where, cure=cure)
    if (walls := reader.drawing.wall_count()) > MAX_WALLS:
        raise InputError("walls", where=where, got=walls, allowed=f"at most {MAX_WALLS}")
    return reader.drawing


def _scale(svg: Any, data: bytes, where: str, width_m: float | None) -> float:  # noqa: ANN401 - of svgelements
    """Return the metres of one pixel."""
    width = float(svg.width or 0.0)
    if not math.isfinite(width) or width <= 0.0:
        raise InputError("the width of the drawing", where=where, got=width, allowed="a number above 0")
    if width_m is not None:
        return width_m / width
    head = data[:20_000].decode("latin-1")
    stated = head.partition("<svg")[2].partition(">")[0]
    physical = [unit for unit in ("mm", "cm", "in") if f'{unit}"' in stated.partition("width=")[2][:40]]
    if not physical:
        cure = "give --width-m, or set the width in millimetres in the drawing program"
        raise InputError("the drawing has no physical size", where=where, cure=cure)
    return 0.001


def _elements(group: Any, names: tuple[str, ...]) -> Iterator[tuple[Any, tuple[str, ...]]]:  # noqa: ANN401 - as above
    """Yield every drawn element with its names and those of the groups around it, the nearest first."""
    from svgelements import Group, Shape  # noqa: PLC0415 - as above

    for element in group:
        values = getattr(element, "values", None) or {}
        attributes = values.get("attributes", values)
        labels = [str(attributes.get(key, "")) for key in (_LABEL, "class", "id")]
        inner = (*(name.lower() for name in labels if name), *names)
        if isinstance(element, Group):
            yield from _elements(element, inner)
        elif isinstance(element, Shape):
            yield element, inner


class _Reader:
    def __init__(self, where: str, scale: float) -> None:
        self._where, self._scale = where, scale
        self._curves = 0
        self.drawing = Drawing()

    def take(self, element: Any, names: tuple[str, ...]) -> None:  # noqa: ANN401 - of svgelements
        role = next((role for name in names for role in ROLES if role in name), "")
        own_name = names[0] if names else type(element).__name__.lower()
        match role:
            case "":
                self.drawing.ignored.append(own_name)
            case "ramp":
                cure = "remove it; the floor is a plane, and ramps cannot be simulated"
                raise InputError(f"{own_name}: a ramp", where=self._where, cure=cure)
            case "line":
                self._take_line(element)
            case "obstacle":
                self._take_obstacle(element, own_name)
            case _:
                self._take_walls(element, role)

    def _take_line(self, element: Any) -> None:  # noqa: ANN401 - as above
        from svgelements import Arc, Close, Line, Move, Path  # noqa: PLC0415 - as above

        width_m = self._scale * float(element.stroke_width or 0.0) * _size_of(element.transform)
        if 0.004 <= width_m <= 0.1:
            self.drawing.line_width_m = round(width_m, 4)
        for segment in Path(element).reify().segments():
            match segment:
                case Move():
                    continue
                case Arc() if abs(segment.rx - segment.ry) < _ROUND * abs(segment.rx):
                    self._add_arc(segment)
                case Line() | Close():
                    self._add_straight(self._point(segment.start), self._point(segment.end))
                case _:
                    self._add_curve(segment)
            if len(self.drawing.line) > MAX_PIECES:
                raise InputError("pieces of the line", where=self._where, allowed=f"at most {MAX_PIECES}")

    def _add_straight(self, start: Point, end: Point) -> None:
        if math.dist(start, end) > 1e-3:
            self.drawing.line.append({"kind": "straight", "start": [*start], "end": [*end]})

    def _add_curve(self, curve: Any) -> None:  # noqa: ANN401 - as above
        from scipy.interpolate import BPoly  # noqa: PLC0415 - only for a curve

        self._count_curve()
        controls = [getattr(curve, name, None) for name in _CONTROLS.get(type(curve).__name__, ())]
        if controls and self._length_m(curve) < MAX_CURVE_M:
            bezier = BPoly(np.array([self._point(control) for control in controls])[:, None], [0.0, 1.0])
            with suppress(UnfitError):
                self.drawing.line += along(bezier, (0.0, 1.0))
                return
        before = len(self.drawing.line)
        for start, end in pairwise(self._flattened(curve)):
            self._add_straight(start, end)
        for piece in self.drawing.line[before + 1 :]:
            piece["joined"] = True

    def _add_arc(self, arc: Any) -> None:  # noqa: ANN401 - as above
        center = self._point(arc.center)
        start = self._point(arc.start)
        start_deg = math.degrees(math.atan2(start[1] - center[1], start[0] - center[0]))
        # y grows downwards in the drawing, so that a turn has the other sign here.
        sweep_deg = -math.degrees(float(arc.sweep))
        radius_m = math.dist(start, center)
        angles = {"start_deg": round(start_deg, 4), "end_deg": round(start_deg + sweep_deg, 4)}
        self.drawing.line.append({"kind": "arc", "center": [*center], "radius_m": round(radius_m, 5), **angles})

    def _take_walls(self, element: Any, role: str) -> None:  # noqa: ANN401 - as above
        from svgelements import Close, Line, Move, Path  # noqa: PLC0415 - as above

        for part in Path(element).reify().as_subpaths():
            points: list[Point] = []
            is_closed = False
            for segment in Path(part).segments():
                if isinstance(segment, Move) or segment.end is None:
                    continue
                is_closed |= isinstance(segment, Close)
                if isinstance(segment, Line | Close):
                    more = [self._point(segment.start), self._point(segment.end)]
                else:
                    self._count_curve()
                    more = self._flattened(segment)
                points += [point for point in more if not points or math.dist(point, points[-1]) > 1e-3]
            if len(points) > 2 and math.dist(points[0], points[-1]) < 1e-3:
                is_closed, points = True, points[:-1]
            if len(points) < 2:
                continue
            outlines = {"room": self.drawing.rooms, "pillar": self.drawing.pillars}.get(role, self.drawing.walls)
            if role == "wall" and is_closed:
                outlines = self.drawing.rooms
            outlines.append(tuple(points))

    def _take_obstacle(self, element: Any, name: str) -> None:  # noqa: ANN401 - as above
        from svgelements import Path  # noqa: PLC0415 - as above

        corners = [self._point(s.end) for s in Path(element).reify().segments() if s.end is not None][:4]
        is_box = len(corners) == 4 and math.dist(corners[0], corners[2]) > 0.0
        if not is_box or abs(math.dist(corners[0], corners[2]) - math.dist(corners[1], corners[3])) > 1e-3:
            self.drawing.ignored.append(f"{name}, which is no rectangle")
            return
        (ax, ay), (bx, by), (cx, cy), _ = corners
        length, width = math.dist(corners[0], corners[1]), math.dist(corners[1], corners[2])
        yaw_deg = round(math.degrees(math.atan2(by - ay, bx - ax)), 3)
        middle = (0.5 * (ax + cx), 0.5 * (ay + cy))
        label = f"obstacle_{len(self.drawing.obstacles) + 1}"
        self.drawing.obstacles.append((label, middle, (round(length, 4), round(width, 4)), yaw_deg))

    def _count_curve(self) -> None:
        self._curves += 1
        if self._curves > MAX_CURVES:
            raise InputError("curves", where=self._where, allowed=f"at most {MAX_CURVES}")

    def _flattened(self, segment: Any) -> list[Point]:  # noqa: ANN401 - as above
        count = min(MAX_CHORDS, max(1, math.ceil(self._length_m(segment) / CHORD_M)))
        return [(float(x), float(y)) for x, y in self._points(segment, count)]

    def _length_m(self, segment: Any) -> float:  # noqa: ANN401 - as above
        return float(np.hypot(*np.diff(self._points(segment, MAX_CHORDS // 4), axis=0).T).sum())

    def _points(self, segment: Any, count: int) -> Array:  # noqa: ANN401 - as above
        """Return the ends (count + 1, 2) [m] of chords at equal parameters of a curve."""
        points = self._scale * np.asarray(segment.npoint(np.arange(count + 1) / count)) * (1.0, -1.0)
        if not np.isfinite(points).all():
            raise InputError("a point is no number", where=self._where)
        return points

    def _point(self, point: Any) -> Point:  # noqa: ANN401 - as above
        x, y = self._scale * float(point.x), -self._scale * float(point.y)
        if not (math.isfinite(x) and math.isfinite(y)):
            raise InputError("a point is no number", where=self._where)
        return x, y


def _size_of(transform: Any) -> float:  # noqa: ANN401 - as above
    return math.sqrt(abs(transform.a * transform.d - transform.b * transform.c))
