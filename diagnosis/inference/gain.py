"""How much better the extended model predicts rows that it has not seen.

The error of a stage is the root mean square of its standardised residuals, by the nominal noise, without the largest
3 %; that of several stages their root mean square. The gain is 1 - extended/nominal (GAP_FORMAT). Its interval is that
of the bootstrap over trials, or over blocks of rows where there are few trials, for rows of a trial share their fate
(Kuensch, Ann. Statist. 17 (1989) 1217-1241).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from diagnosis.inference.evidence import Evidence
from diagnosis.measured.channel import Array

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
    rows = evidence.heldout
    if not rows.any():
        return None
    prediction = evidence.of([nominal, extended])
    z = np.abs((evidence.values - prediction.mean) / evidence.sd)
    stages = [rows & (evidence.of_stage == k) for k in range(len(evidence.stages))]
    parts = [z[:, stage] for stage in stages if stage.any()]
    blocks = [_blocks(evidence)[stage] for stage in stages if stage.any()]
    before, after = _error([p[0] for p in parts]), _error([p[1] for p in parts])
    generator = np.random.Generator(np.random.PCG64(_SEED))
    drawn = []
    for _ in range(RESAMPLED):
        taken = [_resampled(of, generator) for of in blocks]
        was, has = (_error([p[k][t] for p, t in zip(parts, taken, strict=True)]) for k in (0, 1))
        drawn.append(1.0 - has / was if was > 0.0 else 0.0)
    low, high = np.quantile(drawn, [0.025, 0.975]).tolist()
    by_quantity = []
    for quantity, place in zip(evidence.observed, evidence.places, strict=True):
        of = z[:, place][:, rows[place]]
        if of.shape[1]:
            by_quantity.append((quantity.name, _error([of[0]]), _error([of[1]])))
    return Gain(1.0 - after / before if before > 0.0 else 0.0, low, high, before, after, tuple(by_quantity))


def _error(parts: Sequence[Array]) -> float:
    return float(np.sqrt(np.mean([_trimmed(part) ** 2 for part in parts])))


def _trimmed(size: Array) -> float:
    kept = np.sort(size)[: max(1, int(np.floor(KEPT * len(size))))]
    return float(np.sqrt(np.mean(kept**2)))


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


def _resampled(blocks: NDArray[np.int64], generator: np.random.Generator) -> NDArray[np.int64]:
    """Indices of rows of as many blocks, drawn with replacement."""
    order = np.argsort(blocks, kind="stable")
    _, starts = np.unique(blocks[order], return_index=True)
    groups = np.split(order, starts[1:])
    return np.concatenate([groups[k] for k in generator.integers(len(groups), size=len(groups)).tolist()])
