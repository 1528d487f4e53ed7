"""Whether images of long runs keep the promise of `render.method: auto`, under looks that nobody has seen before.

Cases are one draw of each shipped look and several draws of `extreme`, with a new seed each time, seen by a camera of
random place, direction and pitch. Each case is a run of several views. The renderer chooses method and samples as for a
run of at least 100 images, from measurements on some of the views; it is judged on the others. Their error is the mean
product of the differences from two references of complete light paths, with independent random numbers and without a
denoiser, beside the error that JPEG adds to the image with the noise of its camera.

    python benchmarks/render/fresh_draws.py [--draws 30] [--looks classroom lab] [--judged 3] [--samples 1024]
        [--size 320 240] [--device cpu] [--seed N] [--out draws.json]

`--device gpu` traces the references on a graphics card; the images that are judged come from the processor.
"""

import argparse
import json
import os
import secrets
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from painters import Painter
from views import LOOKS, RandomCase, Views, random_cases

from blender_scenes.render.crop_errors import mean_square_errors
from blender_scenes.render.devices import DeviceKind, device_for
from blender_scenes.render.job import RenderJob
from blender_scenes.render.light_paths import LIGHT_PATHS
from blender_scenes.render.probe import PROBE_VIEWS, Decision, probed_numbers
from blender_scenes.render.sampling import hybrid_samples
from configs.schema.scenario import Render
from sensors.camera.colour import LUMINANCE
from sensors.camera.response import median_luminance
from symolo.core.arrays import FloatImage

SEEDS = (101, 202)
"""Of the two references."""
LARGEST_EXCESS_DB = 1.0
"""The promise for a single image."""


@dataclass(frozen=True)
class Row:
    """One view that was not probed."""

    case: str
    floor: str
    method: str
    """Hybrid, or the number of samples."""
    estimated_db: float
    """Error of the rendering relative to that of JPEG, on the crops of the probed views."""
    excess_db: float
    """The same, of the whole view; negative where the rendering is better than JPEG."""
    psnr_db: float
    jpeg_psnr_db: float
    light: float
    """Mean luminance, relative to the references'."""
    core_s: float
    """Without the measurement."""


def rows_of(case: RandomCase, options: argparse.Namespace, device: DeviceKind) -> list[Row]:
    size = tuple(options.size)
    views = case.views(PROBE_VIEWS + options.judged, size)
    probed = probed_numbers(len(views.job.frames))
    judged = [view.number for place, view in enumerate(views.job.frames) if place not in probed]
    lights, decision, core_s = chosen_lights(views, judged, options)
    references = reference_lights(views.job, judged, options, device)
    metered = median_luminance(np.concatenate([light.reshape(-1, 3) for pair in references.values() for light in pair]))
    method = "hybrid" if decision.full is None else f"{decision.full.samples} samples"
    rows = []
    for number in judged:
        error, jpeg = mean_square_errors(lights[number], references[number], views.noisy().response, metered, number)
        brightness = [float((light @ LUMINANCE).mean()) for light in (lights[number], *references[number])]
        rows.append(
            Row(
                case=case.name,
                floor=case.spec(size).look.floor.material,
                method=method,
                estimated_db=decibels(decision.errors.ratio),
                excess_db=decibels(max(error, 0.01) / jpeg),
                psnr_db=decibels(255**2 / max(error, 0.01)),
                jpeg_psnr_db=decibels(255**2 / jpeg),
                light=brightness[0] / np.mean(brightness[1:]),
                core_s=core_s,
            )
        )
    return rows


def chosen_lights(
    views: Views, numbers: list[int], options: argparse.Namespace
) -> tuple[dict[int, FloatImage], Decision, float]:
    """Return the light of the views as a long run renders them, what it chose, and the core-seconds of a view."""
    width_px, height_px = options.size
    hybrid = hybrid_samples(Render(width_px=width_px, height_px=height_px))
    noisy = views.noisy()
    job = replace(noisy, sampling=replace(noisy.sampling, probe=True, hybrid=hybrid))
    with Painter("painter.py", job, {"kind": "chosen"}, options.threads, sys.executable) as painter:
        cost = painter.paint(numbers)
        return {n: painter.light(n) for n in numbers}, painter.decision(), cost.core_s / len(numbers)


def reference_lights(
    job: RenderJob, numbers: list[int], options: argparse.Namespace, device: DeviceKind
) -> Mapping[int, tuple[FloatImage, FloatImage]]:
    """Return two images of the light of each view, with other random numbers."""
    job = replace(job, sampling=replace(job.sampling, paths=LIGHT_PATHS["complete"], device=device))
    gains = {view.number: np.array(view.light_gain, np.float32) for view in job.frames}
    halves = []
    for seed in SEEDS:
        settings = {"kind": "passes", "samples": options.samples, "seed": seed}
        with Painter("painter.py", job, settings, options.threads, sys.executable) as painter:
            painter.paint(numbers)
            halves.append({number: painter.light(number)[0] * gains[number] for number in numbers})
    return {number: (halves[0][number], halves[1][number]) for number in numbers}


def decibels(ratio: float) -> float:
    return round(float(10 * np.log10(max(ratio, 1e-9))), 2)


def print_summary(rows: list[Row]) -> None:
    excess = np.array([row.excess_db for row in rows])
    kept, near = np.count_nonzero(excess <= 0), np.count_nonzero(excess <= LARGEST_EXCESS_DB)
    low, middle, high = np.quantile(excess, [0.1, 0.5, 0.9])
    print(f"\n{len(rows)} images: no worse than JPEG {kept}, at most {LARGEST_EXCESS_DB:g} dB worse {near}")
    print(f"error relative to JPEG: median {middle:+.1f} dB, lowest tenth {low:+.1f}, highest tenth {high:+.1f}")
    worst = max(rows, key=lambda row: row.excess_db)
    print(f"worst {worst.excess_db:+.1f} dB: {worst.case}, {worst.floor}, {worst.method}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--looks", nargs="*", choices=LOOKS, default=list(LOOKS))
    parser.add_argument("--draws", type=int, default=30, help="of extreme")
    parser.add_argument("--judged", type=int, default=3, help="views of each case that are judged")
    parser.add_argument("--samples", type=int, default=1024, help="of each reference")
    parser.add_argument("--size", nargs=2, type=int, default=[320, 240], metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--device", choices=["cpu", "auto", "gpu"], default="cpu", help="of the references")
    parser.add_argument("--seed", type=int, default=secrets.randbelow(2**31), help="of the draws; default: a new one")
    parser.add_argument("--out", type=Path, help="JSON file of the rows")
    options = parser.parse_args()
    print(f"seed {options.seed}", flush=True)
    device = device_for(options.device)
    rows: list[Row] = []
    for case in random_cases(options.looks, options.draws, options.seed):
        rows += (of_case := rows_of(case, options, device))
        excess = ", ".join(f"{row.excess_db:+.1f}" for row in of_case)
        one = of_case[0]
        print(
            f"{case.name:12} {one.floor:13} {one.method:11} estimated {one.estimated_db:+.1f} dB, seen {excess} dB;"
            f" JPEG {one.jpeg_psnr_db:.1f} dB; light {one.light:.3f}; {one.core_s:.1f} core-s",
            flush=True,
        )
        if options.out:
            text = json.dumps({"seed": options.seed, "rows": [asdict(row) for row in rows]}, indent=1)
            options.out.write_text(text + "\n")
    print_summary(rows)


if __name__ == "__main__":
    main()
