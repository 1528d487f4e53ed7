"""Readings of the extended robot in runs that have inputs only."""

from collections.abc import Mapping

from diagnosis.report.plots.unseen import unseen_plot
from diagnosis.report.report_data import ReportData
from diagnosis.report.sections.base import ReportSection
from diagnosis.report.sentences.data.beyond import BEYOND_SENTENCE, beyond_list


def _values(data: ReportData) -> Mapping[str, object]:
    return {"beyond_sentence": BEYOND_SENTENCE, "beyond": list(beyond_list(data.unseen))}


def _plots(data: ReportData) -> Mapping[str, bytes]:
    return {prediction.file.removesuffix(".csv"): unseen_plot(prediction) for prediction in data.unseen}


SECTION = ReportSection(
    "Predictions for unseen runs", "unseen.html.j2", _values, _plots, is_shown=lambda data: bool(data.unseen)
)
