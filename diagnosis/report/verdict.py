"""The verdict in plain sentences, the same on a terminal and on the page."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil, log10

from diagnosis.diagnose import Diagnosis, Named
from diagnosis.inference.fit import Fit
from diagnosis.inference.gain import Gain
from diagnosis.inference.profile import Interval
from diagnosis.inference.selection import Entry, needed
from diagnosis.inference.unexplained.adequacy import Structure
from diagnosis.report.findings import Findings, Without
from diagnosis.report.quantities import along, confidence, cost, interval, meaning, percent, with_error
from diagnosis.report.quantities import named as in_words

HINT = 10.0
"""Fall of the cost from which an effect that is not believed is worth a word: less, the best of a library often reaches
where nothing is hidden."""
BENT = 4.0
"""Tolerances from which a nominal parameter is called bent."""


@dataclass(frozen=True)
class Bent:
    """A nominal parameter that calibration alone moves out of its tolerance."""

    name: str
    tolerances: float


def headline(diagnosis: Diagnosis) -> str:
    """What is wrong, in a sentence."""
    names = [of.effect.name for of in diagnosis.named]
    left = diagnosis.unexplained
    if not names and left is None:
        return "The nominal simulation explains these data, within the tolerances of its parameters."
    where = ""
    if left is not None:
        where = f"{left.channel} depends on {along(left.covariate)} in a way that no known effect accounts for"
    if not names:
        return f"Something is wrong that has no name here: {where}."
    found = f"The real robot differs from the nominal one by {_listed(names)}"
    return f"{found}; beside that, {where}." if left else f"{found}."


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def cause(named: Named) -> str:
    """What in a robot brings an effect about."""
    return named.effect.kind.cause


def in_a_sentence(named: Named) -> str:
    """Name, numbers, what that means, and what brings it about."""
    numbers = []
    for name, value in named.values.items():
        unit = named.effect.kind.parameters()[name].unit
        numbers.append(f"{name} = {with_error(value, named.std[name])}{'' if unit == '1' else f' {unit}'}")
    return f"{named.effect.name}: {', '.join(numbers)}. {meaning(named.effect.kind)} It comes of: {cause(named)}."


CHANCE_IS_NEAR = 0.9
"""Confidence of an effect without rivals, below which the doubt is whether there is anything."""


def certainty(named: Named) -> str:
    """How sure the name is, and against what."""
    rivals = named.standing.ambiguous_with
    if rivals:
        return f"{confidence(named.standing.confidence)}; these data cannot tell it from {_listed(list(rivals))}"
    if named.standing.rivals:
        closest = named.standing.rivals[0]
        return f"{confidence(named.standing.confidence)}; the closest rival, {closest.effect.name}, explains them worse"
    rest = "no other effect comes near"
    if named.standing.confidence < CHANCE_IS_NEAR:
        rest += ", but the fall of the cost is little more than chance can bring"
    return f"{confidence(named.standing.confidence)}; {rest}"


def to_measure(named: Named) -> Iterator[tuple[str, str]]:
    """For an effect that has rivals: each name, and the data in which it shows."""
    close = [rival.effect for rival in named.standing.rivals if rival.effect.name in named.standing.ambiguous_with]
    if close:
        for effect in (named.effect, *close):
            yield effect.name, effect.kind.excitation


def taken_away(without: Without) -> str:
    """What becomes of the model without an effect, everything else fitted anew, in half a sentence."""
    told = f"the cost rises by {cost(without.rise)}"
    if moved := _bent_told(without.fit):
        told += f", with parameters further off than their tolerances allow ({moved})"
    if without.gain is None or without.adds is None:
        return told
    rest = f"the gain on held-out rows is {_interval(without.gain)}"
    return f"{told}; {rest}, and the effect takes {_interval(without.adds)} of the error that is then left"


def reach(intervals: Sequence[Interval]) -> str:
    """How far a number may go by the profile of the cost: the widest interval."""
    widest = intervals[-1]
    digits = max(3, 2 + ceil(log10(max(abs(widest.low), abs(widest.high)) / (widest.high - widest.low))))
    ends = f"{widest.low:.{digits}g} to {widest.high:.{digits}g}"
    return f"{percent(widest.level)} profile interval {ends}" + (", open at a bound" if widest.is_open else "")


def left_over(structure: Structure) -> str:
    """What remains and where, in a sentence."""
    words, _ = in_words(structure.covariate)
    shape = {
        "trend": f"a smooth curve over {words}",
        "category": f"another mean for each {words}",
        "turn": f"a swing with {words}",
        "place": "an error that depends on the place",
    }.get(structure.what, f"a {structure.what} over {words}")
    chance = "less than 1e-12" if structure.p < 1e-12 else f"{structure.p:.2g}"
    return (
        f"What is left in {structure.observed} has structure along {along(structure.covariate)} ({shape}); "
        f"chance alone shows as much with a probability of {chance}."
    )


def hints(diagnosis: Diagnosis) -> Iterator[tuple[str, float, float]]:
    """Effects that are too weak to be named: name, fall of the cost, and how many times as many rows would decide."""
    for entry in _last_round(diagnosis):
        threshold = needed(entry.effect)
        if HINT <= entry.drop < threshold:
            yield entry.effect.name, entry.drop, threshold / entry.drop


def _last_round(diagnosis: Diagnosis) -> list[Entry]:
    """Those that were tried on top of the final model."""
    entries = diagnosis.selection.entries
    last = max((k for k, entry in enumerate(entries) if entry.accepted), default=-1)
    return list(entries[last + 1 :])


def bent(fit: Fit) -> list[Bent]:
    """Nominal parameters that a fit moves further than their tolerances make likely, the furthest first."""
    deviations = fit.hypothesis.prior(fit.x).tolist()
    found = [Bent(n.name, d) for n, d in zip(fit.hypothesis.nuisances, deviations, strict=True) if abs(d) >= BENT]
    return sorted(found, key=lambda of: -abs(of.tolerances))


def _bent_told(fit: Fit) -> str:
    """Such as `track_m by 5 tolerances`; empty for none."""
    names = ", ".join(f"{of.name} by {abs(of.tolerances):.0f}" for of in bent(fit))
    return f"{names} tolerances" if names else ""


def gained(found: Findings) -> list[str]:
    """On held-out rows: the gain, its interval, and that of calibration alone."""
    diagnosis = found.diagnosis
    if diagnosis.gain is None or diagnosis.calibrated is None:
        return ["No row is held out, so that nothing can be said of how well the model predicts what it has not seen."]
    calibrated = f"Fitting the nominal parameters alone, without any effect, gains {_interval(diagnosis.calibrated)}"
    if moved := _bent_told(diagnosis.selection.nominal):
        calibrated += f", but moves parameters further than their tolerances allow ({moved})"
    if not diagnosis.named:
        return [f"{calibrated}."]
    error = f"the error falls from {diagnosis.gain.before:.3g} to {diagnosis.gain.after:.3g} sigma"
    return [f"On rows that nothing was fitted to, {error}: a gain of {_interval(diagnosis.gain)}.", f"{calibrated}."]


def _interval(gain: Gain) -> str:
    return f"{percent(gain.value)} ({interval(gain.low, gain.high)})"
