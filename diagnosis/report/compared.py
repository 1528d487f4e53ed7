"""What was compared: source, rows, rates, and each observed quantity with its noise."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from diagnosis.diagnose import Diagnosis
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.measured.measurement import Measurement
from diagnosis.measured.screening import timing
from symolo.pages.markup import Html, table, tag

NAMED_FILES = 4


def compared(diagnosis: Diagnosis) -> Iterator[Html]:
    """Paragraphs and a table."""
    measurement, evidence = diagnosis.measurement, diagnosis.evidence
    source = measurement.source
    licence = f" ({source.licence})" if source.licence else ""
    yield tag("p", f"Measured: {source.origin}{licence}{_files(source.files)}. {_rates(measurement)}")
    stages = ", ".join(stage.name for stage in evidence.stages)
    driven = "each driven by what was measured at its input"
    yield tag("p", f"Predicted by the simulator's own models, stage by stage ({stages}), {driven}.")
    head = ["quantity", "unit", "stage", "rows fitted", "rows held out", "not usable", "noise, standard deviation"]
    yield table([*head, "its correlation"], _rows(evidence))
    if measurement.notes:
        yield tag("ul", [tag("li", note) for note in measurement.notes], class_="note")


def _files(files: tuple[str, ...]) -> str:
    if not files:
        return ""
    names = [Path(file).name for file in files[:NAMED_FILES]]
    more = f" and {len(files) - NAMED_FILES} more" if len(files) > NAMED_FILES else ""
    return f", from {', '.join(names)}{more}"


def _rates(measurement: Measurement) -> str:
    found = [timing(trial.t_s) for trial in measurement.trials if trial.is_timed]
    rates = [of.rate_hz for of in found if of is not None]
    if not rates:
        return "Nobody noted the times of its rows."
    rate = float(np.median(rates))
    return f"{rate:.3g} rows a second." if rate >= 1.0 else f"A row every {1.0 / rate:.3g} s."


def _rows(evidence: Evidence) -> Iterator[list[str]]:
    stages = [stage.name for stage in evidence.stages for _ in stage.observed]
    each = zip(evidence.observed, evidence.places, stages, evidence.correlations, strict=True)
    for of, place, stage, correlation in each:
        fitted, held = np.count_nonzero(evidence.fit[place]), np.count_nonzero(evidence.heldout[place])
        left_out = len(of.values) - fitted - held
        sd = evidence.sd[place][of.usable]
        noise = "-"
        if len(sd):
            low, high = float(sd.min()), float(sd.max())
            noise = f"{low:.3g}" if high - low < 1e-3 * high else f"{low:.3g} to {high:.3g}"
        yield [of.name, of.unit, stage, f"{fitted}", f"{held}", f"{left_out}", noise, f"{correlation:.2g}"]
