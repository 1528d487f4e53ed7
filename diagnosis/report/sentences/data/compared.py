"""The measured data of a diagnosis in words: source, rates, and each observed quantity with its noise."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.gain import KEPT_SHARE, left_out
from diagnosis.inference.unexplained.adequacy import LEVEL, Structure
from diagnosis.measured.measurement import Measurement
from diagnosis.measured.screening import timing
from diagnosis.report.sentences.quantities import along, listed, percent

_MAX_FILES = 4


def source_text(measurement: Measurement) -> str:
    """Return origin, licence, files and rate of a measurement."""
    source = measurement.source
    licence = f" ({source.licence})" if source.licence else ""
    names = list(dict.fromkeys(Path(file).name for file in source.files))
    more = f" and {len(names) - _MAX_FILES} more" if len(names) > _MAX_FILES else ""
    files = f", from {', '.join(names[:_MAX_FILES])}{more}" if names else ""
    return f"Data: {source.origin}{licence}{files}. {_rate(measurement)}"


def _rate(measurement: Measurement) -> str:
    timings = [timing(trial.t_s) for trial in measurement.trials if trial.is_timed]
    rates = [known.rate_hz for known in timings if known is not None]
    if not rates:
        return "The times of the rows are not known."
    rate = float(np.median(rates))
    return f"{rate:.3g} rows per second." if rate > 1.0 else f"One row every {1.0 / rate:.3g} s."


def rows_sentence(measurement: Measurement, evidence: Evidence) -> str:
    """Return how the samples of each quantity follow from the rows of the log, and why some of them are unusable."""
    rows = sum(len(trial.t_s) for trial in measurement.trials)
    names: dict[tuple[int, str], list[str]] = {}
    for observed in evidence.observed:
        names.setdefault((len(observed.values), observed.samples), []).append(observed.name)
    parts = [f"{count} {samples} of {listed(quantities)}" for (count, samples), quantities in names.items()]
    return (
        f"Of the {rows} rows of the log, the table counts {'; '.join(parts)}. Each of them is fitted, held out, or "
        "unusable. It is unusable where the quantity or an input of its prediction has no good value. It is also "
        "unusable where the prediction is ambiguous, such as near an edge or at the voltage at which a motor starts, "
        "or where the prediction is the same for any robot, such as without a voltage."
    )


def quantity_rows(evidence: Evidence) -> Iterator[tuple[str, ...]]:
    """Yield the table of observed quantities with their numbers of rows and their noise."""
    stages = [stage.name for stage in evidence.stages for _ in stage.observed]
    columns = zip(evidence.observed, evidence.places, stages, evidence.correlations, strict=True)
    for observed, place, stage, correlation in columns:
        fitted, heldout = np.count_nonzero(evidence.fit[place]), np.count_nonzero(evidence.heldout[place])
        unusable = len(observed.values) - fitted - heldout
        sd = evidence.sd[place][observed.usable]
        noise = "-"
        if len(sd):
            low, high = float(sd.min()), float(sd.max())
            noise = f"{low:.3g}" if high - low < 1e-3 * high else f"{low:.3g} to {high:.3g}"
        counts = (f"{fitted}", f"{heldout}", f"{unusable}")
        yield observed.name, observed.unit, stage, *counts, noise, f"{correlation:.2g}"


def misfit_caption(observed: str, structure: Structure | None, unexplained: Structure | None) -> str:
    """Return what the misfit plot of a quantity shows.

    Args:
        observed: Name of the quantity.
        structure: The structure along whose covariate it is drawn; None if there is none.
        unexplained: The structure that the verdict reports; None if there is none.
    """
    if structure is None:
        return f"{observed}."
    text = f"{observed} along {along(structure.covariate)}"
    if structure is unexplained:
        return f"{text}, where the residuals have the structure that no effect explains."
    if structure.p < LEVEL:
        return f"{text}, where the residuals of the nominal robot with fitted parameters show most structure."
    return f"{text}."


def left_out_sentence(evidence: Evidence) -> str:
    """Return what the errors on held-out rows are, and how many of the largest residuals they leave out; empty if no
    row is held out.
    """
    rows = [int(np.count_nonzero(evidence.heldout[place])) for place in evidence.places]
    count, values = sum(map(left_out, rows)), sum(rows)
    if not values:
        return ""
    return (
        "Each error is the root mean square of the residuals on held-out rows, in standard deviations of the noise. "
        f"The largest {percent(1.0 - KEPT_SHARE)} of each quantity are left out, rounded up: here {count} of {values} "
        f"values ({percent(count / values)})."
    )
