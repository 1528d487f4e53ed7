"""Whether the memory of the Blender process stays flat over many frames.

Renders small frames along the line, round after round and no view twice, in one process and reads its resident memory
after each. Hybrid rendering keeps maps of the floor, which grow in the first round.

    python -m benchmarks.render.costs.many_frames [--method hybrid] [--frames 2000] [--size 64 48] [--plot memory.png]
"""

import argparse
import re
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from statistics import mean

import numpy as np

from benchmarks.render.references.views import LOOKS, job_along_the_line
from blender_scenes.render.job import RenderJob
from blender_scenes.render.renderer import render_job
from blender_scenes.render.sampling import hybrid_samples
from configs.schema.scenario import Render

_PRINTED = (1, 10, 100, 300, 500, 1000)
"""Numbers of frames after which memory is printed, besides the last."""


def memory_MB(job: RenderJob, threads: int) -> list[float]:
    """Resident memory of the Blender process after each of the job's frames."""
    seen: list[float] = []

    def note(_: int) -> None:
        seen.append(_children_MB())
        if len(seen) in {*_PRINTED, len(job.frames)}:
            print(f"  {len(seen)} frames: {seen[-1]:.0f} MB", flush=True)

    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch, "job.json")
        file.write_text(job.to_json())
        render_job(file, Path(scratch, "images"), threads=threads, on_frame=note)
    return seen


def _children_MB() -> float:
    tasks = Path("/proc/self/task").glob("*/children")
    status = [Path(f"/proc/{pid}/status").read_text() for task in tasks for pid in task.read_text().split()]
    return sum(int(match[1]) / 1e3 for text in status if (match := re.search(r"VmRSS:\s+(\d+) kB", text)))


def plot(seen: list[float], file: Path) -> None:
    from matplotlib import pyplot as plt  # noqa: PLC0415 - only for a plot

    figure, pane = plt.subplots(figsize=(7, 3.5))
    pane.plot(np.arange(1, len(seen) + 1), seen, linewidth=1)
    pane.set(xlabel="frames rendered", ylabel="memory of Blender [MB]", ylim=(0, 1.1 * max(seen)))
    pane.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(file, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=2000)
    parser.add_argument("--look", choices=LOOKS, default="classroom")
    parser.add_argument("--size", nargs=2, type=int, default=[64, 48], metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--method", choices=("full", "hybrid"), default="full")
    parser.add_argument("--samples", type=int, default=1, help="of full rendering alone")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--plot", type=Path)
    options = parser.parse_args()
    job = job_along_the_line(options.look, options.frames, tuple(options.size))
    width_px, height_px = options.size
    hybrid = hybrid_samples(Render(width_px=width_px, height_px=height_px)) if options.method == "hybrid" else None
    begin = time.monotonic()
    seen = memory_MB(
        replace(job, sampling=replace(job.sampling, samples=options.samples, hybrid=hybrid)), options.threads
    )
    fifth = max(1, len(seen) // 5)
    first, last = mean(seen[:fifth]), mean(seen[-fifth:])
    print(f"{len(seen)} frames of {options.size[0]} x {options.size[1]} px in {time.monotonic() - begin:.0f} s")
    print(f"memory of Blender: {first:.0f} MB in the first fifth, {last:.0f} in the last, peak {max(seen):.0f}")
    print(f"growth from the first fifth to the last: {1e3 * (last - first) / (0.8 * len(seen)):+.1f} MB in 1000 frames")
    if options.plot:
        plot(seen, options.plot)


if __name__ == "__main__":
    main()
