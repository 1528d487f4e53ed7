"""The diagnosis as plain text, for a terminal; `reasoning` has how it came about."""

from collections.abc import Iterator, Mapping, Sequence
from textwrap import wrap

from diagnosis.diagnose import Named
from diagnosis.inference.profile import Interval
from diagnosis.inference.rivals import AS_GOOD
from diagnosis.inference.unexplained.adequacy import LEVEL
from diagnosis.measured.overview import summary_line
from diagnosis.report.against import verdict
from diagnosis.report.bench_rows import too_large
from diagnosis.report.engines import in_lines
from diagnosis.report.findings import Findings, Without
from diagnosis.report.quantities import meaning, with_error
from diagnosis.report.verdict import (
    cause,
    certainty,
    gained,
    headline,
    hints,
    left_over,
    reach,
    taken_away,
    to_measure,
)

WIDTH = 118
HEAD = 22


def summary(found: Findings) -> list[str]:
    """A line each: verdict, effects, what cannot be told apart, what remains, gain."""
    diagnosis = found.diagnosis
    lines = [summary_line(diagnosis.measurement), "", *wrap(headline(diagnosis), WIDTH)]
    for named, without in zip(diagnosis.named, found.without, strict=True):
        lines += ["", *_effect(named, without, found.intervals.get(named.name, {}))]
    if diagnosis.unexplained is not None:
        lines += ["", *_entry("unexplained", left_over(diagnosis.unexplained))]
    if diagnosis.withdrawn:
        given_up = f"{', '.join(diagnosis.withdrawn)}: they only stood in for what is unexplained"
        lines += _entry("not named", given_up)
    for name, drop, times in hints(diagnosis):
        text = f"{name}, too weak to be named (cost falls by {drop:.1f}); about {times:.1f} times the rows would decide"
        lines += _entry("a hint of", text)
    lines += ["", *(line for text in (*gained(found), *found.on_rows) for line in wrap(text, WIDTH))]
    if found.against is not None:
        first, *rest = verdict(found.against)
        lines += ["", first, *(part for text in rest for part in wrap(f"  {text}", WIDTH, subsequent_indent="    "))]
    if found.engines is not None:
        lines += ["", *(part for line in in_lines(found.engines) for part in wrap(line, WIDTH))]
    if diagnosis.candidates.untestable:
        lines += ["", *_entry("these cannot show", ", ".join(diagnosis.candidates.untestable))]
    for gone in found.robot.left_out:
        lines += _entry("not in the robot file", f"{gone.name}: {gone.why}")
    if found.robot.problem:
        lines += _entry("not yet driveable", found.robot.problem)
    return lines


def _effect(named: Named, without: Without, intervals: Mapping[str, Sequence[Interval]]) -> Iterator[str]:
    yield named.effect.name
    for name, value in named.values.items():
        far = f"; {reach(intervals[name])}" if name in intervals else ""
        yield from _entry(f"  {name}", with_error(value, named.std[name], "+-") + far)
    yield from _entry("  means", meaning(named.effect.kind))
    yield from _entry("  comes of", cause(named))
    yield from _entry("  sure to", certainty(named))
    for text in too_large(named):
        yield from _entry("  too large", text)
    yield from _entry("  without it", taken_away(without))
    for name, excitation in to_measure(named):
        yield from _entry(f"  {name} shows in", excitation)


def _entry(head: str, text: str) -> list[str]:
    """A heading and its text, wrapped beside it."""
    first, *more = wrap(text, WIDTH - HEAD, break_on_hyphens=False) or [""]
    beside = [f"{head:{HEAD}}{first}"] if len(head) < HEAD else [head, " " * HEAD + first]
    return [*beside, *(" " * HEAD + line for line in more)]


def reasoning(found: Findings) -> list[str]:
    """A line each: what was tried and why it was taken or not, rivals, tests of what is left."""
    diagnosis = found.diagnosis
    lines = ["Selection: each effect tried on top of what is in already, and what decided"]
    lines += [
        f"  {'taken' if entry.accepted else '':6}{entry.effect.name:30} {entry.reason}"
        for entry in diagnosis.selection.entries
    ] or ["  nothing was promising"]
    for named in diagnosis.named:
        lines += [f"Rivals of {named.effect.name}: cost more in its place; up to {AS_GOOD:g} cannot be told apart"]
        lines += [f"  {rival.effect.name:36} {rival.worse:+.1f}" for rival in named.standing.rivals] or ["  none"]
    lines += [f"What the selected model leaves, most telling first; structure from p < {LEVEL:g}"]
    lines += [
        f"  {of.observed:20} along {of.covariate:20} {of.what:18} p = {of.p:.2g}"
        for of in diagnosis.adequacy.structures[:MAX_TESTS]
    ]
    if diagnosis.withdrawn:
        lines += [f"Given up, for they are not needed beside that structure: {', '.join(diagnosis.withdrawn)}"]
    lines += ["Look alike in these data, whatever is found (cosine of their changes)"]
    lines += [f"  {a} and {b}: {cosine:.3f}" for a, b, cosine in found.signatures.alike] or ["  none"]
    untestable = ", ".join(diagnosis.candidates.untestable) or "none"
    lines += [f"Move no prediction of these data, so that they can be neither found nor excluded: {untestable}"]
    return lines


MAX_TESTS = 12
