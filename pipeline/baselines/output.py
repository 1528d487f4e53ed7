"""The output of `symolo baselines`: a table, its numbers, a figure, and every estimate."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from pipeline.baselines.base import Method
from pipeline.baselines.compare import BaselineComparison
from pipeline.baselines.figure import figure
from pipeline.baselines.runs import TrueRun
from symolo.core.arrays import Array
from symolo.core.files.atomic_files import make_folder, write_file
from symolo.core.files.file_hashes import canonical_json
from symolo.core.files.new_folder import new_folder
from symolo.core.versions import versions
from symolo.dataset.tables.rows import csv_bytes, heading
from symolo.evaluation.errors import OVER_M, OVER_S, REGION_PROBABILITY
from symolo.evaluation.estimate import Estimate
from symolo.evaluation.estimate_file import BASELINE_HEADER, ENTRIES

TABLE, NUMBERS, FIGURE, ESTIMATES = "baselines.md", "baselines.json", "baselines.png", "estimates"

_ESTIMATE_DECIMALS = (0, 6, 6, 6, *[12] * len(ENTRIES))

_COLUMNS = (
    ("ATE [mm]", "ate_m", 1e3, 1),
    ("median [mm]", "median_m", 1e3, 1),
    ("worst [mm]", "worst_m", 1e3, 1),
    ("end [mm]", "end_m", 1e3, 1),
    ("ATE [deg]", "ate_rad", 180 / np.pi, 2),
    (f"RPE {OVER_S:g} s [mm]", "rpe_per_s_m", 1e3, 2),
    (f"RPE {OVER_M:g} m [mm]", "rpe_per_m_m", 1e3, 1),
    (f"RPE {OVER_M:g} m [deg]", "rpe_per_m_rad", 180 / np.pi, 2),
    ("NEES", "nees", 1.0, 2),
    (f"in {REGION_PROBABILITY:.0%}", "within", 1.0, 2),
    ("coverage [%]", "coverage", 100.0, 0),
)
_ABOUT = """\
Estimates are compared with the true poses; the included methods are not aligned, because they know the start. ATE is
the root mean square over all poses of a run, RPE that of the error of a movement over one second or one metre of the
path. RPE is "-" where no two poses are so far apart: one second to half a millisecond, which no two estimates every 150
ms are, or one metre to a tenth of it. NEES is divided by its degrees of freedom: 1 where the stated covariance is
consistent, more where the method is overconfident. "in 95%" is the share of poses whose truth lies in the method's own
95 % region. Coverage is the share of the seconds of a run in which there is an estimate.
"""


def write(compared: BaselineComparison, out: Path) -> None:
    """Write all files into a new or empty folder; after an error none of them is there."""
    files = {TABLE: table(compared).encode(), NUMBERS: numbers(compared), FIGURE: figure(compared)}
    for run in compared.runs:
        for method in compared.methods:
            estimate = compared.results[run.name, method.name].estimate
            files[f"{ESTIMATES}/{run.name}/{method.name}.csv"] = estimate_csv(run, estimate)
    with new_folder(out) as folder:
        for name, data in files.items():
            make_folder((folder / name).parent)
            write_file(folder / name, data)


def table(compared: BaselineComparison) -> str:
    """Return the table in Markdown: a row for each run and method, and for each method its median over the runs."""
    sd = compared.start_sd
    lines = ["# Localisation baselines", "", _ABOUT]
    accuracy = f"to {1e3 * sd[0]:g} mm and {np.degrees(sd[2]):.3g} deg (one standard deviation)"
    slip_mm = f"{1e3 * compared.slip_m_sqrt_m:g} mm"
    slip = f"Its wheels are assumed to slip by {slip_mm} at random after 1 m."
    if any(isinstance(method, Method) for method in compared.methods):
        lines += [f"The start pose of the robot is known {accuracy}. {slip}", ""]
    lines += [f"- {method.name}: {method.what}" for method in compared.methods]
    lines += [f"- {name}: left out, {why}" for name, why in compared.left_out.items()]
    lines += ["", compared.conditions] if compared.conditions else []
    lines += [line for warning in compared.warnings for line in ("", f"**Warning:** {warning}.")]
    lines += [
        "",
        "| run | method | " + " | ".join(head for head, *_ in _COLUMNS) + " |",
        "|---|---|" + "---:|" * len(_COLUMNS),
    ]
    for run in compared.runs:
        lines += [_row(run.name, method.name, [compared.results[run.name, method.name]]) for method in compared.methods]
    if len(compared.runs) > 1:
        for method in compared.methods:
            lines.append(
                _row("median", method.name, [compared.results[run.name, method.name] for run in compared.runs])
            )
    return "\n".join(lines) + "\n"


def _row(run: str, method: str, results: Sequence) -> str:
    cells = []
    for _, name, factor, digits in _COLUMNS:
        values = [getattr(result.errors, name) for result in results]
        known = [value for value in values if value is not None]
        cells.append(f"{factor * float(np.median(known)):.{digits}f}" if known else "-")
    return f"| {run} | {method} | " + " | ".join(cells) + " |"


def numbers(compared: BaselineComparison) -> bytes:
    """Return all errors by run and method as JSON, in SI units."""
    return canonical_json(
        {
            "definitions": " ".join(_ABOUT.split()),
            "left_out": dict(compared.left_out),
            "made_with": versions("symolo", "numpy", "scipy"),
            "methods": {method.name: method.what for method in compared.methods},
            "runs": {
                run.name: {
                    method.name: {
                        name: None if value is None else round(value, 6)
                        for name, value in asdict(compared.results[run.name, method.name].errors).items()
                    }
                    for method in compared.methods
                }
                for run in compared.runs
            },
            "seed": compared.seed,
            "slip_m_sqrt_m": compared.slip_m_sqrt_m,
            "start_sd": {"x_m": compared.start_sd[0], "y_m": compared.start_sd[1], "yaw_rad": compared.start_sd[2]},
            **({"own_estimates": compared.conditions} if compared.conditions else {}),
            **({"warnings": list(compared.warnings)} if compared.warnings else {}),
        }
    )


def estimate_csv(run: TrueRun, estimate: Estimate) -> bytes:
    """Return a CSV table: time [ms], x, y [m], theta [rad], and the upper triangle of a covariance that is stated."""
    yaw = heading(estimate.pose[:, 2], _ESTIMATE_DECIMALS[3])
    columns: list[Array] = [run.rows.t_ms[estimate.rows].astype(float), *estimate.pose[:, :2].T, yaw]
    if estimate.covariance is not None:
        columns += [estimate.covariance[:, i, j] for i, j in ENTRIES]
    count = len(columns)
    return csv_bytes(BASELINE_HEADER[:count], _ESTIMATE_DECIMALS[:count], np.column_stack(columns))
