"""Laps of every shipped robot in the arena of its size, from many seeds, clockwise and counter-clockwise in turn.

It reports how many laps each robot finished without a contact, their times, and the ratio of the median to that of the
nominal robot beside the square root of the ratio of the sizes, which it would be without noise (docs/robots.md).

    python benchmarks/laps/robot_sizes.py [--seeds 20] [--scenarios symolo,micromouse,scout]
"""

import argparse
import math
from statistics import median

from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.stages.simulate import simulate

SIZES_M = {"symolo": 0.18}
"""Length of the nominal robot; those of the others are in their specifications."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--scenarios", default="symolo,micromouse,scout")
    arguments = parser.parse_args()
    nominal_s = 0.0
    for scenario in arguments.scenarios.split(","):
        times_s: list[float] = []
        length_m = 0.0
        for seed in range(1, arguments.seeds + 1):
            loaded = load_scenario(scenario, [f"seed={seed}"])
            route = loaded.routes[seed % len(loaded.routes)].name
            spec = draw_run(loaded, route, 1)
            length_m = spec.robot.chassis.length_m
            outcome = simulate(spec)
            if outcome.lap_time_s is None:
                print(f"  {scenario} {route} seed {seed}: {'; '.join(outcome.problems)}", flush=True)
            else:
                times_s.append(outcome.lap_time_s)
        middle_s = median(times_s) if times_s else math.nan
        nominal_s = nominal_s or middle_s
        print(
            f"{scenario}: {len(times_s)} of {arguments.seeds} laps, {min(times_s, default=math.nan):.2f} to "
            f"{max(times_s, default=math.nan):.2f} s, median {middle_s:.2f} s, {middle_s / nominal_s:.3f} times the "
            f"first (square root of the ratio of lengths: {math.sqrt(length_m / SIZES_M['symolo']):.3f})",
            flush=True,
        )


if __name__ == "__main__":
    main()
