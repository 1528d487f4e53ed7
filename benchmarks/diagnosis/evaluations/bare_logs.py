"""What `symolo diagnose` finds in bare SyMoLo logs (`data.csv` alone) with one hidden effect, or none.

    python benchmarks/diagnosis/evaluations/bare_logs.py --cases 60 --seed 1 [--workers 2] [--out DIR] [--names a,b]

Each log is a simulated drive in one of our arenas (log_cases.py). Names and arenas are taken in turn, sizes are drawn.
The file DIR/logs.jsonl gets a line for every log as soon as it is done. A run that was stopped continues where it
stopped: the lines of the same logs are used again, except those that failed. The figures are those of the asked logs.
"""

import argparse
import json
import os
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from importlib import import_module
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from log_cases import SCENARIOS, SIZES, UNSEEN, Hidden, LogPlan, write_log

NOTHING = "none"
TURNS = (*SIZES, NOTHING, *UNSEEN, NOTHING)
"""What is hidden in turn."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--names", default="", help=f"what to hide in turn, some of {', '.join(dict.fromkeys(TURNS))}")
    parser.add_argument("--out", type=Path, default=Path(tempfile.gettempdir()) / "bare_logs")
    arguments = parser.parse_args()
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(variable, "1")
    turns = arguments.names.split(",") if arguments.names else TURNS
    if unknown := [name for name in turns if name not in TURNS]:
        parser.error(f"--names: {', '.join(unknown)}: allowed are {', '.join(dict.fromkeys(TURNS))}")
    arguments.out.mkdir(parents=True, exist_ok=True)
    lines = arguments.out / "logs.jsonl"
    all_plans = plans(arguments.cases, arguments.seed, turns)
    done, todo = resumed(lines, all_plans)
    with ProcessPoolExecutor(arguments.workers, mp_context=get_context("spawn")) as pool:
        for job in as_completed([pool.submit(run, plan, arguments.out) for plan in todo]):
            done.append(job.result())
            with lines.open("a", encoding="utf-8") as opened:
                opened.write(json.dumps(done[-1]) + "\n")
            print(_line(done[-1]), flush=True)
    print("\n".join(["", *table(done)]))


def plans(cases: int, seed: int, turns: Sequence[str] = TURNS) -> list[LogPlan]:
    """Return the first plans of an endless series."""
    series = []
    for number in range(cases):
        rng = np.random.default_rng([seed, number])
        lap, place = divmod(number, len(turns))
        name = turns[place]
        sampler = {**SIZES, **UNSEEN}.get(name)
        hidden = Hidden(name, sampler(rng)) if sampler else Hidden()
        # In the next lap each name is in the next arena, whatever the number of names.
        scenario = SCENARIOS[(lap + place) % len(SCENARIOS)]
        series.append(LogPlan(f"{number:03d}_{name}", scenario, int(rng.integers(2**31)), hidden))
    return series


def resumed(lines: Path, all_plans: Sequence[LogPlan]) -> tuple[list[dict], list[LogPlan]]:
    """Return the results of a file that are of these logs and did not fail, and the plans without one."""
    known = [json.loads(line) for line in lines.read_text().splitlines()] if lines.is_file() else []
    by_plan = {json.dumps(each["plan"], sort_keys=True): each for each in known if "failed" not in each}
    keys = {json.dumps(asdict(plan), sort_keys=True): plan for plan in all_plans}
    return [by_plan[key] for key in keys if key in by_plan], [plan for key, plan in keys.items() if key not in by_plan]


def run(plan: LogPlan, out: Path) -> dict:
    """Make a log, diagnose it, and return what was hidden and what was named."""
    folder, truth = out / plan.name, plan.hidden
    result = {"plan": asdict(plan), "case": plan.name, "scenario": plan.scenario, "truth": truth.variant}
    try:
        write_log(plan, folder)
        diagnose = import_module("diagnosis.diagnose").diagnose
        measurement = import_module("diagnosis.importers.choose").read_measurement(
            folder, import_module("diagnosis.importers").IMPORTERS
        )
        begin = time.process_time()
        diagnosis = diagnose(measurement)
        seconds = time.process_time() - begin
    except Exception:  # noqa: BLE001 - whatever it is, this log is one that failed
        return {**result, "failed": traceback.format_exc()}
    names = [named.effect.name for named in diagnosis.named]
    sets = [{named.effect.name, *named.comparison.ambiguous_with} for named in diagnosis.named]
    off = [
        (named.values[key] - value) / named.std[key]
        for named in diagnosis.named
        if named.effect.name == truth.variant
        for key, value in dict(truth.parameters).items()
        if isinstance(value, float)
    ]
    return {
        **result,
        "names": names,
        "conclusion": str(diagnosis.conclusion),
        "confidence": [named.comparison.confidence for named in diagnosis.named],
        "right": len(sets) == 1 and truth.variant in sets[0] and len(sets[0]) <= 3,
        "exact": names == [truth.variant],
        "off": off,
        "unseen": truth.variant in diagnosis.candidates.untestable,
        "where": diagnosis.unexplained.channel if diagnosis.unexplained else "",
        "withheld": [each.name for each in diagnosis.withheld],
        "minutes": float(measurement.trials[0].t_s[-1]) / 60.0,
        "seconds": seconds,
    }


def _line(result: dict) -> str:
    if "failed" in result:
        return f"{result['case']}: FAILED {result['failed'].strip().splitlines()[-1]}"
    reply = ", ".join(result["names"]) or "no name"
    return f"{result['case']} ({result['scenario']}): {reply}; {result['conclusion']}; {result['seconds']:.1f} s"


def table(results: Sequence[dict]) -> list[str]:
    """Return the figures of a run."""
    failed = [each for each in results if "failed" in each]
    done = [each for each in results if "failed" not in each]
    shown = [each for each in done if each["truth"].partition("[")[0] in SIZES]
    hidden = [each for each in done if each["truth"].partition("[")[0] in UNSEEN]
    bare = [each for each in done if not each["truth"]]
    off = [abs(value) for each in shown for value in each["off"]]
    rate = [each["seconds"] / each["minutes"] for each in done]
    lines = [f"{len(results)} logs, {len(failed)} of them failed"]
    lines += [f"one effect that the log can show: right {_share(shown, 'right')}, exactly {_share(shown, 'exact')}"]
    lines += [f"nothing hidden: a name in {sum(bool(each['names']) for each in bare)} of {len(bare)}"]
    named = f"a name in {sum(bool(each['names']) for each in hidden)} of {len(hidden)}"
    lines += [f"an effect that no such log can show: {named}, reported as not visible {_share(hidden, 'unseen')}"]
    lines += [f"numbers within three standard errors: {sum(value <= 3.0 for value in off)} of {len(off)}"]
    lines += [f"CPU seconds per minute of drive: {np.median(rate):.1f}, at most {max(rate):.1f}"] if rate else []
    wrong = Counter(
        f"{each['truth']} -> {', '.join(each['names']) or 'no name'} ({each['conclusion']})"
        for each in done
        if (each["names"] if each not in shown else not each["right"])
    )
    return [*lines, *(f"  {count} x {what}" for what, count in wrong.most_common())]


def _share(results: Sequence[dict], key: str) -> str:
    return f"{sum(bool(each[key]) for each in results)} of {len(results)}"


if __name__ == "__main__":
    main()
