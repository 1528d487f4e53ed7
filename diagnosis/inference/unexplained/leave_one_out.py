"""How well a hypothesis predicts rows that nothing was fitted to, where few rows are and none is held out.

Each row of a bench is left out in turn, all numbers are fitted anew to the others, and the row is predicted (Stone, J.
Royal Statist. Soc. B 36 (1974) 111-147). The effects are those of the hypothesis: that they were chosen with the row in
sight makes the figure a little too good, and the less so the fewer were tried.
"""

from collections.abc import Mapping
from copy import copy

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fit import Fit, fits
from symolo.core.arrays import Array

MAX_ROWS = 60
"""Up to which it is worth its time; more rows can be held out."""


def leave_one_out(evidence: Evidence, fit: Fit) -> Mapping[str, Array]:
    """What is missed of each row when it is left out, by observed quantity, (n,) in its unit; NaN where not usable.

    Args:
        evidence: Of one bench, whose quantities have the same rows, none of them held out.
        fit: Of all rows; its numbers are where each fit begins.

    Raises:
        ValueError: There are more than 60 rows, or quantities of different rows.
    """
    rows = {len(of.values) for of in evidence.observed}
    if len(rows) != 1 or max(rows) > MAX_ROWS:
        raise ValueError(f"quantities of {sorted(rows)} rows, for one number up to {MAX_ROWS}")
    (count,) = rows
    missed = np.full((len(evidence.observed), count), np.nan)
    for row in range(count):
        of_row = np.zeros(len(evidence.values), dtype=bool)
        of_row[[place.start + row for place in evidence.places]] = True
        if not (of_row & evidence.fit).any():
            continue
        fewer = copy(evidence)
        fewer.fit = evidence.fit & ~of_row
        (found,) = fits(fewer, [(fit.hypothesis, fit.x)])
        mean = evidence.of([found.hypothesis.robot(found.x)]).mean[0]
        left = np.where(evidence.fit, evidence.values - mean, np.nan)
        missed[:, row] = [left[place][row] for place in evidence.places]
    return {of.name: missed[k] for k, of in enumerate(evidence.observed)}
