"""The diagnosis of real robots: fitted on one part of each set and judged on another.

    python benchmarks/diagnosis/recordings/real_sets.py --measured DIR --out DIR
        [--only drives,sessions,motors,range,table-1]

DIR of --measured holds the sets that docs/diagnosis_evaluation.md names. The output is real_sets.md with all tables,
drives.json with every run, and plots. One core needs some ten minutes, most of it for the drives.
"""

import argparse
import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
from real_benches import BenchResult, motors, range_sensor_at_rest
from real_drives import METHODS, Fitted, Missed, fitted_drives, left_out_sessions
from real_plots import by_session, one_robot
from table_1 import plot as plot_table_1
from table_1 import table_1

PARTS = ("table-1", "range", "motors", "sessions", "drives")
FOLDERS = {
    "range": "tof_vl53l0x_static/static_tof_dist_data_1_h.csv",
    "motors": "opatiny_micromouse",
    "sessions": "optiodom_diff",
    "drives": "optiodom_diff",
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--measured", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--only", default=",".join(PARTS))
    arguments = parser.parse_args()
    parts = arguments.only.split(",")
    if unknown := [part for part in parts if part not in PARTS]:
        parser.error(f"--only: got {unknown[0]}, allowed: {', '.join(PARTS)}")
    if missing := [FOLDERS[p] for p in parts if p in FOLDERS and not (arguments.measured / FOLDERS[p]).exists()]:
        parser.error(f"--measured: there is no {missing[0]} in {arguments.measured}")
    arguments.out.mkdir(parents=True, exist_ok=True)
    makers: dict[str, Callable[[], str]] = {
        "table-1": lambda: _table_1(arguments.out),
        "range": lambda: "\n".join(bench_table([range_sensor_at_rest(arguments.measured / FOLDERS["range"])])),
        "motors": lambda: "\n".join(bench_table(motors(arguments.measured / FOLDERS["motors"]))),
        "sessions": lambda: _sessions(arguments.measured / FOLDERS["sessions"]),
        "drives": lambda: _drives(arguments.measured / FOLDERS["drives"], arguments.out),
    }
    text = ""
    for part in PARTS:
        if part in parts:
            section = f"## {part}\n\n{makers[part]()}\n\n"
            print(section, flush=True)
            text += section
    (arguments.out / "real_sets.md").write_text(text, encoding="utf-8")


def _table_1(out: Path) -> str:
    plot_table_1(out / "table_1.png")
    return table_1()


def _drives(folder: Path, out: Path) -> str:
    results = []
    for fitted in fitted_drives(folder):
        results.append(fitted)
        print(f"{fitted.name}: {fitted.fitted_runs} runs fitted", flush=True)
    (out / "drives.json").write_text(json.dumps([asdict(fitted) for fitted in results], indent=1), encoding="utf-8")
    by_session(results, out / "drives_by_session.png")
    one_robot(results[-1], out / "drives_one_robot.png")
    return "\n".join([*drive_table(results), "", *fit_table(results)])


def _sessions(folder: Path) -> str:
    """Return the table of sessions that are left out, with a line for all of them together."""
    results = list(left_out_sessions(folder))
    missed_in_all: dict[str, list[Missed]] = {}
    for fitted in results:
        for method, missed in fitted.missed["left out"].items():
            missed_in_all.setdefault(method, []).extend(missed)
    together = replace(
        results[-1], name="all sessions", missed={"left out": {m: tuple(e) for m, e in missed_in_all.items()}}
    )
    return "\n".join(drive_table([*results, together]))


def rms(missed: Sequence[Missed]) -> tuple[float, float, float]:
    """Return the errors of the ends of runs: place [mm], heading [mrad], and place over length [mm/m]."""
    place, heading, length = (np.array([getattr(m, n) for m in missed]) for n in ("place_m", "heading_rad", "length_m"))
    long = length > 0.5
    per_m = 1e3 * float(np.sqrt(np.mean((place[long] / length[long]) ** 2))) if long.any() else float("nan")
    return 1e3 * float(np.sqrt(np.mean(place**2))), 1e3 * float(np.sqrt(np.mean(heading**2))), per_m


def drive_table(results: Sequence[Fitted]) -> list[str]:
    """Return a table with a row for each fit and each set of runs on which it is judged."""
    lines = [f"| fitted on | judged on | runs | {' | '.join(METHODS)} |", f"|---|---|---|{'---|' * len(METHODS)}"]
    for fitted in results:
        for judged, by in fitted.missed.items():
            cells = []
            for method in METHODS:
                place, heading, per_m = rms(by[method]) if method in by else (np.nan, np.nan, np.nan)
                cell = f"{place:.1f} mm, {heading:.0f} mrad" + (f" ({per_m:.1f} mm/m)" if np.isfinite(per_m) else "")
                cells.append(cell if method in by else "-")
            lines.append(f"| {fitted.name} | {judged} | {len(by['nominal'])} | {' | '.join(cells)} |")
    return lines


def fit_table(results: Sequence[Fitted]) -> list[str]:
    """Return a table of the effects that each fit named, their numbers, and what it could not name."""
    lines = ["| fitted on | named | fitted within tolerance | given up | unexplained | windows held out [sigma] |"]
    lines.append("|---|---|---|---|---|---|")
    for f in results:
        cells = ("; ".join(texts) or "-" for texts in (f.named, f.numbers, f.withdrawn, f.unexplained))
        lines.append(f"| {f.name} | {' | '.join(cells)} | {f.windows} |")
    return lines


def bench_table(results: Iterable[BenchResult]) -> list[str]:
    """Return a table of what was named, and of the errors before and after."""
    lines = ["| fitted on | judged on | rows | nominal | calibrated | extended |", "|---|---|---|---|---|---|"]
    notes = []
    for result in results:
        lines += [
            f"| {result.name} | {j.on} | {j.rows} | {j.nominal:.2f} | {j.calibrated:.2f} | {j.extended:.2f} |"
            for j in result.judged
        ]
        notes.append(
            f"{result.name}: named {'; '.join(result.named) or 'nothing'}; "
            f"given up {', '.join(result.withdrawn) or 'nothing'}; "
            f"unexplained {'; '.join(result.unexplained) or 'nothing'}"
            f"{''.join(f'; {text}' for text in result.impossible)}"
        )
    return [*lines, "", *notes]


if __name__ == "__main__":
    main()
