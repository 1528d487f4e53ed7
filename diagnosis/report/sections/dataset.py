"""Whether a dataset covers the measured drive, if one was named."""

from collections.abc import Mapping

from diagnosis.report import dataset_comparison
from diagnosis.report.plots.coverage import coverage_plot
from diagnosis.report.report_data import ReportData
from diagnosis.report.sections.base import ReportSection


def _values(_data: ReportData) -> Mapping[str, object]:
    return {"dataset_comparison": dataset_comparison}


def _plots(data: ReportData) -> Mapping[str, bytes]:
    return {} if data.dataset is None else {"against": coverage_plot(data.dataset)}


SECTION = ReportSection(
    "Comparison with the dataset",
    "dataset.html.j2",
    _values,
    _plots,
    is_shown=lambda data: data.dataset is not None,
)
