"""The named effects with their parameters, their confidence and their doubts, and effects that are nearly named."""

from collections.abc import Iterator, Mapping

from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.report.report_data import ReportData
from diagnosis.report.sections.base import ReportSection
from diagnosis.report.sentences import quantities
from diagnosis.report.sentences.effects import file_numbers
from diagnosis.report.sentences.effects.doubts import log_doubts, size_doubts
from diagnosis.report.sentences.effects.hints import hints
from diagnosis.report.sentences.effects.named import certainty, interval_text
from diagnosis.report.sentences.effects.torque_constants import torque_constants
from diagnosis.report.sentences.effects.wheel_sizes import wheel_sizes
from diagnosis.report.sentences.verdict.gain import without_effect
from diagnosis.report.sentences.verdict.headline import no_effect


def _values(data: ReportData) -> Mapping[str, object]:
    return {
        "effects": [
            (named, ablation, list(parameter_rows(named, data)))
            for named, ablation in zip(data.diagnosis.named, data.ablations, strict=True)
        ],
        "hints": list(hints(data.diagnosis)),
        "quantities": quantities,
        "file_numbers": file_numbers,
        "wheel_sizes": wheel_sizes,
        "torque_constants": torque_constants,
        "certainty": certainty,
        "size_doubts": size_doubts,
        "log_doubts": log_doubts,
        "without_effect": without_effect,
        "no_effect": no_effect,
    }


def parameter_rows(named: NamedEffect, data: ReportData) -> Iterator[tuple[str, ...]]:
    """Yield name, value, interval and unit of each parameter, and its value in the effect's file if that states one."""
    intervals, numbers = data.intervals.get(named.effect.name, {}), named.effect.kind.parameters()
    stated = {number.name: file_numbers.file_number(number) for number in named.file_numbers}
    for name, value in named.values.items():
        interval = interval_text(intervals[name]) if name in intervals else "not determined by these data"
        unit = numbers[name].unit
        row = (name, quantities.with_error(value, named.std[name]), interval, "" if unit == "1" else unit)
        yield (*row, stated.get(name, "-")) if stated else row
    for name, value in named.known.items():
        row = (name, f"{value:.3g}", quantities.ASSUMED, "" if numbers[name].unit == "1" else numbers[name].unit)
        yield (*row, "-") if stated else row


SECTION = ReportSection("What differs", "differences.html.j2", _values)
