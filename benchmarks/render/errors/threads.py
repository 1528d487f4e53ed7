"""Whether a frame's file is the same, byte by byte, however many threads render it and whatever came before it.

Renders the same frames of each look with 1, 2 and 4 threads, in one Blender process or in pieces as after an
interruption, in another order each time, and compares SHA-256 of the JPEG files, camera noise included. Ends with
status 1 if any differs.

    python -m benchmarks.render.errors.threads [--looks night extreme] [--qualities draft high] [--size 64 48]
        [--samples 2]

Of a quality the denoiser is taken; the samples are `--samples`. `hybrid` has the samples of `standard` for hybrid
rendering, whose light has fewer pixels than they have from 160 x 120 on.
"""

import argparse
import sys
import tempfile
from dataclasses import asdict, replace
from itertools import product
from pathlib import Path
from typing import Any

from benchmarks.render.references.views import LOOKS, POSES, views_of
from blender_scenes.render.job import RenderJob
from blender_scenes.render.renderer import render_job
from blender_scenes.render.sampling import QUALITIES, hybrid_samples
from configs.schema.scenario import Render

PLANS = {1: ((1, 2, 3),), 2: ((3,), (1, 2)), 4: ((2,), (1, 3))}
"""Threads -> numbers of the frames that each of its processes renders."""


def hashes(job: RenderJob, threads: int, parts: tuple[tuple[int, ...], ...]) -> dict[int, str]:
    """Return the SHA-256 of each frame's file, by number."""
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch, "job.json")
        file.write_text(job.to_json())
        sets = [render_job(file, Path(scratch, "images"), threads=threads, numbers=part) for part in parts]
        return {image.number: image.sha256 for frames in sets for image in frames.files}


def _settings(name: str, options: argparse.Namespace) -> dict[str, Any]:
    """Return fields of `TracingSettings` for a choice."""
    if name == "hybrid":
        width_px, height_px = options.size
        return {"hybrid": hybrid_samples(Render(width_px=width_px, height_px=height_px))}
    return asdict(replace(QUALITIES[name], samples=options.samples))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--looks", nargs="+", choices=LOOKS, default=list(LOOKS))
    qualities = ["draft", "standard", "high", "hybrid"]
    parser.add_argument("--qualities", nargs="+", choices=[*QUALITIES, "hybrid"], default=qualities)
    parser.add_argument("--size", nargs=2, type=int, default=[64, 48], metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--samples", type=int, default=2)
    options = parser.parse_args()
    differ = 0
    for look, name in product(options.looks, options.qualities):
        job = views_of(look, POSES[: len(PLANS)], tuple(options.size)).noisy()
        job = replace(job, sampling=replace(job.sampling, **_settings(name, options)))
        by_threads = {threads: hashes(job, threads, parts) for threads, parts in PLANS.items()}
        for number in sorted(by_threads[1]):
            frame_hashes = {threads: by_threads[threads][number] for threads in PLANS}
            same = len(set(frame_hashes.values())) == 1
            differ += not same
            shown = (
                frame_hashes[1][:16] if same else "  ".join(f"{n} threads {h[:16]}" for n, h in frame_hashes.items())
            )
            print(f"{look:10} {name:9} frame {number}: {'same' if same else 'DIFFERS'}  {shown}", flush=True)
    print(f"{differ} frames differ" if differ else "every frame is the same with 1, 2 and 4 threads, in any order")
    sys.exit(bool(differ))


if __name__ == "__main__":
    main()
