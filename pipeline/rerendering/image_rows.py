"""The rows of a trajectory at which images are taken."""

from dataclasses import replace

import numpy as np

from configs.schema.scenario import RunSpec
from pipeline.stages.run_tables import TakenRun
from symolo.core.errors import InputError
from symolo.dataset.tables.rows import HEADER, Ints

DEFAULT_HZ = 5.0
"""Image rate of a trajectory without images, as in SyMoLo."""


def with_images(run: TakenRun, camera_hz: float | None) -> TakenRun:
    """Return a run with image numbers at `camera_hz`; by default its own, or those of 5 Hz if it has none.

    Raises:
        InputError: The rows of a simulation do not come at a multiple of this rate.
    """
    rows, spec = run.rows, run.spec
    if camera_hz is None and np.any(rows.image > 0):
        return _counted(run)
    if camera_hz is not None and isinstance(spec, RunSpec):
        row_hz = spec.rates.control_hz
        if not (row_hz / camera_hz).is_integer() or not float(camera_hz).is_integer():
            rates = ", ".join(str(hz) for hz in range(row_hz, 0, -1) if row_hz % hz == 0)
            cure = "for a few images, use `symolo preview -n N`"
            if camera_hz >= 1 and float(camera_hz).is_integer():
                cure = f"for other rates, simulate again with --set rates.camera_hz={camera_hz:g}"
            raise InputError("--camera-hz", got=camera_hz, allowed=rates, cure=cure)
        spec = spec.model_copy(update={"rates": spec.rates.model_copy(update={"camera_hz": int(camera_hz)})})
    image = image_numbers(rows.t_ms, camera_hz or DEFAULT_HZ)
    columns = tuple(name for name in HEADER if name in {*rows.columns, "img"})
    return _counted(replace(run, rows=replace(rows, image=image, columns=columns), spec=spec))


def _counted(run: TakenRun) -> TakenRun:
    outcome = run.outcome.model_copy(update={"images": int(np.count_nonzero(run.rows.image))})
    return replace(run, outcome=outcome)


def image_numbers(t_ms: Ints, camera_hz: float) -> Ints:
    """Return (N,): 1, 2, 3... at the first row of every camera period since the first row, 0 elsewhere."""
    period = np.floor((t_ms - t_ms[0]) * camera_hz / 1000 + 1e-9)
    first = np.concatenate(([True], np.diff(period) > 0))
    return np.where(first, np.cumsum(first), 0)
