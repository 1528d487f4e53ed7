"""Noise that differs between the materials of a bench is structure, and noise of another level is not."""

import importlib
from dataclasses import replace

import numpy as np
import pytest

from diagnosis.diagnose import diagnose
from diagnosis.importers import tof_bench
from diagnosis.report.verdict import headline, unexplained_sentence

pytestmark = pytest.mark.usefixtures("cases_on_the_path")


@pytest.fixture
def diagnosed(tmp_path):
    """The diagnosis of a bench of 150 rows and five materials whose errors are larger by a factor of the material."""

    def of(factor):
        gap = importlib.import_module("gap_cases")
        case = gap.make_case("tof_bench", 8, rows="some")
        columns = case.columns
        distance_m, reading_m = columns["distance_m"], columns["reading_m"]
        times = np.array([factor(name) for name in columns["material"]])
        is_near = np.abs(reading_m - distance_m) < 0.05
        error_m = np.where(is_near, times, 1.0) * (reading_m - distance_m)
        gap.write(replace(case, columns={**columns, "reading_m": np.round(distance_m + error_m, 3)}), tmp_path / "case")
        return diagnose(tof_bench.IMPORTER.read(tmp_path / "case"))

    return of


def test_noise_on_one_material_is_unexplained_and_gets_no_name(diagnosed):
    diagnosis = diagnosed(lambda name: 4.0 if name == "black_card" else 1.0)
    assert diagnosis.names == ()
    assert diagnosis.answer()["unexplained_where"] == {"channel": "reading_m", "covariate": "material"}
    assert "as large for material black_card as for the others" in headline(diagnosis)
    assert "as large for material black_card as for the others" in unexplained_sentence(diagnosis.unexplained)


def test_noise_on_all_materials_is_even(diagnosed):
    diagnosis = diagnosed(lambda _: 1.6)
    assert not diagnosis.answer()["unexplained"]
