"""How much better the extended robot predicts the held-out rows."""

from collections.abc import Mapping

from diagnosis.report.plots.gain import gain_plot
from diagnosis.report.report_data import ReportData
from diagnosis.report.sections.base import ReportSection
from diagnosis.report.sentences import quantities
from diagnosis.report.sentences.data.compared import left_out_sentence
from diagnosis.report.sentences.verdict.gain import gain_sentences


def _values(data: ReportData) -> Mapping[str, object]:
    return {
        "gain_sentences": gain_sentences(data),
        "left_out": left_out_sentence(data.diagnosis.measured),
        "quantities": quantities,
    }


def _plots(data: ReportData) -> Mapping[str, bytes]:
    return {"gain": gain_plot(data)} if data.by_quantity else {}


SECTION = ReportSection("What it gains", "gain.html.j2", _values, _plots)
