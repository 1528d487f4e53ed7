"""Errors of both robots when PyBullet drives them, if that was requested."""

from collections.abc import Mapping

from diagnosis.report import engines
from diagnosis.report.plots.path import path_plot
from diagnosis.report.report_data import ReportData
from diagnosis.report.sections.base import ReportSection
from diagnosis.report.sentences import quantities


def _values(_data: ReportData) -> Mapping[str, object]:
    return {"engines": engines, "quantities": quantities}


def _plots(data: ReportData) -> Mapping[str, bytes]:
    path = None if data.engines is None else data.engines.path
    return {} if path is None else {"path": path_plot(path)}


SECTION = ReportSection(
    "In PyBullet", "engines.html.j2", _values, _plots, is_shown=lambda data: data.engines is not None
)
