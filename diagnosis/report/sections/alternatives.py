"""Effects that these data cannot distinguish or do not show, and what to measure."""

from collections.abc import Mapping

from diagnosis.inference.selection.rivals import AS_GOOD
from diagnosis.next_trial.template import without_trials
from diagnosis.report.report_data import ReportData
from diagnosis.report.sections.base import ReportSection
from diagnosis.report.sentences.effects.named import to_measure


def _values(data: ReportData) -> Mapping[str, object]:
    return {
        "as_good": AS_GOOD,
        "to_measure": to_measure,
        "without_trials": without_trials(data.diagnosis.measurement),
    }


SECTION = ReportSection("What cannot be distinguished, and what to measure", "alternatives.html.j2", _values)
