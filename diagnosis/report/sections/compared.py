"""What was compared: the source of the data, the stages of the simulator, and the rows and noise of each quantity."""

from collections.abc import Mapping

from diagnosis.report.report_data import ReportData
from diagnosis.report.sections.base import ReportSection
from diagnosis.report.sentences.data.compared import quantity_rows, rows_sentence, source_text


def _values(data: ReportData) -> Mapping[str, object]:
    measurement, evidence = data.diagnosis.measurement, data.diagnosis.evidence
    return {
        "measured": source_text(measurement),
        "stages": ", ".join(stage.name for stage in evidence.stages),
        "rows_sentence": rows_sentence(measurement, evidence),
        "quantity_rows": quantity_rows(evidence),
    }


SECTION = ReportSection("What was compared", "compared.html.j2", _values)
