"""Whether robots that agree with the data would give data like these (posterior predictive check)."""

from collections.abc import Mapping

from diagnosis.report.plots.predictive import predictive_plot
from diagnosis.report.report_data import ReportData
from diagnosis.report.sections.base import ReportSection
from diagnosis.report.sentences.data.predictive import predictive_sentence


def _values(data: ReportData) -> Mapping[str, object]:
    return {"predictive_sentence": predictive_sentence(data.predictive)}


def _plots(data: ReportData) -> Mapping[str, bytes]:
    return {"predictive": predictive_plot(data.predictive)} if data.predictive else {}


SECTION = ReportSection(
    "Would robots like this give such data?",
    "predictive.html.j2",
    _values,
    _plots,
    is_shown=lambda data: bool(data.predictive),
)
