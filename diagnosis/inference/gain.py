"""How much better the extended model predicts rows that it has not seen.

The error of a stage is the root mean square of its standardised residuals, by the nominal noise, without the largest
3 %; that of several stages their root mean square. The gain is 1 - extended/nominal (GAP_FORMAT). Its interval is that
of the bootstrap over trials, or over blocks of rows where there are few trials, for rows of a trial share their fate
(Kuensch, Ann. Statist. 17 (1989) 1217-1241).
"""

import copy
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from diagnosis.inference.evidence.evidence import Evidence
from symolo.core.arrays import Array

KEPT = 0.97
TRIALS = 5
"""From which trials are drawn whole."""
BLOCK_S = 2.0
BLOCK_ROWS = 10
RESAMPLED = 400
_SEED = 20_26


@dataclass(frozen=True)
class Gain:
    value: float
    low: float
    high: float
    """Of the 95 % interval."""
    before: float
    after: float
    """Errors in sigmas."""
    by_quantity: tuple[tuple[str, float, float], ...]
    """Name, error before, error after."""


def gain(evidence: Evidence, nominal: RobotConfig, extended: RobotConfig) -> Gain | None:
    """On the held-out rows; None where there are none."""
    return gain_of(evidence, evidence.of([nominal, extended]).mean) if evidence.heldout.any() else None


def gain_of(evidence: Evidence, mean: Array) -> Gain | None:
    """The same of what both robots predict, (2, N)."""
    rows = evidence.heldout
    if not rows.any():
        return None
    z = np.abs((evidence.values - mean) / evidence.sd)
    stages = [rows & (evidence.of_stage == k) for k in range(len(evidence.stages))]
    of_stages = [(z[:, stage], _blocks(evidence)[stage]) for stage in stages if stage.any()]
    by_quantity = []
    for quantity, place in zip(evidence.observed, evidence.places, strict=True):
        of = z[:, place][:, rows[place]]
        if of.shape[1]:
            by_quantity.append((quantity.name, _error([of[0]]), _error([of[1]])))
    return gain_of_sizes(of_stages, tuple(by_quantity))


def gain_of_sizes(
    stages: Sequence[tuple[Array, NDArray[np.int64]]], by_quantity: tuple[tuple[str, float, float], ...] = ()
) -> Gain:
    """Return the gain over several stages.

    Args:
        stages: For each stage the sizes of the residuals before and after, (2, n), and the block of each row, (n,).
        by_quantity: What the gain says of each quantity.
    """
    before, after = (_error([sizes[k] for sizes, _ in stages]) for k in (0, 1))
    generator = np.random.Generator(np.random.PCG64(_SEED))
    squares = [_redrawn_squares(sizes, blocks, generator) for sizes, blocks in stages]
    was, has = np.sqrt(np.mean(squares, axis=0))
    drawn = 1.0 - np.divide(has, was, out=np.ones_like(was), where=was > 0.0)
    low, high = np.quantile(drawn, [0.025, 0.975]).tolist()
    return Gain(1.0 - after / before if before > 0.0 else 0.0, low, high, before, after, by_quantity)


def of_quantity(evidence: Evidence, place: slice) -> Evidence:
    """The same evidence, of which the held-out rows of one observed quantity alone count."""
    found = copy.copy(evidence)
    found.heldout = np.zeros_like(evidence.heldout)
    found.heldout[place] = evidence.heldout[place]
    return found


def _error(parts: Sequence[Array]) -> float:
    return float(np.sqrt(np.mean([trimmed_rms(part) ** 2 for part in parts])))


def trimmed_rms(size: Array) -> float:
    """Root mean square of sizes (n,), without the largest 3 %."""
    kept = np.sort(size)[: _kept(len(size))]
    return float(np.sqrt(np.mean(kept**2)))


def _kept(rows: int) -> int:
    return max(1, int(np.floor(KEPT * rows)))


def _blocks(evidence: Evidence) -> NDArray[np.int64]:
    """(N,), a number for each trial, or for each block of rows of one."""
    heldout = len(np.unique(evidence.trial[evidence.heldout]))
    if heldout >= TRIALS:
        return evidence.trial
    t_s = np.concatenate([of.t_s for of in evidence.observed])
    steps = np.diff(t_s)
    usual = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 1.0
    length_s = max(BLOCK_S, BLOCK_ROWS * usual) if usual < BLOCK_S else BLOCK_ROWS * usual
    blocks = evidence.trial * 1_000_000 + np.floor(t_s / length_s).astype(np.int64)
    few = len(np.unique(blocks[evidence.heldout])) < TRIALS
    return np.arange(len(blocks)) if few else blocks


def _redrawn_squares(sizes: Array, blocks: NDArray[np.int64], generator: np.random.Generator) -> Array:
    """(2, RESAMPLED): trimmed mean squares of as many blocks of rows, drawn with replacement.

    Args:
        sizes: (2, n), of the residuals by either robot.
        blocks: (n,), which block a row is of.
        generator: Of the draws.
    """
    names, block_of = np.unique(blocks, return_inverse=True)
    orders = np.argsort(sizes, axis=1, kind="stable")
    found = np.empty((2, RESAMPLED))
    for k in range(RESAMPLED):
        times_drawn = np.bincount(generator.integers(len(names), size=len(names)), minlength=len(names))[block_of]
        kept = _kept(int(times_drawn.sum()))
        for of_robot, (size, order) in enumerate(zip(sizes, orders, strict=True)):
            times = times_drawn[order]
            within = np.clip(kept - (np.cumsum(times) - times), 0, times)
            found[of_robot, k] = within @ size[order] ** 2 / kept
    return found
