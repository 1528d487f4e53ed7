"""Forms of an error whose cause is in no list: functions of one covariate with few numbers.

The flexible functions of `bases` describe any smooth residual with many numbers. A cause that nobody listed often has a
simple form all the same: friction is greater about one speed, a counter stops above another, a gain drifts, a material
reflects differently at a slant. In each form here all numbers but the size are fixed, so that a residual is linear in
it.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.inference.unexplained.bases import SHARE_OF_SIGN, WITH_COVARIATE
from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import Covariate, CovariateShape, Observed
from symolo.core.arrays import Array

PLACES = 20
"""Number of values of a covariate at which forms begin or have their middle, at quantiles of the rows."""
WIDTHS = (0.05, 0.1, 0.2)
"""Widths of bumps, as shares of the range of the covariate."""
MIN_ROWS = 3
"""Smallest number of rows of the fit that a form changes; fewer are outliers."""
CHANGED = 0.1
"""Share of the largest change, from which a row counts as changed by a form."""
FOLLOWS = 0.8
"""Share of rows with the same sign, from which a covariate has the sign of the prediction."""
WITH_READING = ", changing sign with the reading"
CLOCKS = ("t_s", "row", "session_time_s")
"""Covariates that tell only when a row was taken. Other functions of them are drifts, jumps and runs of outliers, which
have tests of their own."""

GAIN = "gain that changes"
SURROUNDINGS = ("temperature_C", "ambient_lux")
"""Covariates that a gain may follow, and that do not follow the reading."""


@dataclass(frozen=True)
class Form:
    """Form of the error of one quantity, for any size."""

    covariate: str
    rank: int
    """Index of the covariate in the list of its quantity."""
    what: str
    chosen: int
    """How many numbers were chosen for the form, such as the middle of a bump and its width."""
    column: Array
    """(n,), error of each row, in any unit."""


@dataclass(frozen=True)
class Bump(Form):
    """A Gaussian bump, whose middle and width may change."""

    size: Array
    """(n,), covariate, or its size if the form is the same at both signs."""
    sign: Array | float
    """(n,), sign of the error."""
    middle: float
    width: float

    def moved(self, middle: float, width: float) -> "Bump":
        """Return the bump with another middle and width."""
        column = _where_known(self.size, np.exp(-(((self.size - middle) / width) ** 2)) * self.sign)
        return replace(self, column=column, middle=middle, width=width)


def forms(quantity: Observed, predicted: Array, rows: Mask) -> Iterator[Form]:
    """Yield the forms of a quantity.

    Args:
        quantity: The quantity, with n rows.
        predicted: (n,), its prediction.
        rows: (n,), rows of the fit.
    """
    sides: dict[str, Array | float] = {"": 1.0}
    if _has_both_signs(predicted[rows]):
        sides[WITH_READING] = np.sign(predicted)
    covariates = [(k, c) for k, c in enumerate(quantity.covariates) if c.second is None]
    smooth = [(k, c) for k, c in covariates if c.shape in {CovariateShape.SMOOTH, CovariateShape.SINCE}]
    conditions = [(k, c) for k, c in smooth if c.name not in CLOCKS]
    for rank, covariate in smooth:
        if covariate.name in CLOCKS:
            candidates = _drifting_gains(rank, covariate, predicted, rows)
        else:
            candidates = _along(rank, covariate, sides, rows)
        yield from (form for form in candidates if _changes_enough(form, rows))
        if covariate.name in SURROUNDINGS:
            yield from _gains_in_surroundings(rank, covariate, predicted, rows)
    for _, category in covariates:
        if category.shape is CovariateShape.CATEGORY:
            for rank, covariate in conditions:
                candidates = _category_forms(category, rank, covariate, rows)
                yield from (form for form in candidates if _changes_enough(form, rows))


def _drifting_gains(rank: int, clock: Covariate, predicted: Array, rows: Mask) -> Iterator[Form]:
    """Yield a gain that is right at the start and drifts, and one that is right in the middle of the time."""
    times = clock.values[rows & np.isfinite(clock.values)]
    for right_at in (times.min(), times.mean()) if len(times) else ():
        column = _where_known(clock.values, (clock.values - right_at) * predicted)
        yield Form(clock.name, rank, "gain that drifts", 0, column)


def _gains_in_surroundings(rank: int, covariate: Covariate, predicted: Array, rows: Mask) -> Iterator[Form]:
    """Yield a gain that follows a covariate, and is right at its mean."""
    inside = covariate.values[rows & np.isfinite(covariate.values)]
    if len(np.unique(inside)) >= MIN_ROWS:
        column = _where_known(covariate.values, (covariate.values - inside.mean()) * predicted)
        yield Form(covariate.name, rank, GAIN, 0, column)


def _along(rank: int, covariate: Covariate, sides: dict[str, Array | float], rows: Mask) -> Iterator[Form]:
    """Yield steps, kinks and bumps along a covariate."""
    values, name = covariate.values, covariate.name
    views = [(values, sides)]
    if _has_both_signs(values[rows]):
        # An error that depends on the size alone has one sign, that of the prediction or, of a tilt, that of the
        # covariate.
        amplitudes = {"": 1.0, WITH_COVARIATE: np.sign(values)} if len(sides) == 1 else sides
        views = [(np.abs(values), amplitudes)]
        if not _follows(values, sides):
            views.append((values, sides))
    for size, signs in views:
        inside = np.unique(size[rows & np.isfinite(size)])
        if len(inside) < 2 * MIN_ROWS:
            continue
        edges = _some(0.5 * (inside[1:] + inside[:-1]))
        shapes = [("step", np.where(size > edge, 1.0, 0.0)) for edge in edges]
        shapes += [("kink", np.maximum(direction * (size - edge), 0.0)) for edge in edges for direction in (1.0, -1.0)]
        widths = [share * float(np.ptp(inside)) for share in WIDTHS]
        for suffix, sign in signs.items():
            for what, shape in shapes:
                yield Form(name, rank, what + suffix, 1, _where_known(size, shape * sign))
            for middle in _some(inside):
                for width in widths:
                    bump = Bump(name, rank, "bump" + suffix, 2, size, size, sign, middle, width)
                    yield bump.moved(middle, width)


def _category_forms(category: Covariate, rank: int, covariate: Covariate, rows: Mask) -> Iterator[Form]:
    """Yield functions of a covariate that act in the rows of one category only, such as one material."""
    names = np.unique(category.values[rows & np.isfinite(category.values)])
    for name in names.tolist() if len(names) > 1 else ():
        for what, power in (("slope", 1), ("curve", 2)):
            column = _where_known(covariate.values, np.where(category.values == name, covariate.values**power, 0.0))
            yield Form(covariate.name, rank, f"{what} in one {category.name}", 1, column)


def _changes_enough(form: Form, rows: Mask) -> bool:
    inside = np.abs(form.column[rows])
    return bool(np.count_nonzero(inside > CHANGED * inside.max(initial=0.0)) >= MIN_ROWS)


def _has_both_signs(values: Array) -> bool:
    known = values[np.isfinite(values)]
    return len(known) > 0 and float(min(np.mean(known < 0.0), np.mean(known > 0.0))) >= SHARE_OF_SIGN


def _follows(values: Array, sides: dict[str, Array | float]) -> bool:
    """Return whether a covariate has the sign of the prediction."""
    return len(sides) > 1 and float(np.mean(np.sign(values) == sides[WITH_READING])) > FOLLOWS


def _some(values: Array) -> list[float]:
    """Return some of sorted values, evenly among them."""
    return np.unique(np.quantile(values, np.linspace(0.0, 1.0, PLACES), method="nearest")).tolist()


def _where_known(values: Array, column: Array) -> Array:
    return np.where(np.isfinite(values), column, 0.0)
