"""The diagnosis as plain text, for a terminal; `reasoning` describes how it came about."""

import textwrap
from collections.abc import Iterator
from typing import Any

from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.inference.selection.rivals import AS_GOOD
from diagnosis.inference.unexplained.adequacy import LEVEL
from diagnosis.measured.overview import summary_line
from diagnosis.next_trial.template import without_trials
from diagnosis.report.dataset_comparison import verdict
from diagnosis.report.engines import in_lines
from diagnosis.report.report_data import Ablation, ReportData
from diagnosis.report.sentences.data.beyond import BEYOND_SENTENCE, beyond_list
from diagnosis.report.sentences.data.early_voltages import early_voltage_sentences
from diagnosis.report.sentences.effects import discovered, file_numbers
from diagnosis.report.sentences.effects.doubts import log_doubts, size_doubts
from diagnosis.report.sentences.effects.hints import hints
from diagnosis.report.sentences.effects.named import certainty, interval_text, random_drift_sentence, to_measure
from diagnosis.report.sentences.effects.torque_constants import torque_constants
from diagnosis.report.sentences.effects.wheel_sizes import wheel_sizes
from diagnosis.report.sentences.quantities import ASSUMED, meaning, with_error
from diagnosis.report.sentences.verdict.gain import gain_sentences, without_effect
from diagnosis.report.sentences.verdict.headline import headline
from diagnosis.report.sentences.verdict.no_name import why_no_name
from diagnosis.report.sentences.verdict.parameters_off import off_sentences
from diagnosis.report.sentences.verdict.unexplained import unexplained_sentence

WIDTH = 118
_LABEL_WIDTH = 22
_MAX_TESTS = 12
_FIRM = "\x1f"
"""Character in place of a space at which no line ends."""


def wrap(text: str, width: int, **settings: Any) -> list[str]:  # noqa: ANN401 - those of textwrap.wrap
    """Return the lines of a text; a number and its sign of percent stay together."""
    return [line.replace(_FIRM, " ") for line in textwrap.wrap(text.replace(" %", f"{_FIRM}%"), width, **settings)]


def summary(data: ReportData) -> list[str]:
    """Return the lines: verdict, effects, alternatives, what remains unexplained, gain."""
    diagnosis = data.diagnosis
    compared_with = wrap(diagnosis.measurement.compared_with, WIDTH)
    lines = [
        summary_line(diagnosis.measurement),
        *compared_with,
        *_warnings(data),
        "",
        *wrap(headline(diagnosis), WIDTH),
        *wrap(early_voltage_sentences(diagnosis), WIDTH),
        *wrap(off_sentences(diagnosis, "+-"), WIDTH, break_on_hyphens=False),
    ]
    lines += wrap(why_no_name(diagnosis), WIDTH)
    for named, ablation in zip(diagnosis.named, data.ablations, strict=True):
        lines += ["", *_effect(named, ablation, data)]
    if diagnosis.random_drift is not None:
        lines += ["", *wrap(random_drift_sentence(diagnosis.random_drift), WIDTH)]
    lines += _not_named(data)
    lines += ["", *(line for text in (*gain_sentences(data), *data.row_sentences) for line in wrap(text, WIDTH))]
    if data.dataset is not None:
        first, *rest = verdict(data.dataset)
        lines += ["", first, *(part for text in rest for part in wrap(f"  {text}", WIDTH, subsequent_indent="    "))]
    if data.engines is not None:
        lines += ["", *(part for line in in_lines(data.engines) for part in wrap(line, WIDTH))]
    if beyond := list(beyond_list(data.unseen)):
        lines += ["", *wrap(f"warning: {BEYOND_SENTENCE}", WIDTH)]
        lines += [part for text in beyond for part in wrap(f"  {text}", WIDTH, subsequent_indent="    ")]
    if diagnosis.candidates.untestable:
        lines += ["", *_entry("not visible here", ", ".join(diagnosis.candidates.untestable))]
    for effect in data.robot.left_out:
        lines += _entry("not in the robot file", f"{effect.name}: {effect.why}")
    if data.robot.problem:
        lines += _entry("cannot drive yet", data.robot.problem)
    return lines


def _warnings(data: ReportData) -> Iterator[str]:
    for text in data.diagnosis.measurement.checks:
        yield ""
        warning = f"warning: {text}. If the log is wrong there, so is everything below."
        yield from wrap(warning, WIDTH, break_on_hyphens=False)


def _not_named(data: ReportData) -> Iterator[str]:
    """Yield what is unexplained, and which effects were considered and are not named."""
    diagnosis = data.diagnosis
    if diagnosis.unexplained is not None:
        yield ""
        yield from _entry("unexplained", unexplained_sentence(diagnosis.unexplained))
    for label, text in discovered.entries(diagnosis.discovery):
        yield from _entry(label, text)
    if diagnosis.withdrawn:
        names = ", ".join(diagnosis.withdrawn)
        yield from _entry("withdrawn", f"{names}: only a substitute for what is unexplained")
    for each in diagnosis.withheld:
        yield from _entry("withheld", f"{each.name}: {each.reason}")
    for name, drop, times in hints(diagnosis):
        text = f"{name}, too weak to be named: the cost falls by {drop:.1f}, and a name needs {drop * times:.0f}; "
        text += f"about {times:.1f} times as many rows like these would decide"
        yield from _entry("hint", text)
    for tried in data.own_effects:
        yield from _entry("your own", f"{tried.name}, {tried.text}")


def _assumed(named: NamedEffect) -> Iterator[str]:
    for name, value in named.known.items():
        yield from _entry(f"  {name}", f"{value:.3g}; {ASSUMED}")


def _effect(named: NamedEffect, ablation: Ablation, data: ReportData) -> Iterator[str]:
    intervals = data.intervals.get(named.effect.name, {})
    stated = {number.name: f"; its file has {file_numbers.file_number(number, '+-')}" for number in named.file_numbers}
    yield named.effect.name
    for name, value in named.values.items():
        interval = f"; {interval_text(intervals[name])}" if name in intervals else ""
        yield from _entry(f"  {name}", with_error(value, named.std[name], "+-") + interval + stated.get(name, ""))
    yield from _assumed(named)
    if stated:
        rise = data.rise_with_file[named.effect.name]
        yield from _entry("  its file", file_numbers.comparison(named, rise, ablation.cost_rise))
    for label, text in (
        ("  wheels", wheel_sizes(named, data.diagnosis, "+-")),
        ("  torque constants", torque_constants(named, data.diagnosis, "+-")),
    ):
        yield from _entry(label, text) if text else ()
    yield from _entry("  meaning", meaning(named.effect.kind))
    yield from _entry("  possible causes", named.effect.kind.cause)
    yield from _entry("  confidence", certainty(named))
    if named.ranges:
        yield from _entry("  seen for", named.seen_for)
    for text in size_doubts(named):
        yield from _entry("  too large", text)
    for text in log_doubts(named, data.diagnosis.measurement):
        yield from _entry("  doubt", text)
    yield from _entry("  without it", without_effect(ablation, data.diagnosis.fit))
    for name, excitation in to_measure(named):
        yield from _entry(f"  {name} shows in", excitation)
    if named.comparison.ambiguous_with:
        text = "designed by: symolo next DIR --out next, where DIR is the folder of this diagnosis"
        if reason := without_trials(data.diagnosis.measurement):
            text = f"`symolo next` designs none for these data, {reason}"
        yield from _entry("  next trial", text)


def _entry(label: str, text: str) -> list[str]:
    """Return a label and its text, which is wrapped to the right of the label."""
    indent = " " * _LABEL_WIDTH
    lines = [indent + line for line in wrap(text, WIDTH - _LABEL_WIDTH, break_on_hyphens=False) or [""]]
    if len(label) >= _LABEL_WIDTH:
        return [label, *lines]
    return [f"{label:{_LABEL_WIDTH}}{lines[0][_LABEL_WIDTH:]}", *lines[1:]]


def reasoning(data: ReportData) -> list[str]:
    """Return the lines: effects that were tried, why they were accepted or not, alternatives, tests of residuals."""
    diagnosis = data.diagnosis
    lines = ["Selection: each effect that was tried in addition to the accepted ones, and what decided"]
    lines += [
        f"  {'taken' if entry.accepted else '':6}{entry.effect.name:30} {entry.reason}"
        for entry in diagnosis.selection.entries
    ] or ["  no effect was promising"]
    for named in diagnosis.named:
        lines += [
            f"Alternatives to {named.effect.name}: increase of the cost; up to {AS_GOOD:g} cannot be distinguished"
        ]
        lines += [f"  {rival.effect.name:36} {rival.worse:+.1f}" for rival in named.comparison.rivals] or ["  none"]
    lines += [f"Residuals of the selected model, the strongest structure first; it counts if p < {LEVEL:g}"]
    lines += [
        f"  {structure.observed:20} along {structure.covariate:20} {structure.what:18} p = {structure.p:.2g}"
        for structure in diagnosis.adequacy.structures[:_MAX_TESTS]
    ]
    if diagnosis.withdrawn:
        lines += [f"Withdrawn, since that structure makes them unnecessary: {', '.join(diagnosis.withdrawn)}"]
    lines += ["Effects that look alike in these data (cosine of their changes); whether an effect that is named can be"]
    lines += ["distinguished from them all the same, as with many rows, is under its alternatives"]
    lines += [f"  {a} and {b}: {cosine:.3f}" for a, b, cosine in data.signatures.alike] or ["  none"]
    untestable = ", ".join(diagnosis.candidates.untestable) or "none"
    text = f"Effects that change no prediction of these data, so that nothing is known about them: {untestable}"
    return [*lines, *wrap(text, WIDTH, subsequent_indent="  ", break_on_hyphens=False)]
