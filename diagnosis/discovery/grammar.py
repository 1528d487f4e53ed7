"""The grammar: forms of one covariate, their products with a second one, limits of a reading, and smooth curves.

Each form has at most three numbers. Their names end in their units, and the numbers of shape are tried over the range
of the covariate in the data. Forms that a shipped effect has are left out, since the diagnosis has tried those.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from configs.effects.base import Slot
from diagnosis.discovery.floor import floor_forms
from diagnosis.discovery.form import MANY, LawForm, LawNumber, sized, unit_per, with_unit
from diagnosis.discovery.past import past_forms
from diagnosis.discovery.place import LawPlace, SlotCovariate
from symolo.core.arrays import Array

EDGES = 24
"""Values of a covariate at which a form may begin, at quantiles of the rows."""
WIDTHS = (0.03, 0.06, 0.12, 0.25)
"""Widths of a bump, as shares of the range of the covariate."""
EXPONENTS = (0.5, 2.0, 3.0)
HALVES = (0.05, 0.2, 0.6)
"""Values of a covariate at which a saturation is half of its end, as shares of its range."""
JUMP_OR_DRIFT = frozenset({"step", "rise"})
"""Shapes with an edge that a factor, or anything over the time of a drive, may have."""
CYCLES = (1.0, 40.0)
"""Smallest and largest number of waves within the range of a covariate."""
TRIED_CYCLES = 96
"""Numbers of waves between them that are tried."""
QUICK, QUICK_CYCLES = frozenset({Slot.CURRENT_ERROR, Slot.SPEED_ERROR}), 300.0
"""Slots in which a hum is looked for, and its largest number of waves: no motion changes, so that many are tried."""
PHASES = (0.0, np.pi / 3.0, 2.0 * np.pi / 3.0)
WAVES = (("wave", "once", 1.0), ("double_wave", "twice", 2.0), ("triple_wave", "three times", 3.0))
"""Shapes of waves over an angle, how often they repeat in a turn in words, and as a number."""
COARSE = (0.003, 0.1)
"""Smallest and largest coarse step of a range [m] that is tried."""
COARSE_STEPS = 300
"""Sizes of a coarse step between them that are tried."""
MAX_NUMBER = 9e4
"""Largest bound of a number; an effect file has none beyond 1e5."""
MIN_DISTINCT = 5
"""Smallest number of different values of a covariate along which a law is looked for."""
MIN_WAVES = 12
"""Smallest number of different values along which waves are tried."""
FROM_ZERO = 0.3
"""Smallest value of a covariate relative to the largest, from which the data cannot show that a power is no straight
line."""
KNOTS, MIN_KNOTS = 5, 3
"""Knots of a smooth curve, and the smallest number of them."""
CURVE = "curve"
"""Shape of a smooth curve, which is no law."""


def forms(place: LawPlace, materials: Sequence[str]) -> Iterator[LawForm]:
    """Yield the forms of a place.

    Args:
        place: The slot.
        materials: Names of the materials of a range bench, each of which may have an error of its own.
    """
    law_covariates = [each for each in place.covariates.values() if can_have_law(each)]
    x, y = place.covariates.get("x_m"), place.covariates.get("y_m")
    if x is not None and y is not None:
        yield from floor_forms(place, x, y)
    yield from past_forms(place)
    if place.may_be_constant:
        yield _offset(place)
    for covariate in place.covariates.values():
        if covariate.is_angle:
            yield from _turning(place, covariate)
    for covariate in law_covariates:
        is_slow = place.is_factor or covariate.is_of_path
        yield from _jumps_and_drifts(place, covariate) if is_slow else _along(place, covariate)
    if place.slot is Slot.RANGE:
        yield from _range_forms(place, law_covariates, materials)
    if place.is_odd:
        for covariate in place.covariates.values():
            yield from _end_forms(place, covariate)


def can_have_law(c: SlotCovariate) -> bool:
    """Return whether a covariate has enough different values, none of them negative, for a law along it."""
    return not (c.is_past or c.is_angle or c.is_place) and c.low >= 0.0 and len(np.unique(c.values)) >= MIN_DISTINCT


def smooth(place: LawPlace, c: SlotCovariate) -> LawForm | None:
    """Return a smooth curve over a covariate: values at knots, a cubic spline between them, constant outside."""
    knots = np.unique(np.quantile(c.values, np.linspace(0.0, 1.0, KNOTS)))
    if len(knots) < MIN_KNOTS:
        return None
    numbers = tuple(
        sized(place, f"at_{k}", f"Change at {c.words} = {knot:.4g}") for k, knot in enumerate(knots.tolist(), 1)
    )
    listed = ", ".join(f"{knot:.6g}" for knot in knots.tolist())
    values = ", ".join(f"self.{number.name}" for number in numbers)
    return LawForm(
        place,
        CURVE,
        (c.name,),
        f"a smooth change of {place.noun} over the {c.words}",
        f"sum(value * curve for value, curve in zip(values, curves({{{c.name}}}), strict=True))",
        numbers,
        (tuple(0.0 for _ in numbers),),
        shorthand=f"values = ({values})",
        constants=(
            f"KNOTS = np.array([{listed}])",
            f'"""Where the numbers are the change, {c.words}."""',
            'SPLINE = CubicSpline(KNOTS, np.eye(len(KNOTS)), bc_type="natural")',
            "",
            "",
            "def curves(x: float | Array) -> Array:",
            '    """Return the change by one unit of each number (knots, ...), outside the knots as at the nearest."""',
            "    return np.moveaxis(SPLINE(np.clip(x, KNOTS[0], KNOTS[-1])), -1, 0)",
        ),
    )


def _at(c: SlotCovariate, word: str, meaning: str, start: float) -> LawNumber:
    """Return a place along a covariate, with bounds a range beyond the data on each side."""
    span = c.high - c.low
    high = min(c.high + span, MAX_NUMBER)
    return LawNumber(with_unit(word, c.unit), c.unit, f"{meaning}, {c.words}", start, max(0.0, c.low - span), high)


def _along(place: LawPlace, c: SlotCovariate) -> Iterator[LawForm]:
    """Yield the forms along one covariate."""
    yield from _edged(place, c)
    yield from _powers(place, c, None)
    if len(np.unique(c.values)) >= MIN_WAVES:
        yield _wave(place, c)


def _offset(place: LawPlace) -> LawForm:
    """Return a change that depends on nothing."""
    number = sized(place, "offset", "Change")
    words = f"a constant error of {place.noun}"
    return LawForm(place, "offset", (), words, f"self.{number.name}", (number,), ((number.start,),))


def _jumps_and_drifts(place: LawPlace, c: SlotCovariate) -> Iterator[LawForm]:
    """Yield the forms of what jumps, drifts or settles."""
    yield from (form for form in _edged(place, c) if form.shape in JUMP_OR_DRIFT)
    yield from _powers(place, c, None)


def _range_forms(
    place: LawPlace, law_covariates: Sequence[SlotCovariate], materials: Sequence[str]
) -> Iterator[LawForm]:
    """Yield the forms that only a range has."""
    distance, incidence = (place.covariates.get(name) for name in ("distance_m", "incidence_rad"))
    for covariate in law_covariates:
        if distance is not None and covariate is not distance:
            yield from _powers(place, covariate, distance)
    if incidence is not None:
        for material in ("", *(materials if len(materials) > 1 else ())):
            yield _oblique(place, incidence, material)
    if distance is not None and not place.member:
        yield from _reading_forms(place, distance)


def _edged(place: LawPlace, c: SlotCovariate) -> Iterator[LawForm]:
    """Yield steps, straight lines that begin somewhere, and bumps."""
    x, edges, span, noun = "{" + c.name + "}", _edges(c.values), c.high - c.low, place.noun
    step = sized(place, "step", "Change beyond the edge")
    edge = _at(c, "edge", "Where it begins", edges[len(edges) // 2])
    yield LawForm(
        place,
        "step",
        (c.name,),
        f"a step of {noun} at one value of the {c.words}",
        f"np.where({x} > self.{edge.name}, self.{step.name}, 0.0)",
        (step, edge),
        tuple((place.size, at) for at in edges),
        jump=1,
    )
    unit = unit_per(place.unit, c.unit)
    slope = LawNumber.amplitude(with_unit("slope", unit), unit, 4.0 * place.size / span, "Slope beyond the edge")
    for shape, relation, argument in (
        ("rise", "above", f"{x} - self.{edge.name}"),
        ("fall", "below", f"self.{edge.name} - {x}"),
    ):
        yield LawForm(
            place,
            shape,
            (c.name,),
            f"a straight line of {noun} {relation} one value of the {c.words}",
            f"self.{slope.name} * np.maximum({argument}, 0.0)",
            (slope, edge),
            tuple((slope.start, at) for at in edges),
        )
    peak = sized(place, "peak", "Change at the middle")
    middle = _at(c, "middle", "Where it is largest", edges[len(edges) // 2])
    widths = [share * span for share in WIDTHS]
    meaning = "Distance from the middle at which 41 % are left"
    width = LawNumber(with_unit("width", c.unit), c.unit, meaning, widths[1], 0.005 * span, 2.0 * span)
    yield LawForm(
        place,
        "bump",
        (c.name,),
        f"a bump of {noun} about one value of the {c.words}",
        f"self.{peak.name} / (1.0 + off**2 / 4.0) ** 4",
        (peak, middle, width),
        tuple((place.size, at, wide) for at, wide in product(edges, widths)),
        shorthand=f"off = ({x} - self.{middle.name}) / self.{width.name}",
    )


def _wave(place: LawPlace, c: SlotCovariate) -> LawForm:
    span, distinct = c.high - c.low, len(np.unique(c.values))
    if place.slot in QUICK and distinct > MANY:
        cycles = np.arange(CYCLES[0], min(QUICK_CYCLES, distinct / 10.0), 0.5)
    else:
        cycles = np.geomspace(CYCLES[0], min(CYCLES[1], distinct / 2.5), TRIED_CYCLES)
    lengths = (span / cycles).tolist()
    swing, unit = sized(place, "swing", "Amplitude"), c.unit
    shortest, longest = 0.3 * min(lengths), min(3.0 * span, MAX_NUMBER)
    length = LawNumber(
        with_unit("length", unit), unit, "Length of a wave", lengths[len(lengths) // 2], shortest, longest
    )
    phase = LawNumber("phase_rad", "rad", f"Phase at {c.words} = 0", 1.0, -6.3, 6.3, is_angle=True)
    return LawForm(
        place,
        "wave",
        (c.name,),
        f"a change of {place.noun} that is periodic in the {c.words}",
        f"self.{swing.name} * np.sin(2.0 * np.pi * {{{c.name}}} / self.{length.name} + self.phase_rad)",
        (swing, length, phase),
        tuple((place.size, at, turn) for at, turn in product(lengths, PHASES)),
    )


def _turning(place: LawPlace, c: SlotCovariate) -> Iterator[LawForm]:
    """Yield factors that repeat once or twice a turn."""
    swing = sized(place, "swing", "Amplitude")
    phase = LawNumber("phase_rad", "rad", f"Phase at {c.words} = 0", 1.0, -6.3, 6.3, is_angle=True)
    for shape, often, cycles in WAVES[: place.cycles]:
        yield LawForm(
            place,
            shape,
            (c.name,),
            f"a change of {place.noun} that repeats {often} a turn, over the {c.words}",
            f"self.{swing.name} * np.sin({cycles} * {{{c.name}}} + self.phase_rad)"
            + place.mean_over_turn.format(cycles=cycles),
            (swing, phase),
            tuple((place.size, turn) for turn in PHASES),
        )


def _powers(place: LawPlace, c: SlotCovariate, times: SlotCovariate | None) -> Iterator[LawForm]:
    """Yield straight lines, powers and saturations over a covariate, alone or in proportion to a second one."""
    if c.low > FROM_ZERO * c.high:
        return
    x, span, end = "{" + c.name + "}", c.high - c.low, f"{c.high:.6g}"
    unit, size, names = place.unit, place.size, (c.name,)
    factor, words = "", f"over the {c.words}"
    if times is not None:
        unit, size, names = (
            unit_per(place.unit, times.unit),
            size / float(np.median(times.values)),
            (c.name, times.name),
        )
        factor, words = f" * {{{times.name}}}", f"{words}, in proportion to the {times.words}"
    share = f", as a share of the {times.words}" if times else ""
    largest = LawNumber.amplitude(with_unit("largest", unit), unit, size, f"Change at {c.words} = {end}{share}")
    if times is not None or not _is_shipped_line(place, c):
        yield LawForm(
            place,
            "line",
            names,
            f"a straight line of {place.noun} {words}",
            f"self.{largest.name} * {x} / {end}{factor}",
            (largest,),
            ((size,),),
        )
    exponent = LawNumber("exponent", "1", "Exponent of the power", EXPONENTS[1], 0.2, 8.0)
    yield LawForm(
        place,
        "power",
        names,
        f"a power law of {place.noun} {words}",
        f"self.{largest.name} * ({x} / {end}) ** self.exponent{factor}",
        (largest, exponent),
        tuple((size, at) for at in EXPONENTS),
    )
    halves = [part * span for part in HALVES]
    meaning = f"Where half of the change at infinity is reached, {c.words}"
    half = LawNumber(with_unit("half", c.unit), c.unit, meaning, halves[1], 1e-3 * span, min(2.0 * span, MAX_NUMBER))
    yield LawForm(
        place,
        "saturation",
        names,
        f"a change of {place.noun} that saturates {words}",
        f"self.{largest.name} * {x} / ({x} + self.{half.name}){factor}",
        (replace(largest, meaning=f"Change at infinite {c.words}{share}"), half),
        tuple((size, at) for at in halves),
    )


def _is_shipped_line(place: LawPlace, c: SlotCovariate) -> bool:
    """Return whether a shipped effect, or a nominal parameter, is a straight line over the covariate."""
    shipped = {Slot.RANGE: {"distance_m", "incidence_rad", "temperature_C"}, Slot.FRICTION: {"omega_rad_s"}}
    return place.is_odd or c.name in shipped.get(place.slot, set())


def _oblique(place: LawPlace, c: SlotCovariate, material: str) -> LawForm:
    """Return an error with the square of the sine of the angle of incidence."""
    largest = replace(sized(place, "largest", "Change at a right angle"), start=4.0 * place.size)
    on_material = f" on {material}" if material else ""
    return LawForm(
        place,
        "sine_squared",
        (c.name,),
        f"an error of {place.noun} with the square of the sine of the {c.words}{on_material}",
        f"self.{largest.name} * np.sin({{{c.name}}}) ** 2",
        (largest,),
        ((largest.start,),),
        material=material,
    )


def _reading_forms(place: LawPlace, c: SlotCovariate) -> Iterator[LawForm]:
    """Yield what a range sensor may do to its reading: a floor, and coarse steps."""
    edges, span = _edges(c.values), c.high - c.low
    floor = LawNumber("floor_m", "m", "Smallest reading", edges[len(edges) // 4], 0.0, 2.0 * c.high, 0.0)
    yield LawForm(
        place,
        "floor",
        (c.name,),
        "a range that is never below some distance",
        "np.maximum(reading_m, self.floor_m)",
        (floor,),
        tuple((at,) for at in edges),
        is_result=True,
    )
    steps = np.geomspace(COARSE[0], COARSE[1], COARSE_STEPS)
    step = LawNumber("step_m", "m", "Size of a step", float(steps[COARSE_STEPS // 2]), 0.0, 2.0 * span, 0.0)
    coarse = "np.round(reading_m / np.maximum(self.step_m, 1e-9)) * self.step_m"
    yield LawForm(
        place,
        "rounding",
        (c.name,),
        "a range in coarse steps",
        f"np.where(self.step_m > 0.0, {coarse}, reading_m)",
        (step,),
        tuple((at,) for at in steps.tolist()),
        is_result=True,
    )


def _end_forms(place: LawPlace, c: SlotCovariate) -> Iterator[LawForm]:
    """Yield what may happen to small and large values: a dead zone, and an end of the range."""
    x, edges = "{" + c.name + "}", _edges(c.values)
    name, words = with_unit("below", c.unit), f"Smaller values are zero, {c.words}"
    below = LawNumber(name, c.unit, words, edges[len(edges) // 4], 0.0, 2.0 * c.high, 0.0)
    yield LawForm(
        place,
        "dead_zone",
        (c.name,),
        f"{place.noun} that is zero below one value",
        f"np.where({x} < self.{below.name}, 0.0, {x})",
        (below,),
        tuple((at,) for at in edges),
        is_result=True,
        jump=0,
    )
    name = with_unit("top", c.unit)
    top = LawNumber(name, c.unit, f"Largest value, {c.words}", edges[-1], 1e-3 * c.high, MAX_NUMBER, MAX_NUMBER)
    yield LawForm(
        place,
        "limit",
        (c.name,),
        f"{place.noun} that is never above one value",
        f"np.minimum({x}, self.{top.name})",
        (top,),
        tuple((at,) for at in edges),
        is_result=True,
    )


def _edges(values: Array) -> list[float]:
    """Return values between those of the rows, evenly among them."""
    unique = np.unique(values)
    between = 0.5 * (unique[1:] + unique[:-1])
    return np.unique(np.quantile(between, np.linspace(0.0, 1.0, EDGES), method="nearest")).tolist()
