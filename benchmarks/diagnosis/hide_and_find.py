"""How often `symolo diagnose` names hidden effects, and how often it names effects that are absent, over new cases.

The cases come from the oracle in tests/gap_cases, which shares no code with the models that are fitted; effects that
are too small to be detected by anybody are drawn again. A run that was stopped goes on where it stopped.

    python benchmarks/diagnosis/hide_and_find.py --cases 400 --seed 1 --workers 2 [--kinds motor_steady,tof_bench]
        [--out DIR]

DIR/cases.csv has a line for every case; the data of those that went wrong are in DIR/wrong.
"""

import argparse
import csv
import json
import os
import shutil
import sys
import tempfile
import time
import traceback
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from importlib import import_module
from multiprocessing import get_context
from pathlib import Path

from figures import table
from hidden_cases import KINDS, Plan, hidden_case, plans, write
from score import Score, score

COLUMNS = ("case", *Score.__dataclass_fields__)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--out", type=Path, default=Path(tempfile.gettempdir()) / "hide_and_find")
    arguments = parser.parse_args()
    kinds = arguments.kinds.split(",")
    if unknown := [kind for kind in kinds if kind not in KINDS]:
        parser.error(f"--kinds: got {unknown[0]}, allowed: {', '.join(KINDS)}")
    for name in ("cases", "workers"):
        if getattr(arguments, name) < 1:
            parser.error(f"--{name}: got {getattr(arguments, name)}, allowed: 1 or more")
    if arguments.seed < 0:
        parser.error(f"--seed: got {arguments.seed}, allowed: 0 or more")
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(variable, "1")  # the workers are the parallel part, and inherit this
    _same_run(parser, arguments.out, {"seed": arguments.seed, "kinds": kinds})
    todo = plans(arguments.cases, arguments.seed, kinds)
    scores = scores_of(todo, arguments.out, arguments.workers)
    write_csv(scores, arguments.out / "cases.csv")
    print("\n".join(table([each for _, each in scores])))
    print(f"\nevery case: {arguments.out / 'cases.csv'}")


def _same_run(parser: argparse.ArgumentParser, out: Path, settings: dict) -> None:
    """Refuse to mix results of different runs in one folder."""
    note = out / "run.json"
    if note.is_file() and (made := json.loads(note.read_text())) != settings:
        parser.error(f"--out: {out} holds a run with {made}; name another folder or remove it")
    (out / "scores").mkdir(parents=True, exist_ok=True)
    note.write_text(json.dumps(settings))


def scores_of(todo: Sequence[Plan], out: Path, workers: int) -> list[tuple[str, Score]]:
    """Return the scores of all plans in their order, with those of an earlier run."""
    missing = [plan for plan in todo if not _file(plan, out).is_file()]
    print(f"{len(todo)} cases, {len(todo) - len(missing)} of them from before", file=sys.stderr)
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        jobs = {pool.submit(run, plan, out): plan for plan in missing}
        for count, job in enumerate(as_completed(jobs), 1):
            done = job.result()
            print(f"{count}/{len(missing)} {jobs[job].name} {done.seconds:.1f} s: {_line(done)}", file=sys.stderr)
    return [(plan.name, _read(_file(plan, out))) for plan in todo]


def run(plan: Plan, out: Path) -> Score:
    """Make a case, diagnose it, write its score, and return it."""
    case = hidden_case(plan)
    folder = out / "wrong" / plan.name
    shutil.rmtree(folder, ignore_errors=True)
    write(case, folder)
    answer, seconds, failed = _answer(folder)
    result = score(case, plan.category, answer, seconds, failed)
    if not went_wrong(result):
        shutil.rmtree(folder)
    else:
        (folder / "truth.json").write_text(json.dumps(asdict(result), indent=1, default=str))
    part = _file(plan, out).with_suffix(".part")
    part.write_text(json.dumps(asdict(result)))
    part.replace(_file(plan, out))
    return result


def _answer(folder: Path) -> tuple[dict | None, float, str]:
    """Return the answer, the time from the files to the answer, and the text of an exception."""
    begin, answer, failed = time.perf_counter(), None, ""
    try:
        diagnose = import_module("diagnosis.diagnose").diagnose
        importers = import_module("diagnosis.importers").IMPORTERS
        read = import_module("diagnosis.importers.choose").read_measurement
        begin = time.perf_counter()
        answer = diagnose(read(folder, importers)).answer()
    except Exception:  # noqa: BLE001 - whatever it is, this case is one that failed
        failed = traceback.format_exc()
    return answer, time.perf_counter() - begin, failed


def went_wrong(result: Score) -> bool:
    """Return whether the answer is wrong in any respect."""
    if result.failed:
        return True
    if result.category == "outside":
        return result.named or not result.unexplained or not result.place
    return result.unexplained or result.right is False or (result.category == "none" and result.named)


def _line(result: Score) -> str:
    last = result.failed.strip().splitlines()[-1] if result.failed else result.answer
    return f"{'WRONG ' if went_wrong(result) else ''}{', '.join(result.truth) or 'nothing'} -> {last}"


def _file(plan: Plan, out: Path) -> Path:
    return out / "scores" / f"{plan.name}.json"


def _read(path: Path) -> Score:
    values = json.loads(path.read_text())
    return Score(**{name: tuple(value) if isinstance(value, list) else value for name, value in values.items()})


def write_csv(scores: Sequence[tuple[str, Score]], path: Path) -> None:
    with path.open("w", newline="", encoding="utf-8") as opened:
        writer = csv.writer(opened)
        writer.writerow(COLUMNS)
        for name, each in scores:
            cells = asdict(each)
            writer.writerow([name, *(_cell(cells[column]) for column in COLUMNS[1:])])


def _cell(value: object) -> object:
    if isinstance(value, tuple | list):
        return " | ".join(str(_cell(each)) for each in value)
    return f"{value:.4g}" if isinstance(value, float) else value


if __name__ == "__main__":
    main()
