"""A simulated drive in which nothing is hidden, and the nominal robot fitted to a measurement."""

import importlib
from dataclasses import replace

import numpy as np
import pytest

from diagnosis.case_robot import base_robot_of, nominal_of, spreads_of
from diagnosis.importers import drive_log
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import Hypothesis
from diagnosis.predictors import STAGES


def nominal(measurement):
    """The samples of a measurement and the hypothesis without effects."""
    robot = nominal_of(measurement, base_robot_of(measurement, None))
    return Evidence(STAGES[measurement.kind](measurement, robot)), Hypothesis(robot, spreads_of(measurement, robot))


@pytest.fixture(scope="session")
def nominal_fit():
    """Fits the nominal robot, without effects, to a measurement."""

    def fitted(measurement):
        evidence, hypothesis = nominal(measurement)
        return fits(evidence, [(hypothesis, hypothesis.null())])[0]

    return fitted


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    """The samples of a drive of two trials of 30 s without a fault and without voltages, and the nominal hypothesis."""
    gap = importlib.import_module("gap_cases")
    case = gap.make_case("drive_log", 1, rows="few")
    blank = {name: np.full(len(case.columns["t_s"]), np.nan) for name in ("u_left_V", "u_right_V")}
    folder = tmp_path_factory.mktemp("drive") / "case"
    gap.write(replace(case, columns={**case.columns, **blank}), folder)
    return nominal(drive_log.IMPORTER.read(folder))
