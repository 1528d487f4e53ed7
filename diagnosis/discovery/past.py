"""Forms that depend on more than the present values of a covariate: the row before, the past, or single rays."""

from collections.abc import Iterator

from configs.effects.base import Slot
from diagnosis.discovery.form import LawForm, LawNumber, sized
from diagnosis.discovery.place import STEP, LawPlace, SlotCovariate

RAY_POWERS, RAY_LOSSES = (-1.0, 0.5, 1.0, 2.0, 3.0), (-5.0, 2.0, 5.0, 10.0, 20.0)
"""Exponents and losses [1/m] of the weight of a ray that are tried."""
LAGS = (0.02, 0.04, 0.08, 0.15, 0.3)
"""Time constants of a lag, as shares of the session."""


def past_forms(place: LawPlace) -> Iterator[LawForm]:
    """Yield the forms that depend on the row before, or on all rows before."""
    step, trend, voltage, time = (place.covariates.get(name) for name in (STEP, "voltage_step_V", "u_cmd_V", "t_s"))
    if place.slot is Slot.RANGE and step is not None:
        yield from _previous_reading_forms(place, step)
    if place.slot is Slot.RAY_WEIGHT:
        for covariate in place.covariates.values():
            yield from _ray_weight_forms(place, covariate)
    if place.slot is Slot.FRICTION and trend is not None and trend.low < 0.0 < trend.high:
        more = sized(place, "more", "Change after a fall of the voltage's size")
        yield LawForm(
            place,
            "hysteresis",
            (trend.name,),
            f"a change of {place.noun} after the size of the voltage has fallen",
            f"np.where({{{trend.name}}} < 0.0, self.{more.name}, 0.0)",
            (more,),
            ((more.start,),),
        )
    if place.slot is Slot.WINDING_HEAT and voltage is not None and time is not None:
        yield _heat(place, voltage, time)


def _previous_reading_forms(place: LawPlace, c: SlotCovariate) -> Iterator[LawForm]:
    """Yield what a range sensor keeps of its reading before: a share of it, and the direction of the change."""
    x, reach = "{" + c.name + "}", max(abs(c.low), abs(c.high))
    share = LawNumber.amplitude("share", "1", place.size / reach, "Share of the reading before in each reading")
    yield LawForm(
        place,
        "memory",
        (c.name,),
        f"a share of the reading before in {place.noun}",
        f"self.share * -{x}",
        (share,),
        ((share.start,),),
    )
    after = sized(place, "after_rise", "Change after the distance has grown, and its opposite after it has fallen")
    yield LawForm(
        place,
        "hysteresis",
        (c.name,),
        f"a change of {place.noun} by the direction in which the distance has changed",
        f"self.{after.name} * np.sign({x})",
        (after,),
        ((after.start,),),
    )


def _ray_weight_forms(place: LawPlace, c: SlotCovariate) -> Iterator[LawForm]:
    """Yield weights that fall with the distance along a ray, as a power or exponentially."""
    x = "{" + c.name + "}"
    exponent = LawNumber("exponent", "1", "Exponent of the fall", 2.0, -6.0, 6.0, 0.0)
    loss = LawNumber("loss_per_m", "1/m", "Loss by the way", 5.0, -50.0, 50.0, 0.0)
    for shape, words, change, number, tries in (
        (
            "power",
            "falls with a power of the distance along it",
            f"weight * np.maximum({x}, 1e-3) ** -self.exponent",
            exponent,
            RAY_POWERS,
        ),
        (
            "exponential",
            "falls exponentially with the distance along it",
            f"weight * np.exp(-self.loss_per_m * {x})",
            loss,
            RAY_LOSSES,
        ),
    ):
        yield LawForm(
            place,
            shape,
            (c.name,),
            f"{place.noun} that {words}",
            change,
            (number,),
            tuple((at,) for at in tries),
            is_result=True,
        )


def _heat(place: LawPlace, voltage: SlotCovariate, time: SlotCovariate) -> LawForm:
    """Return a resistance that follows the square of the voltage with a first-order lag."""
    span = time.high - time.low
    meaning = "Growth of the resistance, as a share of it, after a long time at 1 V"
    rise = LawNumber.amplitude("rise_per_V2", "1/V2", place.size / voltage.high**2, meaning)
    lags = [part * span for part in LAGS]
    lag = LawNumber("lag_s", "s", "Time constant of the lag", lags[len(lags) // 2], 1e-3 * span, 2.0 * span)
    return LawForm(
        place,
        "lag",
        (voltage.name,),
        f"{place.noun} that follows the square of the past {voltage.words} with a lag",
        f"(self.rise_per_V2 * {{{voltage.name}}}**2 - share) * -np.expm1(-duration_s / self.lag_s)",
        (rise, lag),
        tuple((rise.start, at) for at in lags),
    )
