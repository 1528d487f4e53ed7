"""CPU seconds of a diagnosis; beside another checkout, and whether both give the same answer, if one is given.

The checkouts take turns at every case, each in a process of its own on one thread, so that a slow spell of the machine
meets both. The time is from the file's rows to the answer, without what it takes to start. For drives, it is the time
for each minute of log. With --command, it is the time of `symolo diagnose` with its start and its report.

    python benchmarks/diagnosis/evaluations/cpu_time.py [OTHER_CHECKOUT] [--cases 12] [--seed 1] [--kinds motor_step]
    python benchmarks/diagnosis/evaluations/cpu_time.py [OTHER_CHECKOUT] --folder DIR [--every 10] [--command]

With --folder, the cases are those in DIR, such as independent ones (benchmarks/diagnosis/independent_cases).
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from hidden_cases import KINDS, hidden_case, plans, write
from score import variant

HERE = Path(__file__).parents[3]
DIAGNOSE = """
import json, sys, time
from pathlib import Path
from diagnosis.diagnose import diagnose
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
measurement = read_measurement(Path(sys.argv[1]), IMPORTERS)
is_drive = measurement.kind.value in ("drive_log", "symolo_csv")
minutes = sum(trial.t_s[-1] for trial in measurement.trials) / 60 if is_drive else 1.0
begin = time.process_time()
answer = None if "--command" in sys.argv else diagnose(measurement).answer()
print(json.dumps({"seconds": (time.process_time() - begin) / minutes, "answer": answer, "minutes": minutes}))
"""
COMMAND = "import sys; from pipeline.cli import main; sys.exit(main())"


@dataclass(frozen=True)
class Run:
    seconds: float
    answer: dict
    minutes: float
    """Minutes of log of a drive; 1 for a bench."""

    @property
    def effects(self) -> list[tuple[str, frozenset[str]]]:
        """Names, each with its ambiguity set, in any order."""
        return sorted((variant(each), frozenset(each["ambiguous_with"])) for each in self.answer["effects"])

    def numbers(self, key: str) -> dict[tuple[str, str], float]:
        """Return the `parameters` or the `std` of every name."""
        return {
            (variant(each), name): value
            for each in self.answer["effects"]
            for name, value in each[key].items()
            if not isinstance(value, str)
        }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("other", type=Path, nargs="?")
    parser.add_argument("--cases", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", default="motor_step")
    parser.add_argument("--folder", type=Path, help="folder of cases, in place of new ones")
    parser.add_argument("--command", action="store_true", help="time the whole command, with its start and report")
    parser.add_argument("--every", type=int, default=1, help="of the cases, one of so many")
    arguments = parser.parse_args()
    kinds = arguments.kinds.split(",")
    if unknown := [kind for kind in kinds if kind not in KINDS]:
        parser.error(f"--kinds: got {unknown[0]}, allowed: {', '.join(KINDS)}")
    if arguments.other and not (arguments.other / "diagnosis").is_dir():
        parser.error(f"OTHER_CHECKOUT: got {arguments.other}, which has no folder diagnosis")
    checkouts = [HERE] if arguments.other is None else [arguments.other, HERE]
    titles = "".join(f"{title:>9}" for title in ("other s", "here s")[-len(checkouts) :])
    print(f"{'case':30}{titles}  found here")
    several = []
    cases = cases_in(arguments.folder) if arguments.folder else new_cases(arguments.cases, arguments.seed, kinds)
    for case in islice(cases, 0, None, arguments.every):
        runs = [(run_of_command if arguments.command else run)(checkout, case) for checkout in checkouts]
        several.append(runs)
        names = ", ".join(name for name, _ in runs[-1].effects) or "nothing"
        times = "".join(f"{each.seconds:9.1f}" for each in runs)
        print(f"{case.name:30}{times}  {names}{difference(runs[0], runs[-1])}", flush=True)
    if arguments.other is not None:
        alike = sum(other.answer == here.answer for other, here in several)
        print(f"{alike} of {len(several)} answers are the same in every digit")
    seconds = np.array([[each.seconds for each in runs] for runs in several])
    for share in (0.5, 0.9, 1.0):
        times = "".join(f"{value:9.1f}" for value in np.quantile(seconds, share, axis=0))
        print(f"{f'not exceeded by {share:.0%}':30}{times}")


def cases_in(folder: Path) -> Iterator[Path]:
    """Yield the cases in a folder."""
    yield from sorted(path.parent for path in folder.glob("*/nominal.yaml"))


def new_cases(number: int, seed: int, kinds: list[str]) -> Iterator[Path]:
    """Yield new cases, each of which is removed before the next one."""
    for plan in plans(number, seed, kinds):
        with tempfile.TemporaryDirectory() as folder:
            case = Path(folder) / plan.name
            write(hidden_case(plan), case)
            yield case


def run(checkout: Path, case: Path) -> Run:
    """Return a diagnosis by the code of a checkout."""
    return Run(**json.loads(printed_by(checkout, DIAGNOSE, str(case.resolve()))))


def run_of_command(checkout: Path, case: Path) -> Run:
    """Return a diagnosis by the command of a checkout, with the time of all its processes."""
    minutes = json.loads(printed_by(checkout, DIAGNOSE, str(case.resolve()), "--command"))["minutes"]
    before_s = children_s()
    with tempfile.TemporaryDirectory() as folder:
        words = ("diagnose", str(case.resolve()), "--out", f"{folder}/diagnosis", "--json")
        answer = json.loads(printed_by(checkout, COMMAND, *words))
    return Run((children_s() - before_s) / minutes, answer, minutes)


def children_s() -> float:
    """Return the CPU time of all child processes that have ended, with that of the system for them."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def printed_by(checkout: Path, program: str, *arguments: str) -> str:
    """Return what a program prints with the code of a checkout."""
    alone = {"PYTHONPATH": str(checkout.resolve()), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-c", program, *arguments]
    # The folder that python runs in comes first among those it imports from.
    done = subprocess.run(command, cwd=checkout, env=os.environ | alone, check=True, capture_output=True, text=True)
    return done.stdout


def difference(other: Run, here: Run) -> str:
    """Return the disagreement of two answers in words; for numbers the largest difference in standard errors."""
    if other.effects != here.effects:
        return f"; OTHERWISE {', '.join(name for name, _ in other.effects) or 'nothing'}, or other sets"
    places = [run.answer.get("unexplained_where") for run in (other, here)]
    if places[0] != places[1]:
        return f"; OTHERWISE unexplained {places[0]} and not {places[1]}"
    was, now, std = other.numbers("parameters"), here.numbers("parameters"), other.numbers("std")
    off = max((abs(was[key] - now[key]) / std[key] for key in was if std.get(key)), default=0.0)
    return f"; numbers {off:.2f} standard errors off" if off >= 0.005 else ""


if __name__ == "__main__":
    main()
