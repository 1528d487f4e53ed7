"""What a random drift of a sensor carries over from other rows to a row.

The error of a row is partly known from the rows before it: a first-order Gauss-Markov error is remembered for its time
constant. The likelihood of all rows is the product of those of each row, given the rows before it (prediction error
decomposition: Harvey, Forecasting, Structural Time Series Models and the Kalman Filter, 1989, section 3.4). So a fit
beside a drift compares each reading with its prediction plus what the residuals before it say, and its noise includes
what they leave open.
"""

from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array


@dataclass(frozen=True, eq=False)
class DriftMemory:
    """What a drift carries over to each of N samples."""

    shares: Array
    """(N, N), by which the residual of each sample moves the prediction of another one."""
    wider: Array
    """(N,), factor on the standard deviation of the noise, because of the error that the residuals do not determine."""
    reference: Array
    """(N,), predictions of the fit to which the drift belongs; 0 where there are none."""

    def carried(self, values: Array) -> Array:
        """Return what the residuals of values (..., N) against the reference say about each sample."""
        known = np.abs(self.shares).sum(axis=0) > 0.0
        return (values[..., known] - self.reference[known]) @ self.shares[:, known].T
