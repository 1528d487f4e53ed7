"""Errors of a hypothesis on rows left out of the fit, for a bench with few rows and none held out.

Each row is left out in turn, all parameters are fitted again to the others, and the row is predicted (Stone, J. Royal
Statist. Soc. B 36 (1974) 111-147). The effects stay those of the hypothesis. Since they were selected with all rows,
the errors are a little too small, the less so the fewer effects were tried.
"""

from collections.abc import Mapping

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit, fits
from symolo.core.arrays import Array

MAX_ROWS = 60
"""Limit for the computing time; with more rows, some can be held out."""


def leave_one_out(evidence: Evidence, fit: HypothesisFit) -> Mapping[str, Array]:
    """Return the error of each row that is left out, (n,) by observed quantity in its unit.

    It is NaN where the row is not usable, and where only a state is known.

    Args:
        evidence: Observations of one bench, whose quantities have the same rows, none of them held out.
        fit: Fit of all rows, where each fit begins.

    Raises:
        ValueError: There are more than 60 rows, or quantities with different numbers of rows.
    """
    rows = {len(observed.values) for observed in evidence.observed}
    if len(rows) != 1 or max(rows) > MAX_ROWS:
        raise ValueError(f"quantities with {sorted(rows)} rows; all need the same number, at most {MAX_ROWS}")
    (count,) = rows
    errors = np.full((len(evidence.observed), count), np.nan)
    for row in range(count):
        in_row = np.zeros(len(evidence.values), dtype=bool)
        in_row[[place.start + row for place in evidence.places]] = True
        if not (in_row & evidence.fit).any():
            continue
        (refit,) = fits(evidence.with_rows(fit=evidence.fit & ~in_row), [(fit.hypothesis, fit.x)])
        mean = evidence.predicted([refit.robot]).mean[0] + refit.whitened_change
        residuals = np.where(evidence.fit, evidence.values - mean, np.nan)
        errors[:, row] = [residuals[place][row] for place in evidence.places]
    return {
        observed.name: np.where(observed.is_state, np.nan, errors[k]) if observed.is_state is not None else errors[k]
        for k, observed in enumerate(evidence.observed)
    }
