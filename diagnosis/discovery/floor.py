"""Forms over the place of the robot on the floor: beyond an edge, or within a disc."""

from collections.abc import Iterator
from itertools import product

import numpy as np

from diagnosis.discovery.form import LawForm, LawNumber, rounded, sized
from diagnosis.discovery.place import LawPlace, SlotCovariate

PARTS = 7
"""Places along each coordinate at which a disc is tried, and an edge at twice as many."""
RADII = (0.12, 0.2, 0.32)
"""Radii of a disc, as shares of the smaller range of a coordinate."""
EDGE = 0.03
"""Width of the edge of a disc, as a share of the smaller range of a coordinate. A fit needs an edge that is no jump,
and a robot has two wheels, which do not come to the edge at once."""


def floor_forms(place: LawPlace, x: SlotCovariate, y: SlotCovariate) -> Iterator[LawForm]:
    """Yield the forms over a place."""
    span = min(x.high - x.low, y.high - y.low)
    width_m = rounded(EDGE * span)
    constants = (f"EDGE_M = {width_m}", '"""Width of the edge."""')
    for c in (x, y):
        yield _half(place, c, constants)
    inside = sized(place, "inside", "Change inside")
    middle = (f"Middle of the disc, {c.words}" for c in (x, y))
    numbers = [
        LawNumber(f"middle_{c.word}_m", "m", meaning, _between(c, PARTS)[PARTS // 2], c.low - span, c.high + span)
        for c, meaning in zip((x, y), middle, strict=True)
    ]
    radii = [share * span for share in RADII]
    radius = LawNumber("radius_m", "m", "Radius of the disc", radii[1], 0.5 * width_m, 2.0 * span)
    off = f"np.hypot({{{x.name}}} - self.middle_x_m, {{{y.name}}} - self.middle_y_m)"
    yield LawForm(
        place,
        "disc",
        (x.name, y.name),
        f"a change of {place.noun} in a disc of the floor",
        f"self.{inside.name} * np.clip(0.5 + (self.radius_m - off_m) / EDGE_M, 0.0, 1.0)",
        (inside, *numbers, radius),
        tuple((place.size, *at) for at in product(_between(x, PARTS), _between(y, PARTS), radii)),
        shorthand=f"off_m = {off}",
        constants=constants,
    )


def _half(place: LawPlace, c: SlotCovariate, constants: tuple[str, ...]) -> LawForm:
    """Return a change beyond an edge, of a floor of two parts."""
    beyond, span, edges = sized(place, "beyond", "Change beyond the edge"), c.high - c.low, _between(c, 2 * PARTS)
    edge = LawNumber("edge_m", "m", f"Where it begins, {c.words}", edges[PARTS], c.low - span, c.high + span)
    return LawForm(
        place,
        "step",
        (c.name,),
        f"a step of {place.noun} at one value of the {c.words}",
        f"self.{beyond.name} * np.clip(0.5 + ({{{c.name}}} - self.edge_m) / EDGE_M, 0.0, 1.0)",
        (beyond, edge),
        tuple((place.size, at) for at in edges),
        constants=constants,
    )


def _between(c: SlotCovariate, parts: int) -> list[float]:
    """Return the middles of equal parts of the range of a coordinate."""
    return [float(c.low + (c.high - c.low) * (k + 0.5) / parts) for k in np.arange(parts)]
