"""Laps in random arenas through the simulate stage: how many are completed without a touch, and why others
stopped.

Every arena has its own seed; a lap is driven again by the command that is printed with it.

    python benchmarks/laps/random_arenas.py [--arenas 100] [--first-seed 1] [--workers 2] [--plot arenas.png]
"""

import argparse
import itertools
import math
import time
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from configs.draw import draw_run
from configs.loader import load_scenario
from configs.schema.scenario import RunSpec
from pipeline.stages.simulate import simulate
from symolo.arena.footprints import Rectangle
from symolo.arena.geometry import Arena

SCENARIO, ROUTE = "random_arenas", "Lap"
COLUMNS = 4
MAX_PLOTTED = 24


@dataclass(frozen=True)
class Lap:
    seed: int
    spec: RunSpec
    pose: np.ndarray
    """(N, 3)."""
    states: tuple[int, ...]
    """In their order."""
    problems: tuple[str, ...]
    lap_time_s: float | None


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--arenas", type=int, default=100)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--set", action="append", default=[], dest="settings", metavar="FIELD=VALUE")
    parser.add_argument("--plot", type=Path)
    arguments = parser.parse_args()
    seeds = range(arguments.first_seed, arguments.first_seed + arguments.arenas)
    begin = time.perf_counter()
    laps = []
    # Spawned, because a forked engine would share its state.
    with ProcessPoolExecutor(arguments.workers, mp_context=get_context("spawn")) as pool:
        for lap in pool.map(drive, seeds, itertools.repeat(tuple(arguments.settings))):
            laps.append(lap)
            if lap.problems:
                settings = "".join(f" --set '{text}'" for text in arguments.settings)
                print(f"seed {lap.seed}: {'; '.join(lap.problems)}, states {' '.join(map(str, lap.states))}")
                print(
                    f"    symolo simulate {SCENARIO} --set seed={lap.seed} --set routes.0.runs=1{settings} --out DIR",
                    flush=True,
                )
    report(laps, time.perf_counter() - begin)
    if arguments.plot:
        plot(laps, arguments.plot)


def drive(seed: int, settings: tuple[str, ...]) -> Lap:
    spec = draw_run(load_scenario(SCENARIO, [*settings, f"seed={seed}"]), ROUTE, 1)
    outcome = simulate(spec)
    trajectory = outcome.recording.trajectory
    states = tuple(state for state, _ in itertools.groupby(trajectory.state.tolist()))
    return Lap(seed, spec, trajectory.pose, states, outcome.problems, outcome.lap_time_s)


def report(laps: Sequence[Lap], elapsed_s: float) -> None:
    good = [lap for lap in laps if not lap.problems]
    print(f"{len(good)} of {len(laps)} laps completed without touching anything, in {elapsed_s:.0f} s")
    kinds = Counter(problem.split(" at ")[0].split(" within ")[0] for lap in laps for problem in lap.problems)
    for problem, count in kinds.most_common():
        print(f"    {count:3d}  {problem}")
    lengths = [Arena.from_config(lap.spec.arena).line.length_m for lap in laps]
    boxes = [[box.name for box in lap.spec.arena.obstacles] for lap in laps]
    on_line = Counter(sum(name.startswith("Obstacle") for name in names) for names in boxes)
    decoys = sum(name.startswith("Decoy") for names in boxes for name in names)
    passed = Counter(state for lap in good for state in lap.states)
    print(f"line {min(lengths):.1f} to {max(lengths):.1f} m; {decoys} decoys")
    print("arenas by obstacles on the line:", ", ".join(f"{n}: {on_line[n]}" for n in sorted(on_line)))
    print("times each state was entered:", ", ".join(f"{state}: {passed[state]}" for state in sorted(passed)))


def plot(laps: Sequence[Lap], path: Path) -> None:
    """Plot the laps that failed first, then others; the path is green if the lap was completed, else red."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - needed for an image alone

    shown = sorted(laps, key=lambda lap: (not lap.problems, lap.seed))[:MAX_PLOTTED]
    rows = math.ceil(len(shown) / COLUMNS)
    figure = Figure(figsize=(4.5 * COLUMNS, 4.5 * rows), layout="constrained")
    for place, lap in enumerate(shown):
        axes = figure.add_subplot(rows, COLUMNS, place + 1)
        arena = Arena.from_config(lap.spec.arena)
        for left, right in arena.line.edges(0.005):
            axes.fill(*np.concatenate([left, right[::-1]]).T, color="black", linewidth=0.8)
        for box in arena.boxes:
            colour = "grey" if box.kind == "wall" else "tab:red" if box.name.startswith("Obstacle") else "tab:blue"
            axes.fill(*box.footprint().T, color=colour, linewidth=0)
        colour = "tab:red" if lap.problems else "tab:green"
        axes.plot(lap.pose[:, 0], lap.pose[:, 1], color=colour, linewidth=1)
        chassis = lap.spec.robot.chassis
        for pose, face in ((lap.pose[0], "none"), (lap.pose[-1], colour)):
            body = Rectangle((pose[0], pose[1]), (chassis.length_m, chassis.width_m), pose[2])
            axes.fill(*np.array(body.corners()).T, facecolor=face, edgecolor="black", linewidth=0.6, alpha=0.7)
        axes.set_aspect("equal")
        ending = lap.problems[0] if lap.problems else f"lap {lap.lap_time_s:.1f} s"
        axes.set_title(f"seed {lap.seed}: {ending}\nstates {' '.join(map(str, lap.states))}", fontsize=8)
        axes.tick_params(labelsize=6)
    figure.savefig(path, dpi=80)


if __name__ == "__main__":
    main()
