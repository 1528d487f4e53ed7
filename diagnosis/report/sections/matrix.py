"""How far each effect would move each quantity, and which effects look alike."""

from collections.abc import Mapping

from diagnosis.report.matrix import matrix_rows
from diagnosis.report.report_data import ReportData
from diagnosis.report.sections.base import ReportSection


def _values(data: ReportData) -> Mapping[str, object]:
    return {"matrix_rows": matrix_rows(data)}


SECTION = ReportSection("How each effect would show in these data", "matrix.html.j2", _values)
