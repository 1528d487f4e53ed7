"""The rows of a trajectory at which images are taken."""

from dataclasses import replace

import numpy as np

from configs.schema.scenario import RunSpec
from logs.times import usual_step
from pipeline.stages.run_tables import ExternalRun
from symolo.dataset.rates import IMAGE_HZ
from symolo.dataset.tables.camera_rows import image_column, main_camera_rows
from symolo.dataset.tables.rows import HEADER, Ints

MAX_EXCESS = 1.05
"""Rate of the images over that of the poses from which on images are missing, with a margin for uneven times."""
MAX_UNEVEN, MAX_UNEVEN_SHARE = 0.2, 0.1
"""Deviation of the time between two images from the period, relative to it, and share of larger ones, that get no
warning: the times of many logs are uneven, and some have gaps."""


def with_images(run: ExternalRun, camera_hz: float | None) -> ExternalRun:
    """Return a run with image numbers at `camera_hz`; by default its own, or those of 5 Hz if it has none.

    The images of a log are taken at its rows, the first one of each period. Those of a simulation are also between the
    rows if its rows do not come at a multiple of the rate.
    """
    rows, spec = run.rows, run.spec
    if camera_hz is None and np.any(rows.image > 0):
        return _counted(run)
    if isinstance(spec, RunSpec):
        rates = {"camera_hz": camera_hz or IMAGE_HZ}
        spec = spec.model_copy(update={"rates": spec.rates.model_copy(update=rates)})
        image = image_column(rows.t_ms, spec.rates)
    else:
        image = image_numbers(rows.t_ms, camera_hz or IMAGE_HZ)
        if camera_hz is not None:
            run = _with_warning(run, image, camera_hz)
    columns = tuple(name for name in HEADER if name in {*rows.columns, "img"})
    return _counted(replace(run, rows=replace(rows, image=image, columns=columns), spec=spec))


def _with_warning(run: ExternalRun, image: Ints, camera_hz: float) -> ExternalRun:
    """Return a run with a warning if the rows of its log are too few for its images, or not at their times."""
    steps_ms = np.diff(run.rows.t_ms)
    poses_hz = 1000.0 / usual_step(steps_ms) if len(steps_ms) else camera_hz
    if camera_hz > MAX_EXCESS * poses_hz:
        text = (
            f"the images are to be taken at {camera_hz:g} Hz, but the log usually has {poses_hz:.3g} poses a second,"
            " and each image is at a pose"
        )
    elif uneven := _uneven_times(run.rows.t_ms[image > 0], camera_hz):
        text = f"each image is at a pose of the log, which usually has {poses_hz:.3g} poses a second: {uneven}"
    else:
        return run
    text += f": import the log with --row-hz {camera_hz:g}"
    return replace(run, outcome=run.outcome.model_copy(update={"suspicions": (*run.outcome.suspicions, text)}))


def _uneven_times(t_ms: Ints, camera_hz: float) -> str:
    """Return what is uneven in the times of the images; empty if at most few of them are far from a period apart."""
    period_ms, steps_ms = 1000.0 / camera_hz, np.diff(t_ms)
    if not len(steps_ms) or np.mean(np.abs(steps_ms - period_ms) > MAX_UNEVEN * period_ms) <= MAX_UNEVEN_SHARE:
        return ""
    low, high = np.percentile(steps_ms, (5, 95), method="nearest")
    return f"the images are {low} to {high} ms apart, and not {period_ms:.3g} ms ({camera_hz:g} Hz)"


def _counted(run: ExternalRun) -> ExternalRun:
    rates = run.spec.rates if isinstance(run.spec, RunSpec) else None
    images = len(main_camera_rows(run.rows, rates).t_ms)
    outcome = run.outcome.model_copy(update={"images": images})
    return replace(run, outcome=outcome)


def image_numbers(t_ms: Ints, camera_hz: float) -> Ints:
    """Return (N,): 1, 2, 3... at the first row of every camera period since the first row, 0 elsewhere.

    The times are rounded to milliseconds, so a row belongs to a period that begins up to half a millisecond after it.
    """
    period = np.floor((t_ms - t_ms[0] + 0.5) * camera_hz / 1000 + 1e-9)
    first = np.concatenate(([True], np.diff(period) > 0))
    return np.where(first, np.cumsum(first), 0)
