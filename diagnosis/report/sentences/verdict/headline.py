"""The headline of the report: what is wrong, in one sentence."""

from collections.abc import Sequence

from diagnosis.diagnose import Diagnosis
from diagnosis.inference.evidence.stuck_rows import stuck_rows
from diagnosis.inference.fitting.likelihood import LEVELS
from diagnosis.inference.naming.verdict import DOUBT, NOISY, CaseVerdict
from diagnosis.inference.selection.refusal import needed
from diagnosis.inference.unexplained.adequacy import Structure
from diagnosis.inference.unexplained.scatter import SCATTER
from diagnosis.inference.unexplained.uneven_noise import UNEVEN
from diagnosis.measured.measurement import CaseKind
from diagnosis.report.sentences.effects.file_numbers import label
from diagnosis.report.sentences.effects.hints import hints
from diagnosis.report.sentences.quantities import along, listed
from diagnosis.report.sentences.verdict.parameters_off import parameters_off
from diagnosis.report.sentences.verdict.unexplained import uneven_noise_words

_MAX_VOLTAGES = 3
"""Voltages at standstill that the headline lists; more are counted."""
_MORE_LIKELY_THAN_NOT = 0.5


def headline(diagnosis: Diagnosis) -> str:
    """Return what is wrong, in one sentence."""
    names = _labels(diagnosis)
    structure = diagnosis.unexplained
    if structure is None:
        if names and any(named.comparison.confidence < _MORE_LIKELY_THAN_NOT for named in diagnosis.named):
            fit = "fits" if len(names) == 1 else "fit"
            return f"The real robot differs from the nominal one. {listed(names)} {fit} best, but this is not certain."
        if names:
            return f"The real robot differs from the nominal one by {listed(names)}."
        if diagnosis.conclusion is CaseVerdict.UNDECIDED:
            open_points = _open_points(diagnosis)
            text = f"These data neither confirm the nominal simulation nor name what differs: {open_points}."
        elif parameters_off(diagnosis.fit):
            text = "No effect is needed to explain these data, but numbers of the nominal robot seem to be wrong."
        else:
            text = "The nominal simulation explains these data, within the tolerances of its parameters."
        stuck = _standstill(diagnosis)
        return f"{stuck}; apart from that, {text[0].lower()}{text[1:]}" if stuck else text
    if diagnosis.adequacy.leaves_only_outliers:
        rows = f"successive rows of {structure.observed} are far off together, as the logger alone may cause it"
        if names:
            return f"The real robot differs from the nominal one by {listed(names)}; in addition, {rows}."
        return f"No effect is named, but {rows}."
    return _headline_of_unexplained(diagnosis, structure, names)


def _headline_of_unexplained(diagnosis: Diagnosis, structure: Structure, names: Sequence[str]) -> str:
    """Return that residuals have structure; if a warning about the log names a likely cause, that it is one."""
    what = f"{structure.channel} depends on {along(structure.covariate)}"
    if structure.what.startswith(SCATTER):
        by = "the noise that nominal.yaml states" if diagnosis.measurement.nominal else "the stated noise"
        what = f"{structure.channel} has a {structure.what.replace('the stated noise', by)}"
    if structure.what.startswith(UNEVEN):
        what = f"{structure.channel} has {uneven_noise_words(structure)}"
    where = f"{what}, and no known effect explains this"
    if diagnosis.measurement.checks:
        where = f"{what}; the warning about the log names a likely cause"
        if not names:
            return f"The simulation and these data do not fit together: {where}. Correct that first."
    if not names:
        return f"The simulation is wrong in a way that has no name here: {where}."
    return f"The real robot differs from the nominal one by {listed(names)}; in addition, {where}."


def _labels(diagnosis: Diagnosis) -> list[str]:
    """Return the names, with a remark where the file of an effect states other numbers."""
    remarks = {named.effect.name: label(named) for named in (diagnosis.named if diagnosis.names else ())}
    return [remarks.get(name, name) for name in diagnosis.names]


def no_effect(diagnosis: Diagnosis) -> str:
    """Return why no law is named, in one sentence."""
    if diagnosis.names:
        return "No other effect is named."
    why = {
        CaseVerdict.EXPLAINED: "none is needed to explain these data",
        CaseVerdict.UNDECIDED: "something may differ, but these data do not suffice to name it",
    }.get(diagnosis.conclusion, "no known effect explains these data")
    return f"No effect is named: {why}."


def _standstill(diagnosis: Diagnosis) -> str:
    """Return that a real motor stands still where the nominal one turns, as a clause; empty if none does."""
    if diagnosis.measurement.kind is not CaseKind.MOTOR_STEADY:
        return ""
    volts = sorted({row.voltage_V for row in stuck_rows(diagnosis.measurement, diagnosis.nominal)})
    if not volts:
        return ""
    several = f"{len(volts)} voltages from {volts[0]:g} to {volts[-1]:g} V"
    where = several if len(volts) > _MAX_VOLTAGES else listed([f"{voltage_V:g} V" for voltage_V in volts])
    return f"The real motor stands still at {where}, where the nominal one turns"


def _open_points(diagnosis: Diagnosis) -> str:
    """Return what suggests that something differs, as a clause."""
    parts = [f"{each.name} was considered, but {each.reason}" for each in diagnosis.withheld]
    parts += [
        f"{name} would lower the cost by {fall:.1f}, where a name needs {fall * times:.0f}"
        for name, fall, times in hints(diagnosis)
    ]
    parts += [
        f"{entry.effect.name} would lower the cost by {entry.drop:.1f}, but {entry.reason}"
        for entry in diagnosis.selection.refused
        if entry.drop >= needed(entry.effect)
    ]
    first = next(iter(diagnosis.adequacy.structures), None)
    if first is not None and first.p < DOUBT:
        parts.append(f"the residuals of {first.observed} may depend on {along(first.covariate)} (p = {first.p:.2g})")
    parts += [
        f"{name} scatters {'at least ' if level >= LEVELS[1] else ''}{level:.1f} times as much as stated"
        for name, level in diagnosis.scatters
        if level >= NOISY
    ]
    return "; ".join(parts)
