"""The steps by which the diagnosis came to its result."""

from collections.abc import Mapping

from diagnosis.report.report_data import ReportData
from diagnosis.report.sections.base import ReportSection
from diagnosis.report.summary import reasoning


def _values(data: ReportData) -> Mapping[str, object]:
    return {"reasoning": reasoning(data)}


SECTION = ReportSection("How the verdict was reached", "reasoning.html.j2", _values)
