"""Many laps in one batch: how many finish, what goes wrong in the rest, and whether memory stays flat.

Runs `symolo simulate` on a scenario with so many runs, spread evenly over its routes, and watches the memory of the
command and of its workers while it works. Give an --out to keep the runs; the same command again continues.

    python benchmarks/laps/many_laps.py [--scenario symolo] [--set robot=fleet] [--laps 500] [--workers 2] [--out DIR]
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from statistics import mean, median

from configs.loader import load_scenario

SAMPLE_S = 2.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenario", default="symolo")
    parser.add_argument("--set", action="append", default=[], metavar="FIELD=VALUE")
    parser.add_argument("--laps", type=int, default=500)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        out = arguments.out or Path(scratch) / "laps"
        routes = load_scenario(arguments.scenario).routes
        share, more = divmod(arguments.laps, len(routes))
        settings = [*arguments.set, *(f"routes.{i}.runs={share + (i < more)}" for i in range(len(routes)))]
        command = [str(Path(sys.executable).with_name("symolo")), "simulate", arguments.scenario, "--out", str(out)]
        command += ["--workers", str(arguments.workers), *(f"--set={setting}" for setting in settings)]
        begin = time.monotonic()
        command_MB, worker_MB = watched(command)
        seconds = time.monotonic() - begin
        report(out, arguments.laps, seconds)
        report_memory(command_MB, worker_MB)


def watched(command: list[str]) -> tuple[list[float], list[float]]:
    """Run a command to its end; resident memory [MB] of it and of its largest child, every `SAMPLE_S`."""
    command_MB, worker_MB = [], []
    process = subprocess.Popen(command)
    while process.poll() is None:
        tasks = Path(f"/proc/{process.pid}/task").glob("*/children")
        children = [_resident_MB(int(pid)) for task in tasks for pid in _read(task).split()]
        command_MB.append(_resident_MB(process.pid))
        worker_MB.append(max(children, default=0.0))
        time.sleep(SAMPLE_S)
    if process.returncode not in {0, 3}:  # 3: some runs failed, which is what is counted here
        raise SystemExit(process.returncode)
    return command_MB, worker_MB


def report(out: Path, laps: int, seconds: float) -> None:
    outcomes = {
        path.parent: json.loads(path.read_text()) for path in sorted(out.glob(".stages/simulate/*/*/outcome.json"))
    }
    good = [outcome for outcome in outcomes.values() if not outcome["problems"]]
    print(f"{len(good)} of {laps} laps finished without touching anything, {60.0 * laps / seconds:.0f} laps a minute")
    if good:
        times = [outcome["lap_time_s"] for outcome in good]
        print(f"lap times {min(times):.1f} to {max(times):.1f} s, median {median(times):.1f} s")
    kinds = Counter(_kind(text) for outcome in outcomes.values() for text in outcome["problems"])
    for kind, count in kinds.most_common():
        print(f"{count:5d}  {kind}")
    for folder, outcome in outcomes.items():
        for text in outcome["problems"]:
            print(f"       {folder.relative_to(out / '.stages/simulate')}: {text}")


def report_memory(command_MB: list[float], worker_MB: list[float]) -> None:
    """Print the means over the first and the last fifth of the time, and the peak."""
    fifth = max(1, len(command_MB) // 5)
    for name, values in (("command", command_MB), ("largest worker", worker_MB)):
        first, last = mean(values[:fifth]), mean(values[-fifth:])
        print(
            f"memory of the {name}: {first:.0f} MB in the first fifth, {last:.0f} in the last, peak {max(values):.0f}"
        )


def _kind(problem: str) -> str:
    """Return a problem without its names and numbers."""
    return re.sub(r"-?\d+(\.\d+)?", "#", re.sub(r"touched .* at", "touched something at", problem))


def _resident_MB(pid: int) -> float:
    match = re.search(r"VmRSS:\s+(\d+) kB", _read(Path(f"/proc/{pid}/status")))
    return int(match[1]) / 1e3 if match else 0.0


def _read(path: Path) -> str:
    try:
        return path.read_text()
    except OSError:
        return ""  # it has ended


if __name__ == "__main__":
    main()
