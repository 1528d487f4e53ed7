"""A gain that follows the temperature is in no list; an offset that follows it is `temperature_drift`."""

import importlib
from dataclasses import replace

import numpy as np
import pytest

from diagnosis.diagnose import diagnose
from diagnosis.importers import tof_bench
from diagnosis.inference.naming.verdict import CaseVerdict
from diagnosis.report.sentences.verdict.unexplained import unexplained_sentence

pytestmark = pytest.mark.usefixtures("cases_on_the_path")


@pytest.fixture
def diagnosed(tmp_path):
    """The diagnosis of a bench of 150 rows at 10 to 40 degrees, with an error [m] of distance [m] and temperature."""

    def of(error_m):
        gap = importlib.import_module("gap_cases")
        case = gap.make_case("tof_bench", 8, rows="some")
        warm_C = np.random.default_rng(4).uniform(10.0, 40.0, len(case.columns["t_s"])).round(1)
        reading_m = np.round(case.columns["reading_m"] + error_m(case.columns["distance_m"], warm_C), 3)
        gap.write(replace(case, columns={**case.columns, "temperature_C": warm_C, "reading_m": reading_m}), tmp_path)
        return diagnose(tof_bench.IMPORTER.read(tmp_path))

    return of


def test_a_gain_that_follows_the_temperature_is_no_offset_that_does(diagnosed):
    diagnosis = diagnosed(lambda distance_m, warm_C: 0.0008 * (warm_C - 25.0) * distance_m)
    assert diagnosis.names == ()
    assert diagnosis.conclusion is CaseVerdict.UNEXPLAINED
    assert "a gain that changes with temperature" in unexplained_sentence(diagnosis.adequacy.structures[0])


def test_an_offset_that_follows_the_temperature_keeps_its_name(diagnosed):
    diagnosis = diagnosed(lambda _, warm_C: 0.0004 * (warm_C - 25.0))
    assert diagnosis.names == ("temperature_drift",)
    assert diagnosis.conclusion is CaseVerdict.NAMED
