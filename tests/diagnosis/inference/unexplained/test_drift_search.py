"""A fit beside a random drift has the likelihood of a Gaussian process."""

import importlib
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from diagnosis.importers import tof_bench
from diagnosis.inference.unexplained.drift.search import DriftSearch

SD_M, TAU_S = 0.01, 12.0


@pytest.fixture(scope="module")
def drifting(tmp_path_factory, nominal_fit, cases_on_the_path):
    """The measured evidence of a bench of 150 rows with a random drift, and its fit without effects."""
    del cases_on_the_path
    gap = importlib.import_module("gap_cases")
    case = gap.make_case("tof_bench", 8, rows="some")
    t_s = case.columns["t_s"]
    covariance = np.exp(-np.abs(np.subtract.outer(t_s, t_s)) / TAU_S)
    path_m = SD_M * np.linalg.cholesky(covariance) @ np.random.default_rng(3).standard_normal(len(t_s))
    folder = tmp_path_factory.mktemp("bench") / "case"
    gap.write(
        replace(case, columns={**case.columns, "reading_m": np.round(case.columns["reading_m"] + path_m, 3)}), folder
    )
    fit = nominal_fit(tof_bench.IMPORTER.read(folder))
    return fit.evidence, fit


def test_the_rows_have_the_likelihood_of_a_gaussian_process(drifting):
    """Each row is compared with what those before it say; the product is the joint density (Harvey 1989, 3.4)."""
    evidence, fit = drifting
    search = DriftSearch.from_fit(evidence, fit)
    seen = search.beside(fit)
    error, beside = seen.error, evidence.beside(search.memory(seen))
    prediction = beside.predicted([fit.robot])
    rows = np.flatnonzero(search.rows)
    sd = np.sqrt(error.level) * fit.noise.levels[0] * prediction.sd[0, rows]
    z = (beside.values - prediction.mean[0])[rows] / sd
    by_rows = float((z**2 + 2.0 * np.log(sd) + np.log(2.0 * np.pi)).sum())
    raw = evidence.predicted([fit.robot])
    t_s = search.time_s[rows]
    white_m2 = error.level * (fit.noise.levels[0] * raw.sd[0, rows]) ** 2
    covariance = error.error_m**2 * np.exp(-np.abs(np.subtract.outer(t_s, t_s)) / error.tau_s) + np.diag(white_m2)
    density = multivariate_normal.logpdf(evidence.values[rows], raw.mean[0, rows], covariance)
    assert by_rows == pytest.approx(-2.0 * density, rel=1e-9)


def test_a_held_out_row_knows_all_others_and_no_other_held_out_one(drifting):
    """Mean and variance of a Gaussian process (Rasmussen and Williams 2006, eq. 2.23 and 2.24)."""
    evidence, fit = drifting
    search = DriftSearch.from_fit(evidence, fit)
    seen = search.beside(fit)
    error, memory = seen.error, search.memory(seen)
    rows, heldout = np.flatnonzero(search.rows), np.flatnonzero(evidence.heldout)[:5]
    t_s, at_s = search.time_s[rows], search.time_s[heldout]
    white_m2 = error.level * fit.sd**2
    covariance = error.error_m**2 * np.exp(-np.abs(np.subtract.outer(t_s, t_s)) / error.tau_s) + np.diag(white_m2[rows])
    cross = error.error_m**2 * np.exp(-np.abs(np.subtract.outer(at_s, t_s)) / error.tau_s)
    residual_m = (fit.z * fit.sd)[rows]
    carried_m = memory.carried(memory.reference + fit.z * fit.sd)[heldout]
    assert carried_m == pytest.approx(cross @ np.linalg.solve(covariance, residual_m))
    variance_m2 = error.error_m**2 - np.diag(cross @ np.linalg.solve(covariance, cross.T))
    assert memory.wider[heldout] == pytest.approx(np.sqrt(1.0 + variance_m2 / white_m2[heldout]))
    assert not memory.shares[:, np.flatnonzero(evidence.heldout)].any()
