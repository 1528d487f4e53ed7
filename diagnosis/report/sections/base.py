"""A section of the page: its heading, its template, the values and plots that the template shows."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from markupsafe import Markup

from diagnosis.report.report_data import ReportData
from symolo.pages.html import render_part


def _always(_data: ReportData) -> bool:
    return True


def _nothing(_data: ReportData) -> Mapping[str, object]:
    return MappingProxyType({})


def _no_plots(_data: ReportData) -> Mapping[str, bytes]:
    return MappingProxyType({})


@dataclass(frozen=True)
class ReportSection:
    """A section of the page. Its template gets `data`, `diagnosis`, the PNGs of all `plots` by name, and its values."""

    title: str
    template: str
    """Name of a file in `diagnosis/report/templates/`."""
    values: Callable[[ReportData], Mapping[str, object]] = _nothing
    """Function that returns the further values of the template by name."""
    plots: Callable[[ReportData], Mapping[str, bytes]] = _no_plots
    """Function that returns the PNG of each plot of the section by name, which is also that of its file."""
    is_shown: Callable[[ReportData], bool] = _always
    """Function that returns whether a diagnosis has this section."""

    def body(self, data: ReportData, plots: Mapping[str, bytes]) -> Markup | None:
        """Return the section below its heading; None if the diagnosis does not have it."""
        if not self.is_shown(data):
            return None
        values = self.values(data)
        return render_part(
            "diagnosis.report", self.template, data=data, diagnosis=data.diagnosis, plots=plots, **values
        )
