"""The law that describes what no listed effect explains, with its plot and its file."""

from collections.abc import Mapping

from diagnosis.report.plots.law import law_plot
from diagnosis.report.report_data import ReportData
from diagnosis.report.sections.base import ReportSection
from diagnosis.report.sentences.effects import discovered


def _values(data: ReportData) -> Mapping[str, object]:
    # The page begins with the first sentence.
    return {"sentences": list(discovered.sentences(data.diagnosis.discovery))[1:]}


def _plots(data: ReportData) -> Mapping[str, bytes]:
    law = data.diagnosis.law
    return {} if law is None else {"law": law_plot(data, law)}


SECTION = ReportSection("The law", "law.html.j2", _values, _plots, is_shown=lambda data: data.diagnosis.law is not None)
