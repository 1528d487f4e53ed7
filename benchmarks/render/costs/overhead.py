"""Cost of an image besides Cycles: placing, Blender's own copies, reading, developing, encoding, writing.

    python -m benchmarks.render.costs.overhead [--look classroom] [--size 640 480] [--frames 10]

Prints medians of one thread's time for a frame: all of it, what Cycles takes to render and denoise, and the rest as a
share of that.
"""

import argparse
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from statistics import median
from types import ModuleType

from benchmarks.render.references.views import LOOKS, job_along_the_line
from blender_scenes.blender_side.loading import load_bpy
from blender_scenes.render.frame_files import put_in_place
from blender_scenes.render.sampling import tracing_settings
from configs.schema.scenario import Render
from sensors.camera.response import develop, encode_jpeg
from symolo.dataset.layout import frame_name

_METERED = 1.0
"""Any luminance will do to time what follows the light."""


class Clock:
    """Processor time within a function of a module."""

    def __init__(self, module: ModuleType, name: str) -> None:
        self.spent_s = 0.0
        function = getattr(module, name)

        def timed(*arguments: object, **named: object) -> object:
            begin = time.process_time()
            try:
                return function(*arguments, **named)
            finally:
                self.spent_s += time.process_time() - begin

        setattr(module, name, timed)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--look", choices=LOOKS, default="classroom")
    parser.add_argument("--size", nargs=2, type=int, default=[640, 480], metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--frames", type=int, default=10)
    options = parser.parse_args()
    load_bpy(1)
    import _cycles  # noqa: PLC0415 - of bpy, loaded above

    from blender_scenes.blender_side import build, engine  # noqa: PLC0415 - they import bpy

    width_px, height_px = options.size
    settings = tracing_settings(Render(width_px=width_px, height_px=height_px, method="full"), seed=1)
    job = replace(job_along_the_line(options.look, options.frames + 1, (width_px, height_px)), sampling=settings)
    build.start()
    build.build(job.scene, job.camera)
    cycles = Clock(_cycles, "render")
    taken: list[tuple[float, float]] = []
    with tempfile.TemporaryDirectory() as scratch:
        engine.configure(job, 1, Path(scratch))
        images = engine.FrameTracer(job, 1, Path(scratch))
        for view in job.frames:
            begin = time.process_time(), cycles.spent_s
            pixels = develop(images.light(view), job.response, _METERED, view.number)
            data = encode_jpeg(pixels, job.response.jpeg_quality)
            put_in_place(data, Path(scratch, frame_name(view.number)), width_px, height_px)
            taken.append((time.process_time() - begin[0], cycles.spent_s - begin[1]))
    # The first frame has the scene to take over.
    all_s, cycles_s = (median(column) for column in zip(*taken[1:], strict=True))
    share = 100 * (all_s - cycles_s) / cycles_s
    print(f"{all_s:.3f} s a frame, {cycles_s:.3f} of them Cycles'; {share:.1f} % beside it")


if __name__ == "__main__":
    main()
