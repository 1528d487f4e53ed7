"""Whether images of long runs keep the promise of `render.method: auto`, under looks that nobody has seen before.

Cases are one draw of each shipped look and several draws of `extreme`, with a new seed each time, seen by a camera of
random place, direction and pitch. Each case is a run of several views. The renderer chooses method and samples as for a
run of 200 images, which must have 160 x 120 pixels at least, from measurements on some of the views; it is judged on
the others. Their error is the mean product of the differences from two references of complete light paths, with
independent random numbers and without a denoiser, beside the error that JPEG adds to the image with the noise of its
camera. The references have 128 samples, and up to `--samples` where their noise is larger than a tenth of that error.

    python -m benchmarks.render.errors.fresh_draws [--draws 30] [--looks classroom lab] [--judged 3] [--samples 1024]
        [--size 320 240] [--method auto] [--device cpu] [--choose-on-card] [--seed N] [--beside FOLDER] [--plain]
        [--processes N] [--stop-after SECONDS] [--out draws.json] [--sheet worst.png] [--images FOLDER]

`--method hybrid` judges hybrid rendering, whatever a run would choose; with `auto hybrid` both are judged. `--beside`
judges another version of the renderer as well, in the same views, with the same references and with light paths as this
version sets them; it takes the folder of its sources, such as `git worktree add` makes. `--plain` finds the plain
Cycles loop with the fewest samples whose error is no larger than that of the judged images, and its cost in a run of
200 images. `--sheet` shows the place with the largest error of each image, four times as large, beside the same place
of the reference, and `--images` keeps the whole images beside their references. `--device gpu` traces references, and
images of the plain loop whose error is measured, on a graphics card; the images that are judged come from the
processor. With `--choose-on-card`, the errors of full rendering from which a run chooses come from the card as well,
and the cost does not include this choice. `--processes` judges so many cases at a time, and `--stop-after` starts no
case after that time.
"""

import argparse
import json
import os
import secrets
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import cv2
import numpy as np

from benchmarks.render.contenders.plain_loop import RUN_FRAMES, RunCost, fewest_samples, plain_cost, plain_lights
from benchmarks.render.contenders.render_process import CHECKOUT, RenderProcess
from benchmarks.render.references.reference_set import Judged, ReferenceSet, sufficient_references
from benchmarks.render.references.views import LOOKS, RandomCase, Views, random_cases
from benchmarks.render.references.worst_places import WorstPlace, beside_reference, sheet, worst_place
from blender_scenes.render.devices import DeviceKind, device_for
from blender_scenes.render.image_errors import ImageError
from blender_scenes.render.job import RenderJob
from blender_scenes.render.probe import MIN_VIEWS, Decision, probed_numbers
from blender_scenes.render.sampling import tracing_settings
from configs.schema.scenario import Render
from sensors.camera.colour import LUMINANCE
from symolo.core.arrays import FloatImage

LARGEST_EXCESS_DB = 1.0
"""The promise for a single image."""


@dataclass(frozen=True)
class Row:
    """One view that was not probed."""

    case: str
    number: int
    """Number of the view in its case."""
    version: str
    """`this`, or `beside` for the sources of `--beside`; and ` hybrid` where hybrid rendering was asked for."""
    floor: str
    method: str
    """Hybrid, or the number of samples."""
    worst_block_db: float
    """Error of the worst square of `BLOCK_PX` x `BLOCK_PX` pixels, relative to JPEG's in the whole view."""
    measured_db: tuple[float, ...]
    """Error of the rendering relative to that of JPEG in the views that the run measured; empty without a choice."""
    reference_samples: int | None
    """Samples of each reference of the run's choice."""
    limit_db: float | None
    """Error relative to JPEG that one view of twenty is expected to exceed."""
    excess_db: float
    """Error of the whole view relative to JPEG; negative where the rendering is better than JPEG."""
    standard_error: float
    """Standard error of that error by the noise of the references, as a multiple of JPEG's error."""
    psnr_db: float
    jpeg_psnr_db: float
    light: float
    """Mean luminance, relative to the references'."""
    core_s: float
    """Without what `set_up_s` has."""
    set_up_s: float
    """Core-seconds for the start, the scene and the choice."""
    plain_db: Mapping[int, float]
    """Error of the plain loop relative to JPEG's by the number of samples."""
    plain_samples: int | None
    """Fewest samples of the plain loop whose error over the judged views of the case is no larger."""
    plain_core_s: float | None
    """Cost of the plain loop with so many samples for one image of a run, everything included."""
    ratio: float | None
    """Ratio of this cost to that of the rendering."""


@dataclass(frozen=True)
class Lights:
    """The light of the judged views, as a long run renders it."""

    by_view: Mapping[int, FloatImage]
    decision: Decision | None
    """What the run chose; None if hybrid rendering is not its choice."""
    cost: RunCost

    @property
    def method(self) -> str:
        full = self.decision and self.decision.full
        return f"{full.samples} samples" if full else "hybrid"


@dataclass(frozen=True)
class JudgedImage:
    row: Row
    place: WorstPlace
    shown: np.ndarray
    """Image (h, w, 3), RGB: the rendering, and its reference at its right."""


def judged_case(case: RandomCase, options: argparse.Namespace, device: DeviceKind) -> list[JudgedImage]:
    views = case.views(MIN_VIEWS + options.judged, tuple(options.size))
    probed = probed_numbers(len(views.job.frames))
    numbers = [view.number for place, view in enumerate(views.job.frames) if place not in probed]
    lights = {
        version + " hybrid" * (method == "hybrid"): chosen_lights(views, numbers, method, options, at)
        for version, at in options.versions.items()
        for method in options.method
    }
    reference_set = sufficient_references(
        Judged(views, numbers, options.threads, device), [each.by_view for each in lights.values()], options.samples
    )
    plain = plain_lights(views.job, numbers, options.threads, device) if options.plain else {}
    plain_errors = {
        samples: reference_set.mean_error({number: plain[number][samples] for number in numbers})
        for samples in next(iter(plain.values()), {})
    }
    images = []
    for version, seen in lights.items():
        samples = fewest_samples(plain_errors, reference_set.mean_error(seen.by_view))
        rival = None if samples is None else plain_cost(views.job, numbers, options.threads, samples)
        for number in numbers:
            image = judged_image(case, reference_set, number, version, seen)
            row = replace(
                image.row,
                plain_db={
                    n: excess_dB(reference_set.error(number, light)) for n, light in plain.get(number, {}).items()
                },
                plain_samples=samples,
                plain_core_s=rival and round(rival.per_image_s, 3),
                ratio=rival and round(rival.per_image_s / seen.cost.per_image_s, 3),
            )
            images.append(replace(image, row=row))
    return images


def judged_image(case: RandomCase, reference_set: ReferenceSet, number: int, version: str, seen: Lights) -> JudgedImage:
    """Return a view with its errors, which are not yet compared with those of the plain loop."""
    light, pair, job = seen.by_view[number], reference_set.references[number], reference_set.judged.views.job
    errors = seen.decision and seen.decision.errors
    error = reference_set.error(number, light)
    place = worst_place(light, pair, job.response, reference_set.metered)
    brightness = [float((each @ LUMINANCE).mean()) for each in (light, *pair)]
    row = Row(
        case=case.name,
        number=number,
        version=version,
        floor=case.spec((job.camera.width_px, job.camera.height_px)).look.floor.material,
        method=seen.method,
        worst_block_db=decibels(max(place.mean_square, 0.01) / error.jpeg),
        measured_db=tuple(round(each, 2) for each in errors.relative_dB) if errors else (),
        reference_samples=seen.decision and seen.decision.reference_samples,
        limit_db=round(errors.limit_dB, 2) if errors else None,
        excess_db=excess_dB(error),
        standard_error=round(error.standard_error / error.jpeg, 3),
        psnr_db=decibels(255**2 / error.rendering),
        jpeg_psnr_db=decibels(255**2 / error.jpeg),
        light=brightness[0] / float(np.mean(brightness[1:])),
        core_s=round(seen.cost.image_s, 2),
        set_up_s=round(seen.cost.set_up_s, 1),
        plain_db={},
        plain_samples=None,
        plain_core_s=None,
        ratio=None,
    )
    return JudgedImage(row, place, beside_reference(light, pair, job.response, reference_set.metered))


def chosen_lights(views: Views, numbers: list[int], method: str, options: argparse.Namespace, checkout: Path) -> Lights:
    """Return the light of the views as a long run of a version renders them, with what it chose."""
    width_px, height_px = options.size
    noisy = views.noisy()
    chooses = method == "auto"
    render = Render(method=method, width_px=width_px, height_px=height_px)
    job = replace(noisy, sampling=tracing_settings(render, noisy.sampling.seed, images=RUN_FRAMES))
    decision = None
    if chooses and options.choose_on_card:
        decision = decision_on_card(job, options, checkout)
        job = replace(job, sampling=decision.applied(job.sampling))
    sampling = job.sampling
    settings = {"kind": "ours", "hybrid": sampling.hybrid and asdict(sampling.hybrid)}
    if sampling.probe:
        settings = {"kind": "chosen", "run_images": RUN_FRAMES}
    with RenderProcess(
        "cycles_process.py", job, settings, options.threads, sys.executable, checkout=checkout
    ) as process:
        cost = process.render(numbers)
        decision = process.decision() if sampling.probe else decision
        by_view = {number: process.light(number) for number in numbers}
        return Lights(by_view, decision, RunCost(process.set_up.core_s, cost.core_s / len(numbers)))


def decision_on_card(job: RenderJob, options: argparse.Namespace, checkout: Path) -> Decision:
    job = replace(job, sampling=replace(job.sampling, device=options.card))
    settings = {"kind": "choice", "run_images": RUN_FRAMES}
    with RenderProcess(
        "cycles_process.py", job, settings, options.threads, sys.executable, checkout=checkout
    ) as process:
        return process.decision()


def decibels(ratio: float) -> float:
    return round(float(10 * np.log10(max(ratio, 1e-9))), 2)


def excess_dB(error: ImageError) -> float:
    return decibels(error.rendering / error.jpeg)


def judged_cases(
    cases: list[RandomCase], options: argparse.Namespace, device: DeviceKind
) -> Iterator[list[JudgedImage]]:
    """Judge several cases at a time; those that fail are printed."""
    start = time.monotonic()

    def judged(case: RandomCase) -> list[JudgedImage]:
        in_time = options.stop_after is None or time.monotonic() - start < options.stop_after
        return judged_case(case, options, device) if in_time else []

    with ThreadPoolExecutor(options.processes) as pool:
        by_future = {pool.submit(judged, case): case for case in cases}
        for future in as_completed(by_future):
            try:
                yield future.result()
            except ChildProcessError as error:
                print(f"{by_future[future].name}: {error}", flush=True)


def print_case(rows: list[Row]) -> None:
    excess = ", ".join(f"{row.excess_db:+.1f}" for row in rows)
    blocks = ", ".join(f"{row.worst_block_db:+.1f}" for row in rows)
    noise = ", ".join(f"{row.standard_error:.2f}" for row in rows)
    one = rows[0]
    limit = f"limit {one.limit_db}, references of {one.reference_samples}"
    measured = ", ".join(f"{each:+.1f}" for each in one.measured_db)
    plain = f"; plain loop {one.plain_samples} samples, cost ratio {one.ratio}" if one.plain_db else ""
    print(
        f"{one.case:12} {one.version} {one.floor:13} {one.method:11} measured {measured} dB,"
        f" {limit}, seen {excess} dB, uncertain by {noise} of JPEG; worst squares {blocks} dB;"
        f" JPEG {one.jpeg_psnr_db:.1f} dB; light {one.light:.3f}; {one.core_s:.1f} core-s after {one.set_up_s:.0f}"
        f"{plain}",
        flush=True,
    )


def print_summary(rows: list[Row]) -> None:
    excess = np.array([row.excess_db for row in rows])
    within, near = np.count_nonzero(excess <= 0), np.count_nonzero(excess <= LARGEST_EXCESS_DB)
    low, middle, high = np.quantile(excess, [0.1, 0.5, 0.9])
    print(f"\n{rows[0].version}: {len(rows)} images")
    print(f"no worse than JPEG {within}, at most {LARGEST_EXCESS_DB:g} dB worse {near}")
    print(f"error relative to JPEG: median {middle:+.1f} dB, lowest tenth {low:+.1f}, highest tenth {high:+.1f}")
    worst = max(rows, key=lambda row: row.excess_db)
    print(f"square with the largest error: median {np.median([row.worst_block_db for row in rows]):+.1f} dB")
    print(f"worst {worst.excess_db:+.1f} dB: {worst.case}, {worst.floor}, {worst.method}")
    print(f"chosen for: {dict(Counter(row.method for row in rows))} images")
    ratios = list({row.case: row.ratio for row in rows if row.ratio is not None}.values())
    if ratios:
        print(
            f"cost of the plain loop at equal error: median {np.median(ratios):.2f}, smallest {min(ratios):.2f} times"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--looks", nargs="*", choices=LOOKS, default=list(LOOKS))
    parser.add_argument("--draws", type=int, default=30, help="of extreme")
    parser.add_argument("--judged", type=int, default=3, help="views of each case that are judged")
    parser.add_argument("--samples", type=int, default=1024, help="largest number, of each reference")
    parser.add_argument("--size", nargs=2, type=int, default=[320, 240], metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--threads", type=int, default=os.cpu_count(), help="of each process")
    parser.add_argument("--processes", type=int, default=1, help="cases that are judged at a time")
    parser.add_argument("--stop-after", type=float, metavar="SECONDS", help="start no case after that time")
    parser.add_argument("--method", nargs="+", choices=["auto", "hybrid"], default=["auto"])
    parser.add_argument("--plain", action="store_true", help="compare the cost with that of a plain Cycles loop")
    parser.add_argument("--device", choices=["cpu", "auto", "gpu"], default="cpu", help="of the references")
    words = "measure the errors for the choice on the card too, without their cost"
    parser.add_argument("--choose-on-card", action="store_true", help=words)
    parser.add_argument("--seed", type=int, default=secrets.randbelow(2**31), help="of the draws; default: a new one")
    parser.add_argument("--beside", type=Path, help="sources of another version, which is judged as well")
    parser.add_argument("--out", type=Path, help="JSON file of the rows")
    parser.add_argument("--sheet", type=Path, help="PNG file of the places with the largest errors")
    parser.add_argument("--images", type=Path, help="folder for the images beside their references")
    options = parser.parse_args()
    print(f"seed {options.seed}", flush=True)
    device = options.card = device_for(options.device)
    options.versions = {"this": CHECKOUT} | ({"beside": options.beside.resolve()} if options.beside else {})
    cases = random_cases(options.looks, options.draws, options.seed)
    images: list[JudgedImage] = []
    for judged in judged_cases(cases, options, device):
        images += judged
        keep(images, judged, options)
        for version in dict.fromkeys(image.row.version for image in judged):
            print_case([image.row for image in judged if image.row.version == version])
    for version in dict.fromkeys(image.row.version for image in images):
        print_summary([image.row for image in images if image.row.version == version])


def keep(images: list[JudgedImage], new: list[JudgedImage], options: argparse.Namespace) -> None:
    """Write the files that the options name, after each case, so that a stop loses little."""
    if options.out:
        text = json.dumps({"seed": options.seed, "rows": [asdict(image.row) for image in images]}, indent=1)
        options.out.write_text(text + "\n")
    if options.sheet and new:
        cv2.imwrite(str(options.sheet), sheet({named(image.row): image.place for image in images}))
    if options.images:
        options.images.mkdir(parents=True, exist_ok=True)
        for image in new:
            file = options.images / f"{named(image.row).replace(' ', '_')}.png"
            cv2.imwrite(str(file), image.shown[..., ::-1])


def named(row: Row) -> str:
    return f"{row.case} {row.number} {row.method} {row.version}"


if __name__ == "__main__":
    main()
