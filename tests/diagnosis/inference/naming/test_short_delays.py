"""Names of delays that are far below a row, of which only held-out rows can show that they are real."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.naming.named_model import NamedModel, _name_evidence
from diagnosis.inference.selection.rivals import RivalComparison

X = np.linspace(-1.0, 1.0, 120)


@pytest.mark.parametrize(("delay_s", "is_short"), [(0.04, True), (0.06, False)])
def test_the_evidence_for_a_name_says_whether_it_is_a_delay_far_below_a_row(
    evidence_of, hypothesis, effect, delay_s, is_short
):
    """Rows are 1 s apart, and a twentieth of that is short."""
    late = effect("input_delay")
    evidence, extended = evidence_of(X, X, theta_rad=X), hypothesis.with_effect(late)
    base, fit = fits(evidence, [(each, each.null()) for each in (hypothesis, extended)])
    x = fit.x.copy()
    x[extended.parameters(late)] = delay_s / late.coordinates[0].unit
    model: Any = SimpleNamespace(leaves_only_outliers=True)
    comparison = RivalComparison(late, 0.9, ())
    fit = replace(fit, x=x)
    name = _name_evidence(evidence, base, NamedModel(fit, [comparison], model), comparison, base)
    assert name.is_far_below_a_row is is_short
