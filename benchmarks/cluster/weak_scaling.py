"""Loss of efficiency by a second worker, with Cycles on one thread.

python benchmarks/cluster/weak_scaling.py [--workers 2] [--images 25] [--repetitions 5] [--width 640]

The program renders as many simulated runs of the scenario `smoke` as there are workers: alternately with one worker,
and with all workers at the same time. Runs take different times, so the efficiency is that of the whole set: the time
of one worker, divided by the number of workers and by the time of all. Starts of workers and Blender are included.
"""

import argparse
import shutil
import statistics
import tempfile
import time
from pathlib import Path

from pipeline.planning.price import OneCore
from pipeline.work.batch import Batch
from symolo.core.progress import LineReport, Report


class Silent(LineReport):
    def say(self, text: str) -> None:
        del text


def rendered_s(settings: list[str], out: Path, simulated: Path, workers: int, report: Report) -> float:
    """Return the time of rendering all runs [s], whose trajectories exist."""
    shutil.rmtree(out, ignore_errors=True)
    shutil.copytree(simulated, out)
    batch = Batch.open("smoke", settings, out, OneCore(workers), report)
    begin = time.perf_counter()
    failures = batch.render([], report)
    assert not failures, failures  # noqa: S101 - or the time is of something else
    return time.perf_counter() - begin


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--images", type=int, default=25)
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--width", type=int, default=640)
    options = parser.parse_args()
    size = [
        f"render.width_px={options.width}",
        f"render.height_px={options.width * 3 // 4}",
        "render.quality=draft",
    ]
    settings = [*size, f"stop.time_limit_s={(options.images - 0.5) / 5}"]
    settings += [f"routes=[{{name: CW, start: {{x_m: 0.55, y_m: -0.20, yaw_deg: -90}}, runs: {options.workers}}}]"]
    report = Silent()
    with tempfile.TemporaryDirectory() as scratch:
        simulated, out = Path(scratch) / "simulated", Path(scratch) / "out"
        assert not Batch.open("smoke", settings, simulated, OneCore(1), report).simulate(report)  # noqa: S101
        taken: dict[int, list[float]] = {1: [], options.workers: []}
        for _ in range(options.repetitions):
            for workers, times in taken.items():
                times.append(rendered_s(settings, out, simulated, workers, report))
    one_s, all_s = (statistics.median(times) for times in taken.values())
    efficiency = one_s / all_s / options.workers
    print(f"{options.workers} runs of {options.images} images, medians of {options.repetitions} in turn:")
    print(f"{one_s:.2f} s by 1 worker, {all_s:.2f} s by {options.workers}; efficiency {efficiency:.3f}")


if __name__ == "__main__":
    main()
