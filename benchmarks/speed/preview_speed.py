"""How long the flat renderer takes: core-seconds of preparing a scene, of its light and of a whole image.

python benchmarks/speed/preview_speed.py
"""

import time
from collections.abc import Callable
from functools import partial

import numpy as np

from blender_scenes.preview.renderer import FlatRenderer
from blender_scenes.render.job import FramePose, build_job
from configs.draw import draw_run
from configs.loader import load_scenario
from symolo.arena.geometry import Arena

POSES = [(0.55, -0.60, 90), (0.545, -0.15, 92), (0.49, 0.68, 133), (-0.55, -0.90, -70), (0.30, -1.04, 15)]
"""x [m], y [m], yaw [deg] in the dataset arena."""
REPEATS = 10


def median_ms(work: Callable[[], object]) -> float:
    """Time of this process alone, whatever else the machine does; run it with OPENBLAS_NUM_THREADS=1."""
    took = []
    for _ in range(REPEATS):
        begin = time.process_time()
        work()
        took.append(time.process_time() - begin)
    return 1e3 * float(np.median(took))


def measure(look: str) -> None:
    frames = [FramePose(i + 1, 0.2 * i, x, y, float(np.radians(yaw))) for i, (x, y, yaw) in enumerate(POSES)]
    spec = draw_run(load_scenario("symolo", (f"look={look}",)), "CCW", 1)
    render = spec.render.model_copy(update={"width_px": 320, "height_px": 240})
    job = build_job(Arena.from_config(spec.arena), spec.robot, spec.look, render, frames, 1)
    renderer = FlatRenderer(job)
    light = [median_ms(partial(renderer.light, view, job.camera)) for view in job.frames]
    whole = [median_ms(partial(renderer.image, view)) for view in job.frames]
    print(f"{look}: {len(job.scene.panels)} panels, prepared in {median_ms(partial(FlatRenderer, job)):.0f} ms")
    print(
        f"  light of 320 x 240 {min(light):.0f} to {max(light):.0f} ms, image {min(whole):.0f} to {max(whole):.0f} ms"
    )


if __name__ == "__main__":
    for name in ("classroom", "lab"):
        measure(name)
