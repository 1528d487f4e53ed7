"""Noise that differs between the materials of a bench is structure, and noise of another level is not."""

import importlib
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from diagnosis.diagnose import diagnose
from diagnosis.importers import tof_bench
from diagnosis.inference.unexplained.uneven_noise import uneven_noise
from diagnosis.predictors.base import Covariate, CovariateShape
from diagnosis.report.sentences.verdict.headline import headline
from diagnosis.report.sentences.verdict.unexplained import unexplained_sentence

pytestmark = pytest.mark.usefixtures("cases_on_the_path")


@pytest.fixture
def diagnosed(tmp_path):
    """The diagnosis of a bench of 150 rows and five materials whose errors are larger by a factor of a column."""

    def of(factor, column="material"):
        gap = importlib.import_module("gap_cases")
        case = gap.make_case("tof_bench", 8, rows="some")
        columns = case.columns
        distance_m, reading_m = columns["distance_m"], columns["reading_m"]
        times = np.array([factor(value) for value in columns[column]])
        is_near = np.abs(reading_m - distance_m) < 0.05
        error_m = np.where(is_near, times, 1.0) * (reading_m - distance_m)
        gap.write(replace(case, columns={**columns, "reading_m": np.round(distance_m + error_m, 3)}), tmp_path / "case")
        return diagnose(tof_bench.IMPORTER.read(tmp_path / "case"))

    return of


def test_noise_on_one_material_is_unexplained_and_gets_no_name(diagnosed):
    diagnosis = diagnosed(lambda name: 4.0 if name == "black_card" else 1.0)
    assert diagnosis.names == ()
    assert diagnosis.answer()["unexplained_where"] == {"channel": "reading_m", "covariate": "material"}
    where = "times as large in rows of the material black_card as in the others"
    assert where in headline(diagnosis)
    assert where in unexplained_sentence(diagnosis.unexplained)


@pytest.mark.parametrize(
    ("column", "edge", "words"), [("incidence_rad", 0.35, "angle of incidence"), ("temperature_C", 25.0, "temperature")]
)
def test_noise_at_a_slant_or_in_warmth_is_unexplained_and_gets_no_name(diagnosed, column, edge, words):
    diagnosis = diagnosed(lambda value: 5.0 if abs(value) > edge else 1.0, column)
    assert diagnosis.names == ()
    assert diagnosis.answer()["unexplained_where"] == {"channel": "reading_m", "covariate": column}
    assert f"times as large in rows with a high {words} as in the others" in headline(diagnosis)


def test_noise_on_all_materials_is_even(diagnosed):
    diagnosis = diagnosed(lambda _: 1.6)
    assert not diagnosis.answer()["unexplained"]


@pytest.mark.parametrize(
    ("sizes", "is_uneven"), [((1.0, 3.0), True), ((1.0, 1.2), False), ((1e-12, 3e-12), False), ((0.0, 1.0), True)]
)
def test_only_a_difference_that_matters_is_uneven(sizes, is_uneven):
    """Residuals of 6000 rows on two materials; nothing scatters on the plateau of a sensor but rounding errors."""
    material = np.arange(6000) % 2
    z = np.random.default_rng(3).standard_normal(6000) * np.array(sizes)[material]
    covariate = Covariate("material", material.astype(float), CovariateShape.CATEGORY, labels=("paper", "wood"))
    quantity = SimpleNamespace(name="reading_m", channel="reading_m", covariates=(covariate,), is_series=False)
    everything = np.ones(6000, dtype=bool)
    evidence = SimpleNamespace(observed=(quantity,), places=(slice(0, 6000),), fit=everything, values=z)
    found = list(uneven_noise(evidence, SimpleNamespace(z=z, hypothesis=SimpleNamespace(effects=()))))
    assert [structure.p < 1e-3 for structure in found] == [True] * is_uneven


@pytest.mark.parametrize("warm_C", [np.linspace(-20.0, 20.0, 90), np.repeat([20.0, 40.0], [30, 60])])
def test_noise_in_the_cold_is_uneven(warm_C):
    """From frost to warmth, or at two temperatures only; the residuals have five times the noise in the colder rows."""
    rows = np.random.default_rng(5).permutation(len(warm_C))
    z = np.random.default_rng(6).standard_normal(len(warm_C)) * np.where(
        warm_C[rows] <= np.median(warm_C[:60]), 5.0, 1.0
    )
    covariate = Covariate("temperature_C", warm_C[rows])
    quantity = SimpleNamespace(name="reading_m", channel="reading_m", covariates=(covariate,), is_series=False)
    everything = np.ones(len(z), dtype=bool)
    evidence = SimpleNamespace(observed=(quantity,), places=(slice(0, len(z)),), fit=everything, values=z)
    (found,) = uneven_noise(evidence, SimpleNamespace(z=z, hypothesis=SimpleNamespace(effects=())))
    assert found.p < 1e-3
    assert "in rows with a low temperature_C" in found.what


def test_readings_at_a_limit_do_not_scatter_whatever_their_material(tmp_path):
    """Targets beyond the limit are all of one material, so that it has hardly any residuals."""
    gap = importlib.import_module("gap_cases")
    case = gap.make_case("tof_bench", 6, rows="some")
    columns = case.columns
    limit_m = float(np.quantile(columns["distance_m"], 0.5))
    kept = (np.array(columns["material"]) == columns["material"][0]) | (columns["distance_m"] < limit_m - 0.02)
    reading_m = np.round(np.minimum(columns["reading_m"], limit_m), 3)
    cut = {name: values[kept] for name, values in {**columns, "reading_m": reading_m}.items()}
    gap.write(replace(case, columns=cut), tmp_path / "case")
    diagnosis = diagnose(tof_bench.IMPORTER.read(tmp_path / "case"))
    assert diagnosis.names == ("range_saturation",)
    assert not diagnosis.answer()["unexplained"]
