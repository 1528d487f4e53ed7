"""Cost of a run of images along the line, all of it: start, scene, maps, tracing, developing, encoding.

    python -m benchmarks.render.costs.whole_run [--look classroom] [--size 640 480] [--frames 200] [--plain 2]
        [--every 10]

Images from hybrid rendering make all frames, so that their maps grow and are used again as in a run; the plain loop
with Blender's default denoiser, whose frames cost the same each, makes every tenth.
"""

import argparse
import sys
from dataclasses import asdict, replace

import numpy as np

from benchmarks.render.contenders.plain_loop import BLENDERS_DEFAULT
from benchmarks.render.contenders.render_process import RenderProcess
from benchmarks.render.references.views import LOOKS, job_along_the_line
from blender_scenes.render.sampling import hybrid_samples
from configs.schema.scenario import Render


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--look", choices=LOOKS, default="classroom")
    parser.add_argument("--size", nargs=2, type=int, default=[640, 480], metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--frames", type=int, default=200)
    parser.add_argument("--plain", nargs="*", type=int, default=[2], help="samples")
    parser.add_argument("--every", type=int, default=10)
    options = parser.parse_args()
    job = job_along_the_line(options.look, options.frames, tuple(options.size))
    width_px, height_px = options.size
    samples = hybrid_samples(Render(width_px=width_px, height_px=height_px))
    settings = {"kind": "ours", "hybrid": asdict(samples)}
    with RenderProcess("cycles_process.py", job, settings, 1, sys.executable) as process:
        print_cost("hybrid", process, [view.number for view in job.frames], options.frames)
    for samples in options.plain:
        few = replace(job, frames=job.frames[:: options.every])
        settings = {"kind": "plain", "cycles": {**BLENDERS_DEFAULT, "samples": samples}}
        with RenderProcess("cycles_process.py", few, settings, 1, sys.executable) as process:
            print_cost(f"plain loop, {samples}", process, [view.number for view in few.frames], options.frames)


def print_cost(name: str, process: RenderProcess, numbers: list[int], frames: int) -> None:
    """Print the cost of a frame in a run of so many frames, and the median cost of one frame."""
    costs = [process.render([number]) for number in numbers]
    each = np.array([cost.core_s for cost in costs])
    whole = (process.set_up.core_s + each.sum() * frames / len(numbers)) / frames
    spread = f"median {np.median(each):.2f}, most {each.max():.1f}"
    print(f"{name:16} {whole:6.2f} core-s a frame, all counted; {spread}", flush=True)


if __name__ == "__main__":
    main()
