"""The log score of held-out readings: by how much a model makes them more likely than another one.

An effect of the noise changes the predicted scatter and no predicted mean, so that the error of the prediction (`gain`)
cannot show what it is worth. The logarithm of the predicted density at the readings can, and nothing but the true
density has a higher mean (Gneiting and Raftery, J. Am. Stat. Assoc. 102 (2007) 359-378, section 4.1).
"""

from dataclasses import dataclass

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.gain import RESAMPLINGS, row_blocks

_SEED = 20_26


@dataclass(frozen=True)
class LogScoreChange:
    """Mean change of the log-likelihood of a held-out reading from one model to another."""

    value: float
    low: float
    """Lower end of the 95 % interval."""
    high: float
    """Upper end of the 95 % interval."""


def log_score_change(evidence: Evidence, before: HypothesisFit, after: HypothesisFit) -> LogScoreChange | None:
    """Return by how much a fit makes held-out readings more likely than another one; None if none are held out.

    The interval comes from a bootstrap over the same blocks of rows as that of a gain.
    """
    rows = evidence.heldout
    if not rows.any():
        return None
    # A cost is minus twice a log-likelihood.
    changes = 0.5 * (before.costs - after.costs)[rows]
    names, block = np.unique(row_blocks(evidence)[rows], return_inverse=True)
    sums, counts = np.bincount(block, changes), np.bincount(block)
    drawn = np.random.Generator(np.random.PCG64(_SEED)).integers(len(names), size=(RESAMPLINGS, len(names)))
    means = sums[drawn].sum(axis=1) / counts[drawn].sum(axis=1)
    low, high = np.quantile(means, [0.025, 0.975]).tolist()
    return LogScoreChange(float(changes.mean()), low, high)
