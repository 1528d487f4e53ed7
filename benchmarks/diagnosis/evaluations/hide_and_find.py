"""How often `symolo diagnose` names hidden effects, and how often it names effects that are absent, over new cases.

The cases come from the oracle in tests/gap_cases, which shares no code with the models that are fitted; effects that
are too small to be detected by anybody are drawn again. A run that was stopped goes on where it stopped.

    python benchmarks/diagnosis/evaluations/hide_and_find.py --cases 400 --seed 1 --family wide_b --workers 2
        [--kinds motor_steady,tof_bench] [--out DIR] [--compare OTHER.jsonl] [--verdicts FILE.jsonl]
    python benchmarks/diagnosis/evaluations/hide_and_find.py --show A.jsonl B.jsonl

DIR/cases.jsonl gets a line for every case as soon as it is done, DIR/reliability.png and .svg show whether stated
confidences hold, and the data of cases that went wrong are in DIR/wrong. `--show` prints the tables of earlier runs,
and `--compare` the cases of an earlier run that have another result now. To judge what can be known from a case takes
longer than to diagnose it: `--verdicts` keeps that in a file for the next run with the same family and seed. Remove the
file when the generator has changed.

Families (tests/gap_cases/disturbances.py): in `narrow` the files state noise and tolerances as they are. In the wide
families they may be wrong, with outliers in runs, drifting zeros and two outside effects at once; thresholds may be set
on `wide_a`, and figures are to be quoted from `wide_b`.
"""

import argparse
import json
import os
import shutil
import sys
import tempfile
import time
import traceback
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import suppress
from dataclasses import asdict
from importlib import import_module
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from figures import by_day, table, went_wrong
from hidden_cases import (
    FAMILIES,  # pyright: ignore[reportAttributeAccessIssue] - from a folder of tests
    KINDS,  # pyright: ignore[reportAttributeAccessIssue]
    Judged,
    Plan,
    Verdict,  # pyright: ignore[reportAttributeAccessIssue]
    judged_case,
    plans,
    write,  # pyright: ignore[reportAttributeAccessIssue]
)
from reliability import names_of, reliability_figure, reliability_table
from score import Score, score

from symolo.pages.plotting import png, svg


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--family", choices=list(FAMILIES), default="narrow")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--out", type=Path, default=Path(tempfile.gettempdir()) / "hide_and_find")
    parser.add_argument("--compare", type=Path, metavar="OTHER.jsonl")
    parser.add_argument("--verdicts", type=Path, metavar="FILE.jsonl")
    parser.add_argument("--show", type=Path, nargs="+", metavar="FILE.jsonl")
    arguments = parser.parse_args()
    files = [*(arguments.show or []), *([arguments.compare] if arguments.compare else [])]
    if missing := [path for path in files if not path.is_file()]:
        parser.error(f"no file {missing[0]}; name a cases.jsonl of an earlier run")
    if arguments.show:
        show([each for path in arguments.show for each in read(path).values()])
        return
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
    _same_run(parser, arguments.out, {"family": arguments.family, "seed": arguments.seed, "kinds": kinds})
    todo = plans(arguments.cases, arguments.seed, kinds, arguments.family)
    scores = scores_of(todo, arguments.out, arguments.workers, arguments.verdicts)
    show(list(scores.values()))
    figure = reliability_figure(
        names_of(list(scores.values())), f"{len(scores)} cases of the family {arguments.family}"
    )
    (arguments.out / "reliability.png").write_bytes(png(figure))
    (arguments.out / "reliability.svg").write_bytes(svg(figure))
    if arguments.compare:
        print("\n".join(["", *differences(read(arguments.compare), scores)]))
    print(f"\nevery case: {arguments.out / 'cases.jsonl'}")


def show(scores: Sequence[Score]) -> None:
    """Print the figures, the reliability table, and what is hardest."""
    print("\n".join([*table(scores), "", *reliability_table(names_of(scores)), "", *by_day(scores)]))


def _same_run(parser: argparse.ArgumentParser, out: Path, settings: dict) -> None:
    """Refuse to mix results of different runs in one folder."""
    note = out / "run.json"
    if note.is_file() and (made := json.loads(note.read_text())) != settings:
        parser.error(f"--out: {out} holds a run with {made}; name another folder or remove it")
    out.mkdir(parents=True, exist_ok=True)
    note.write_text(json.dumps(settings))


def scores_of(todo: Sequence[Plan], out: Path, workers: int, verdicts: Path | None = None) -> dict[str, Score]:
    """Return the scores of all plans by name, with those of an earlier run; `verdicts` is read, and gets new ones."""
    known = _known(verdicts) if verdicts and verdicts.is_file() else {}
    path = out / "cases.jsonl"
    done = read(path) if path.is_file() else {}
    missing = [plan for plan in todo if plan.name not in done]
    print(f"{len(todo)} cases, {len(todo) - len(missing)} of them from before", file=sys.stderr)
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        earlier = {plan: {key: known[key] for key in (repr(plan),) if key in known} for plan in missing}
        jobs = {pool.submit(run, plan, out, earlier[plan]): plan for plan in missing}
        for count, job in enumerate(as_completed(jobs), 1):
            plan, (result, judged) = jobs[job], job.result()
            done[plan.name] = result
            if verdicts and judged.plan not in known:
                _append(verdicts, asdict(judged))
            _append(path, {"case": plan.name, **asdict(result)})
            print(f"{count}/{len(missing)} {plan.name} {result.seconds:.1f} s: {_line(result)}", file=sys.stderr)
    return {plan.name: done[plan.name] for plan in todo}


def _append(path: Path, result: Mapping) -> None:
    # A run that was killed may have left half a line, which this begins anew behind.
    torn = path.is_file() and not path.read_bytes().endswith(b"\n")
    with path.open("a", encoding="utf-8") as opened:
        opened.write(("\n" if torn else "") + json.dumps(result) + "\n")


def read(path: Path) -> dict[str, Score]:
    """Return the scores of a file by case."""
    return {values.pop("case"): Score(**values) for values in _lines(path)}


def _known(path: Path) -> dict[str, Judged]:
    return {each["plan"]: Judged(**{**each, "verdict": Verdict(**_tuples(each["verdict"]))}) for each in _lines(path)}


def _lines(path: Path) -> Iterator[dict[str, Any]]:
    """Yield the objects of a file; half a line of a run that was killed is left out."""
    for line in path.read_text(encoding="utf-8").splitlines():
        with suppress(json.JSONDecodeError):
            yield _tuples(json.loads(line))


def _tuples(values: Mapping[str, Any]) -> dict[str, Any]:
    return {key: tuple(each) if isinstance(each, list) else each for key, each in values.items()}


def differences(before: Mapping[str, Score], after: Mapping[str, Score]) -> list[str]:
    """Return a line for each case that went wrong in one run and not in the other; both must hide the same."""
    common = [name for name in after if name in before and before[name].sizes == after[name].sizes]
    changed = [name for name in common if went_wrong(before[name]) != went_wrong(after[name])]
    lines = [f"{len(common)} cases in common, {len(changed)} of them right in only one run"]
    for name in changed:
        result = "worse" if went_wrong(after[name]) else "better"
        lines.append(f"{result} {name}: {', '.join(after[name].truth) or 'nothing'} -> {_reply(after[name])}")
        lines.append(f"  before: {_reply(before[name])}")
    return lines


def run(plan: Plan, out: Path, known: Mapping[str, Judged]) -> tuple[Score, Judged]:
    """Make a case, diagnose it, keep its data if the result is wrong, and return its score and its verdict."""
    case, judged = judged_case(plan, known)
    folder = out / "wrong" / plan.name
    shutil.rmtree(folder, ignore_errors=True)
    write(case, folder)
    answer, seconds, failed = _answer(folder)
    result = score(case, plan.category, answer, seconds, failed, verdict=judged.verdict)
    if not went_wrong(result):
        shutil.rmtree(folder)
    else:
        truth = {**asdict(result), "day": asdict(case.day)}
        (folder / "truth.json").write_text(json.dumps(truth, indent=1, default=str))
    return result, judged


def _answer(folder: Path) -> tuple[dict | None, float, str]:
    """Return the answer, the CPU time from the files to the answer, and the text of an exception."""
    begin, answer, failed = time.process_time(), None, ""
    try:
        diagnose = import_module("diagnosis.diagnose").diagnose
        importers = import_module("diagnosis.importers").IMPORTERS
        read_measurement = import_module("diagnosis.importers.choose").read_measurement
        begin = time.process_time()
        answer = diagnose(read_measurement(folder, importers)).answer()
    except Exception:  # noqa: BLE001 - whatever it is, this case is one that failed
        failed = traceback.format_exc()
    return answer, time.process_time() - begin, failed


def _line(result: Score) -> str:
    return f"{'WRONG ' if went_wrong(result) else ''}{', '.join(result.truth) or 'nothing'} -> {_reply(result)}"


def _reply(result: Score) -> str:
    return result.failed.strip().splitlines()[-1] if result.failed else result.answer


if __name__ == "__main__":
    main()
