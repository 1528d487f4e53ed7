"""The sentences about why no effect is named although the fit moves parameters of the nominal robot."""

from diagnosis.diagnose import Diagnosis
from diagnosis.inference.fitting.hypothesis import deviated
from diagnosis.inference.naming.verdict import CaseVerdict, needed_for_name
from diagnosis.inference.selection.refusal import needed
from diagnosis.nuisances import Nuisance
from diagnosis.report.sentences.quantities import listed

MIN_MOVED = 1.0
"""Move of a parameter in tolerances from which it is mentioned."""
MAX_LISTED = 3
INSTRUMENTS = {
    "winding_resistance_ohm": "an ohmmeter",
    "wheel_diameter_m": "a calliper, or by rolling the robot along a tape measure",
    "track_m": "a ruler, from the middle of one wheel to that of the other",
}
"""Instruments for parameters that can be measured by hand."""


def why_no_name(diagnosis: Diagnosis) -> str:
    """Return why a difference that the fit absorbs has no name; empty if there is a name, or nothing to say."""
    if diagnosis.conclusion not in {CaseVerdict.EXPLAINED, CaseVerdict.UNDECIDED}:
        return ""
    fit = diagnosis.fit
    moves = [
        (nuisance, x)
        for nuisance, x in zip(fit.hypothesis.nuisances, fit.x.tolist(), strict=False)
        if nuisance.change is None and abs(x) >= MIN_MOVED
    ]
    if not moves:
        return ""
    furthest = sorted(moves, key=lambda move: -abs(move[1]))[:MAX_LISTED]
    moved = listed([_moved(nuisance, x) for nuisance, x in furthest])
    known = "Parameters of the nominal robot, which are known only to their tolerances, account for"
    instruments = [f"{n.name} with {INSTRUMENTS[n.name]}" for n, _ in furthest if n.name in INSTRUMENTS]
    how = f": measure {'; '.join(instruments)}" if instruments else ", if some numbers are known better"
    better = (
        f" A nominal.yaml with smaller tolerances would decide{how}." if any(not n.meaning for n, _ in furthest) else ""
    )
    if diagnosis.conclusion is CaseVerdict.UNDECIDED:
        return f"{known} a part of the difference: the fit moves {moved}.{better}"
    best = next((entry for entry in diagnosis.selection.refused if entry.drop > 0.0), None)
    beside = ""
    if best is not None and best.drop < needed(best.effect):
        beside = (
            f" Beside that, {best.effect.name} would lower the cost by {best.drop:.1f} only, and a name needs "
            f"{needed_for_name(best.effect):.0f}."
        )
    return f"{known} the difference: the fit moves {moved}. So no effect is named.{beside}{better}"


def _moved(nuisance: Nuisance, x: float) -> str:
    """Return, for example, `track_m by +1.5 % to 0.1421 m (1.5 tolerances of 1 %)`."""
    if nuisance.value == 0.0:
        return f"{nuisance.name} by {x:+.1f} tolerances of {nuisance.tolerance:.2g} {nuisance.unit}"
    value = deviated(nuisance, x)
    change, tolerance = 100.0 * (value / nuisance.value - 1.0), 100.0 * abs(nuisance.tolerance / nuisance.value)
    unit = "" if nuisance.unit == "1" else f" {nuisance.unit}"
    return f"{nuisance.name} by {change:+.2g} % to {value:.4g}{unit} ({abs(x):.1f} tolerances of {tolerance:.2g} %)"
