"""The gain: how much better the extended model predicts held-out rows.

The error of a stage is the root mean square of its residuals in standard deviations of the nominal noise, without the
largest 3 %; the error of several stages is the root mean square of theirs. The gain is 1 - extended/nominal
(GAP_FORMAT). Its interval comes from a bootstrap over trials, or over blocks of rows if there are few trials, since the
rows of a trial are not independent (Kuensch, Ann. Statist. 17 (1989) 1217-1241).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from diagnosis.inference.evidence.evidence import Evidence
from symolo.core.arrays import Array

KEPT_SHARE = 0.97
"""Share of the residuals, the smallest ones, that count."""
MIN_TRIALS = 5
"""Number of held-out trials from which whole trials are drawn."""
BLOCK_S = 2.0
BLOCK_ROWS = 10
RESAMPLINGS = 400
CACHED_NUMBERS = 2**15
"""Numbers of an array that fits into the cache of a processor; larger ones take longer for each number."""
_SEED = 20_26


@dataclass(frozen=True)
class Gain:
    """Gain of one model over another."""

    value: float
    low: float
    """Lower end of the 95 % interval."""
    high: float
    """Upper end of the 95 % interval."""
    before: float
    """Error of the first model in sigmas."""
    after: float
    """Error of the second model in sigmas."""
    by_quantity: tuple[tuple[str, float, float], ...]
    """Name, error before and error after of each observed quantity."""

    @property
    def is_unchanged(self) -> bool:
        """Whether both models predict the same, because no parameter differs."""
        return self.value == self.low == self.high == 0.0


def gain(
    evidence: Evidence,
    nominal: RobotConfig,
    extended: RobotConfig,
    changes: tuple[Array | float, Array | float] = (0.0, 0.0),
) -> Gain | None:
    """Return the gain on the held-out rows; None if there are none.

    Args:
        evidence: The observations.
        nominal: The robot of the first model.
        extended: The robot of the second model.
        changes: (N,) each, what each model adds to the prediction by its robot, such as the errors of a session.
    """
    if not evidence.heldout.any():
        return None
    evidence = evidence.as_measured()
    prediction = evidence.predicted([nominal, extended])
    both = [prediction.some([k]).moved(change).mean for k, change in enumerate(changes)]
    return gain_of(evidence, np.concatenate(both))


def gain_of(evidence: Evidence, mean: Array) -> Gain | None:
    """Return the gain of the second of two predictions (2, N) over the first; None if no rows are held out."""
    rows = evidence.heldout
    if not rows.any():
        return None
    z = np.abs((evidence.values - mean) / evidence.sd)
    stages = [rows & (evidence.stage_index == k) for k in range(len(evidence.stages))]
    block = row_blocks(evidence)
    parts = [(z[:, stage], block[stage]) for stage in stages if stage.any()]
    by_quantity = []
    for quantity, place in zip(evidence.observed, evidence.places, strict=True):
        sizes = z[:, place][:, rows[place]]
        if sizes.shape[1]:
            by_quantity.append((quantity.name, trimmed_rms(sizes[0]), trimmed_rms(sizes[1])))
    return gain_of_sizes(parts, tuple(by_quantity))


def gain_of_sizes(
    parts: Sequence[tuple[Array, NDArray[np.int64]]], by_quantity: tuple[tuple[str, float, float], ...] = ()
) -> Gain:
    """Return the gain over several stages.

    Args:
        parts: For each stage the sizes of the residuals before and after, (2, n), and the block of each row, (n,).
        by_quantity: Name, error before and error after of each quantity.
    """
    before, after = (_error([sizes[k] for sizes, _ in parts]) for k in (0, 1))
    generator = np.random.Generator(np.random.PCG64(_SEED))
    squares = [_redrawn_squares(sizes, blocks, generator) for sizes, blocks in parts]
    errors, extended = np.sqrt(np.mean(squares, axis=0))
    gains = 1.0 - np.divide(extended, errors, out=np.ones_like(errors), where=errors > 0.0)
    low, high = np.quantile(gains, [0.025, 0.975]).tolist()
    return Gain(1.0 - after / before if before > 0.0 else 0.0, low, high, before, after, by_quantity)


def evidence_of_quantity(evidence: Evidence, place: slice) -> Evidence:
    """Return the same evidence with the held-out rows of one observed quantity only."""
    heldout = np.zeros_like(evidence.heldout)
    heldout[place] = evidence.heldout[place]
    return evidence.with_rows(heldout=heldout)


def _error(parts: Sequence[Array]) -> float:
    return float(np.sqrt(np.mean([trimmed_rms(part) ** 2 for part in parts])))


def trimmed_rms(size: Array) -> float:
    """Return the root mean square of sizes (n,) without the largest 3 %."""
    smallest = np.sort(size)[: _count(len(size))]
    return float(np.sqrt(np.mean(smallest**2)))


def left_out(rows: int) -> int:
    """Return the number of the largest residuals of some rows that an error leaves out: 3 %, rounded up."""
    return rows - _count(rows) if rows else 0


def _count(rows: int) -> int:
    return max(1, int(np.floor(KEPT_SHARE * rows)))


def row_blocks(evidence: Evidence) -> NDArray[np.int64]:
    """Return the number of the trial of each sample, or of its block of rows, (N,), from which a bootstrap draws."""
    heldout = len(np.unique(evidence.trial[evidence.heldout]))
    if heldout >= MIN_TRIALS:
        return evidence.trial
    t_s = np.concatenate([observed.t_s for observed in evidence.observed])
    steps = np.diff(t_s)
    usual = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 1.0
    length_s = max(BLOCK_S, BLOCK_ROWS * usual)
    blocks = evidence.trial * 1_000_000 + np.floor(t_s / length_s).astype(np.int64)
    # With so few blocks a bootstrap over them has no spread, and single rows are drawn.
    few = len(np.unique(blocks[evidence.heldout])) < MIN_TRIALS
    return np.arange(len(blocks)) if few else blocks


def _redrawn_squares(sizes: Array, blocks: NDArray[np.int64], generator: np.random.Generator) -> Array:
    """Return trimmed mean squares (2, RESAMPLINGS) of as many blocks of rows, drawn with replacement.

    Args:
        sizes: (2, n), absolute residuals of both models.
        blocks: (n,), block of each row.
        generator: Random numbers of the draws.
    """
    names, block_of = np.unique(blocks, return_inverse=True)
    drawn = generator.integers(len(names), size=(RESAMPLINGS, len(names)))
    times_drawn = np.stack([np.bincount(draw, minlength=len(names)) for draw in drawn])
    counts = np.array([_count(rows) for rows in (times_drawn @ np.bincount(block_of)).tolist()])
    at_once = max(1, CACHED_NUMBERS // max(1, len(block_of)))
    squares = np.empty((2, RESAMPLINGS))
    for model, order in enumerate(np.argsort(sizes, axis=1, kind="stable")):
        square, block = sizes[model, order] ** 2, block_of[order]
        for first in range(0, RESAMPLINGS, at_once):
            some = slice(first, first + at_once)
            # A row that was drawn several times counts as often, up to the number of rows that count.
            rows_until = np.minimum(np.cumsum(times_drawn[some][:, block], axis=1), counts[some, None])
            squares[model, some] = [times @ square for times in np.diff(rows_until, axis=1, prepend=0)]
    return squares / counts
