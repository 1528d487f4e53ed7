"""Whether a frame's file is the same, byte by byte, however many threads render it and whatever came before it.

Renders the same frames of each look with 1, 2 and 4 threads in Blender processes of their own, each in another order,
and compares SHA-256 of the JPEG files, camera noise included. Ends with status 1 if any differs.

    python benchmarks/render/threads.py [--looks night extreme] [--size 64 48]
"""

import argparse
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from views import LOOKS, POSES, views_of

from blender_scenes.job import RenderJob
from blender_scenes.protocol import Request
from blender_scenes.renderer import blender_files

PLANS = {1: (1, 2, 3), 2: (3, 1, 2), 4: (2, 3, 1)}
"""Threads -> numbers of frames in the order in which they are rendered."""


def hashes(job: RenderJob, threads: int, numbers: tuple[int, ...]) -> dict[int, str]:
    """SHA-256 of each frame's file, by number."""
    with tempfile.TemporaryDirectory() as scratch:
        file, images = Path(scratch, "job.json"), Path(scratch, "images")
        file.write_text(job.to_json())
        images.mkdir()
        blender = Path(scratch, "blender")
        blender.mkdir()
        request = Request("pictures", str(file), str(images), numbers, threads, str(blender))
        samples = job.camera.width_px * job.camera.height_px * job.sampling.samples
        return {frame.number: frame.sha256 for frame in blender_files(request, samples)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--looks", nargs="+", choices=LOOKS, default=list(LOOKS))
    parser.add_argument("--size", nargs=2, type=int, default=[64, 48], metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--samples", type=int, default=2)
    asked = parser.parse_args()
    differ = 0
    for look in asked.looks:
        job = views_of(look, POSES[: len(PLANS)], tuple(asked.size)).noisy()
        job = replace(job, sampling=replace(job.sampling, samples=asked.samples))
        found = {threads: hashes(job, threads, numbers) for threads, numbers in PLANS.items()}
        for number in sorted(PLANS[1]):
            of_frame = {threads: found[threads][number] for threads in PLANS}
            same = len(set(of_frame.values())) == 1
            differ += not same
            told = of_frame[1][:16] if same else "  ".join(f"{n} threads {h[:16]}" for n, h in of_frame.items())
            print(f"{look:10} frame {number}: {'same' if same else 'DIFFERS'}  {told}", flush=True)
    print(f"{differ} frames differ" if differ else "every frame is the same with 1, 2 and 4 threads, in any order")
    sys.exit(bool(differ))


if __name__ == "__main__":
    main()
