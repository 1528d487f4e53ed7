"""The files of the fitted robot and of all robots that agree with the data, and how to simulate them."""

from collections.abc import Mapping

from diagnosis.extended_robot import FILE
from diagnosis.posterior.posterior import FILE as POSTERIOR_FILE
from diagnosis.report.report_data import ReportData
from diagnosis.report.sections.base import ReportSection


def _values(_data: ReportData) -> Mapping[str, object]:
    return {"file": FILE, "posterior_file": POSTERIOR_FILE}


SECTION = ReportSection("The extended robot", "extended_robot.html.j2", _values)
