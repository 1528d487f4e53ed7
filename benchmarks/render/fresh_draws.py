"""Whether images of long runs keep the promise of `render.method: auto`, under looks that nobody has seen before.

Cases are one draw of each shipped look and several draws of `extreme`, with a new seed each time, seen by a camera of
random place, direction and pitch. Each case is a run of several views. The renderer chooses method and samples as for a
run of at least 100 images, from measurements on some of the views; it is judged on the others. Their error is the mean
product of the differences from two references of complete light paths, with independent random numbers and without a
denoiser, beside the error that JPEG adds to the image with the noise of its camera.

    python benchmarks/render/fresh_draws.py [--draws 30] [--looks classroom lab] [--judged 3] [--samples 1024]
        [--size 320 240] [--method auto] [--device cpu] [--seed N] [--beside FOLDER] [--out draws.json]
        [--sheet worst.png]

`--method hybrid` judges hybrid rendering, whatever a run would choose. `--beside` judges another version of the
renderer as well, in the same views and with the same references; it takes the folder of its sources, such as `git
worktree add` makes. `--sheet` shows the place with the largest error of each image, four times as large, beside the
same place of the reference. `--device gpu` traces the references on a graphics card; the images that are judged come
from the processor.
"""

import argparse
import json
import os
import secrets
import sys
from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from itertools import product
from pathlib import Path

import cv2
import numpy as np
from painters import CHECKOUT, Painter
from views import LOOKS, RandomCase, Views, random_cases
from worst_places import WorstPlace, sheet, worst_place

from blender_scenes.render.devices import DeviceKind, device_for
from blender_scenes.render.image_errors import mean_square_errors
from blender_scenes.render.job import RenderJob
from blender_scenes.render.light_paths import LIGHT_PATHS
from blender_scenes.render.probe import MIN_VIEWS, Decision, probed_numbers
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
    version: str
    """`this`, or `beside` for the sources of `--beside`."""
    floor: str
    method: str
    """Hybrid, or the number of samples."""
    worst_block_db: float
    """Error of the worst square of `BLOCK_PX` x `BLOCK_PX` pixels, relative to JPEG's in the whole view."""
    estimated_db: float | None
    """Error of the rendering relative to that of JPEG, mean over the measured views; None without a choice."""
    limit_db: float | None
    """The same, as one view of twenty is expected to exceed it."""
    excess_db: float
    """The same, of the whole view; negative where the rendering is better than JPEG."""
    psnr_db: float
    jpeg_psnr_db: float
    light: float
    """Mean luminance, relative to the references'."""
    core_s: float
    """Without what `set_up_s` has."""
    set_up_s: float
    """Core-seconds for the start, the scene and the choice."""


@dataclass(frozen=True)
class Lights:
    """The light of the judged views, as a long run renders it."""

    by_view: Mapping[int, FloatImage]
    decision: Decision | None
    """What the run chose; None if hybrid rendering is not its choice."""
    core_s: float
    set_up_s: float
    """As in `Row`."""

    @property
    def method(self) -> str:
        full = self.decision and self.decision.full
        return f"{full.samples} samples" if full else "hybrid"


def rows_of(case: RandomCase, options: argparse.Namespace, device: DeviceKind) -> list[tuple[Row, WorstPlace]]:
    size = tuple(options.size)
    views = case.views(MIN_VIEWS + options.judged, size)
    probed = probed_numbers(len(views.job.frames))
    judged = [view.number for place, view in enumerate(views.job.frames) if place not in probed]
    by_version = {name: chosen_lights(views, judged, options, at) for name, at in options.versions.items()}
    references = reference_lights(views.job, judged, options, device)
    metered = median_luminance(np.concatenate([light.reshape(-1, 3) for pair in references.values() for light in pair]))
    rows = []
    for version, number in product(by_version, judged):
        lights = by_version[version]
        errors = lights.decision and lights.decision.errors
        light, pair = lights.by_view[number], references[number]
        error, jpeg = mean_square_errors(light, pair, views.noisy().response, metered, number)
        place = worst_place(light, pair, views.job.response, metered)
        brightness = [float((each @ LUMINANCE).mean()) for each in (light, *pair)]
        row = Row(
            case=case.name,
            version=version,
            floor=case.spec(size).look.floor.material,
            method=lights.method,
            worst_block_db=decibels(max(place.mean_square, 0.01) / jpeg),
            estimated_db=round(float(np.mean(errors.relative_dB)), 2) if errors else None,
            limit_db=round(errors.limit_dB, 2) if errors else None,
            excess_db=decibels(max(error, 0.01) / jpeg),
            psnr_db=decibels(255**2 / max(error, 0.01)),
            jpeg_psnr_db=decibels(255**2 / jpeg),
            light=brightness[0] / float(np.mean(brightness[1:])),
            core_s=round(lights.core_s, 2),
            set_up_s=round(lights.set_up_s, 1),
        )
        rows.append((row, place))
    return rows


def chosen_lights(views: Views, numbers: list[int], options: argparse.Namespace, checkout: Path) -> Lights:
    """Return the light of the views as a long run of a version renders them, with what it chose."""
    width_px, height_px = options.size
    hybrid = hybrid_samples(Render(width_px=width_px, height_px=height_px))
    noisy = views.noisy()
    chooses = options.method == "auto"
    job = replace(noisy, sampling=replace(noisy.sampling, probe=chooses, hybrid=hybrid))
    settings = {"kind": "chosen"} if chooses else {"kind": "ours", "hybrid": asdict(hybrid)}
    with Painter("painter.py", job, settings, options.threads, sys.executable, checkout=checkout) as painter:
        cost = painter.paint(numbers)
        decision = painter.decision() if chooses else None
        by_view = {number: painter.light(number) for number in numbers}
        return Lights(by_view, decision, cost.core_s / len(numbers), painter.set_up.core_s)


def reference_lights(
    job: RenderJob, numbers: list[int], options: argparse.Namespace, device: DeviceKind
) -> Mapping[int, tuple[FloatImage, FloatImage]]:
    """Return two images of the light of each view, with other random numbers."""
    job = replace(job, sampling=replace(job.sampling, paths=LIGHT_PATHS["complete"], device=device))
    settings = {"kind": "references", "samples": options.samples, "seeds": SEEDS}
    with Painter("painter.py", job, settings, options.threads, sys.executable) as painter:
        painter.paint(numbers)
        pairs = {number: painter.light(number) for number in numbers}
    return {number: (first, second) for number, (first, second) in pairs.items()}


def decibels(ratio: float) -> float:
    return round(float(10 * np.log10(max(ratio, 1e-9))), 2)


def print_case(rows: list[Row]) -> None:
    excess = ", ".join(f"{row.excess_db:+.1f}" for row in rows)
    blocks = ", ".join(f"{row.worst_block_db:+.1f}" for row in rows)
    one = rows[0]
    print(
        f"{one.case:12} {one.version} {one.floor:13} {one.method:11} estimated {one.estimated_db} dB,"
        f" limit {one.limit_db}, seen {excess} dB; worst squares {blocks} dB; JPEG {one.jpeg_psnr_db:.1f} dB;"
        f" light {one.light:.3f}; {one.core_s:.1f} core-s after {one.set_up_s:.0f}",
        flush=True,
    )


def print_summary(rows: list[Row]) -> None:
    excess = np.array([row.excess_db for row in rows])
    kept, near = np.count_nonzero(excess <= 0), np.count_nonzero(excess <= LARGEST_EXCESS_DB)
    low, middle, high = np.quantile(excess, [0.1, 0.5, 0.9])
    print(f"\n{rows[0].version}: {len(rows)} images")
    print(f"no worse than JPEG {kept}, at most {LARGEST_EXCESS_DB:g} dB worse {near}")
    print(f"error relative to JPEG: median {middle:+.1f} dB, lowest tenth {low:+.1f}, highest tenth {high:+.1f}")
    worst = max(rows, key=lambda row: row.excess_db)
    print(f"square with the largest error: median {np.median([row.worst_block_db for row in rows]):+.1f} dB")
    print(f"worst {worst.excess_db:+.1f} dB: {worst.case}, {worst.floor}, {worst.method}")
    print(f"chosen for: {dict(Counter(row.method for row in rows))} images")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--looks", nargs="*", choices=LOOKS, default=list(LOOKS))
    parser.add_argument("--draws", type=int, default=30, help="of extreme")
    parser.add_argument("--judged", type=int, default=3, help="views of each case that are judged")
    parser.add_argument("--samples", type=int, default=1024, help="of each reference")
    parser.add_argument("--size", nargs=2, type=int, default=[320, 240], metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--method", choices=["auto", "hybrid"], default="auto")
    parser.add_argument("--device", choices=["cpu", "auto", "gpu"], default="cpu", help="of the references")
    parser.add_argument("--seed", type=int, default=secrets.randbelow(2**31), help="of the draws; default: a new one")
    parser.add_argument("--beside", type=Path, help="sources of another version, which is judged as well")
    parser.add_argument("--out", type=Path, help="JSON file of the rows")
    parser.add_argument("--sheet", type=Path, help="PNG file of the places with the largest errors")
    options = parser.parse_args()
    print(f"seed {options.seed}", flush=True)
    device = device_for(options.device)
    options.versions = {"this": CHECKOUT} | ({"beside": options.beside.resolve()} if options.beside else {})
    rows: list[Row] = []
    places: dict[str, WorstPlace] = {}
    for case in random_cases(options.looks, options.draws, options.seed):
        pairs = rows_of(case, options, device)
        rows += [row for row, _ in pairs]
        numbers = [1 + place % options.judged for place in range(len(pairs))]
        named = zip(numbers, pairs, strict=True)
        places |= {f"{row.case} {number} {row.method} {row.version}": place for number, (row, place) in named}
        for version in options.versions:
            print_case([row for row, _ in pairs if row.version == version])
        if options.out:
            text = json.dumps({"seed": options.seed, "rows": [asdict(row) for row in rows]}, indent=1)
            options.out.write_text(text + "\n")
        if options.sheet:
            cv2.imwrite(str(options.sheet), sheet(places))
    for version in options.versions:
        print_summary([row for row in rows if row.version == version])


if __name__ == "__main__":
    main()
