"""A step log whose noise is more correlated from row to row than its nominal.yaml states."""

import importlib

import numpy as np
import pytest
from scipy.signal import lfilter

from diagnosis.diagnose import diagnose
from diagnosis.importers import motor_step

pytestmark = pytest.mark.usefixtures("cases_on_the_path")


def test_rows_that_are_more_correlated_than_stated_are_no_structure(tmp_path, monkeypatch):
    """AR(1) noise of 0.6 where 0.3 is stated: with the stated one, this log has a trend with p below 0.001."""

    def correlated(rng, shape, *_):
        return lfilter([0.8], [1.0, -0.6], rng.standard_normal(shape), axis=-1)

    gap = importlib.import_module("gap_cases")
    monkeypatch.setattr(importlib.import_module("gap_cases.motor_step"), "correlated", correlated)
    gap.write(gap.make_case("motor_step", 1, rows="some"), tmp_path / "case")
    diagnosis = diagnose(motor_step.IMPORTER.read(tmp_path / "case"))
    assert (diagnosis.names, diagnosis.answer()["unexplained"]) == ((), False)
    assert diagnosis.evidence.correlations[1] == pytest.approx(0.6, abs=0.1)
    assert np.all(np.array(diagnosis.evidence.correlations) < 0.7)
