"""The report as one HTML page without other files: what was compared, what is wrong, what the effects gain."""

from collections.abc import Mapping

from diagnosis.measured.overview import summary_line
from diagnosis.report.report_data import ReportData
from diagnosis.report.sections import SECTIONS
from diagnosis.report.sentences.data.early_voltages import early_voltage_sentences
from diagnosis.report.sentences.effects import discovered
from diagnosis.report.sentences.effects.named import effect_sentences
from diagnosis.report.sentences.verdict.gain import gain_sentences
from diagnosis.report.sentences.verdict.headline import headline
from diagnosis.report.sentences.verdict.no_name import why_no_name
from diagnosis.report.sentences.verdict.parameters_off import off_sentences
from symolo.pages.html import render_page


def page(data: ReportData, plots: Mapping[str, bytes]) -> str:
    """Return the whole page: the verdict, and below it the sections.

    Args:
        data: Everything that is shown.
        plots: PNG of each plot of the sections by name.
    """
    diagnosis = data.diagnosis
    return render_page(
        "diagnosis.report",
        title=f"{diagnosis.measurement.name}: diagnosis",
        measurement=diagnosis.measurement,
        source=summary_line(diagnosis.measurement),
        headline=headline(diagnosis),
        early_voltages=early_voltage_sentences(diagnosis),
        numbers_off=off_sentences(diagnosis),
        effect_sentences=[*effect_sentences(diagnosis), *filter(None, [why_no_name(diagnosis)])],
        law=next(iter(discovered.sentences(diagnosis.discovery)), "") if diagnosis.law else "",
        gain=gain_sentences(data)[0],
        sections=[(section.title, section.body(data, plots)) for section in SECTIONS],
    )
