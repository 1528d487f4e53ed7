"""The sections of the page of a diagnosis: a module for each, with its `SECTION`."""

from diagnosis.report.sections import (
    alternatives,
    compared,
    dataset,
    differences,
    engines,
    extended_robot,
    gain,
    law,
    matrix,
    misfit,
    predictive,
    reasoning,
    unexplained,
    unseen,
)
from diagnosis.report.sections.base import ReportSection

SECTIONS: tuple[ReportSection, ...] = (
    law.SECTION,
    compared.SECTION,
    dataset.SECTION,
    misfit.SECTION,
    differences.SECTION,
    gain.SECTION,
    engines.SECTION,
    alternatives.SECTION,
    unexplained.SECTION,
    predictive.SECTION,
    matrix.SECTION,
    extended_robot.SECTION,
    unseen.SECTION,
    reasoning.SECTION,
)
"""Sections in the order of the page."""
