"""Structure of the residuals that no effect explains, and the search for a law."""

from collections.abc import Mapping

from diagnosis.report.plots.unexplained import unexplained_plot
from diagnosis.report.report_data import ReportData
from diagnosis.report.sections.base import ReportSection
from diagnosis.report.sentences.effects import discovered
from diagnosis.report.sentences.verdict.parameters_off import off_sentences
from diagnosis.report.sentences.verdict.unexplained import nothing_left, unexplained_sentence


def _values(data: ReportData) -> Mapping[str, object]:
    return {
        "numbers_off": off_sentences(data.diagnosis),
        "unexplained_sentence": unexplained_sentence,
        "nothing_left": nothing_left,
        "discovered": list(discovered.sentences(data.diagnosis.discovery)),
    }


def _plots(data: ReportData) -> Mapping[str, bytes]:
    structure = data.diagnosis.unexplained
    return {} if structure is None else {"unexplained": unexplained_plot(data, structure)}


SECTION = ReportSection("What stays unexplained", "unexplained.html.j2", _values, _plots)
