"""Measured and predicted values of each quantity, and the residuals of each robot."""

from collections.abc import Mapping

from diagnosis.report.plots.misfit import misfit_plot
from diagnosis.report.report_data import ReportData
from diagnosis.report.sections.base import ReportSection
from diagnosis.report.sentences.data.compared import misfit_caption


def _values(data: ReportData) -> Mapping[str, object]:
    structures = {structure.observed: structure for structure in data.structures}
    names, unexplained = [observed.name for observed in data.diagnosis.evidence.observed], data.diagnosis.unexplained
    return {"misfit": [(name, misfit_caption(name, structures.get(name), unexplained)) for name in names]}


def _plots(data: ReportData) -> Mapping[str, bytes]:
    return {observed.name: misfit_plot(data, k) for k, observed in enumerate(data.diagnosis.evidence.observed)}


SECTION = ReportSection("The misfit", "misfit.html.j2", _values, _plots)
