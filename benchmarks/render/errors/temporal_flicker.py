"""How much images flicker from one to the next: hybrid and full rendering, beside a plain Cycles loop.

Cases are one draw of each shipped look and several draws of `extreme`, with a new seed each time, seen by a camera of
random place, direction and pitch. Each place has three images: two of the same pose, and one after the robot has moved
on by 32 mm and turned by 3 degrees. All are compared in grey values of 8 bits, without the noise of the camera.

- still: everything in which the two images of the same pose differ.
- moving: the change of the error from one pose to the next, where the error of the first image is carried along with
  the surface that it is seen on. So an error that stays at its place on a surface does not count. Errors are
  differences from two references of complete light paths with independent random numbers and without a denoiser, and
  the square of the flicker is the mean product of both, so that their noise cancels.

    python -m benchmarks.render.errors.temporal_flicker [--draws 4] [--looks classroom lab] [--places 2]
        [--samples 64] [--size 160 120] [--plain 1 2 4 8] [--seed N] [--threads 1] [--beside FOLDER]
        [--out flicker.json]

The plain loop is rendered with several numbers of samples, so that one of them costs about as much as hybrid
rendering. Its cost, and that of the others, is that of the images only; for hybrid rendering, maps exist already, and
the cost of the maps for these places is printed beside it. `--beside` judges hybrid rendering of another version as
well, whose sources are in that folder.
"""

import argparse
import json
import os
import secrets
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import cv2
import numpy as np

from benchmarks.render.contenders.plain_loop import BLENDERS_DEFAULT
from benchmarks.render.contenders.render_process import CHECKOUT, RenderProcess
from benchmarks.render.references.reference_set import Judged, Pairs
from benchmarks.render.references.views import LOOKS, Views, random_cases
from benchmarks.render.references.worst_places import BLOCK_PX
from blender_scenes.preview.rasteriser import rasterise
from blender_scenes.preview.triangles import Triangles
from blender_scenes.render.image_errors import reference_differences
from blender_scenes.render.job import RenderJob
from blender_scenes.render.sampling import hybrid_samples, tracing_settings
from blender_scenes.render.standard_error import standard_error
from configs.schema.scenario import Render
from sensors.camera.metering import median_luminance
from sensors.camera.response import develop_part
from sensors.camera.views import FrameView
from symolo.core.arrays import Array, FloatImage
from symolo.core.geometry.pinhole import Intrinsics, project
from symolo.core.geometry.poses import pose_X_WR

_SEEDS = (101, 202)
"""Of the two references."""
_SAME_DEPTH = 0.02
"""Share of the depth by which two depths of one point of a surface may differ."""
HYBRID = "hybrid"


@dataclass(frozen=True)
class Flicker:
    """Root mean squares, in grey values of 8 bits."""

    still: float
    worst_still: float
    """Flicker of the square of `BLOCK_PX` x `BLOCK_PX` pixels that flickers most."""
    moving: float
    moving_error: float
    """Standard error by the noise of the references."""


@dataclass(frozen=True)
class Row:
    case: str
    floor: str
    contender: str
    flicker: Flicker
    image_s: float
    """Core-seconds for an image; for hybrid rendering, without maps."""
    maps_s: float
    """Core-seconds for the maps of these places."""
    camera: float
    """Still flicker that the noise of the camera adds to images without any."""


@dataclass(frozen=True)
class Contender:
    name: str
    job: RenderJob
    settings: dict[str, object]
    checkout: Path = CHECKOUT


@dataclass(frozen=True)
class Rendered:
    by_view: Mapping[int, FloatImage]
    image_s: float
    maps_s: float


def contenders(views: Views, options: argparse.Namespace) -> Iterator[Contender]:
    width_px, height_px = options.size
    for method in (HYBRID, "full"):
        render = Render(method=method, width_px=width_px, height_px=height_px)
        job = replace(views.job, sampling=tracing_settings(render, views.job.sampling.seed))
        hybrid = asdict(hybrid_samples(render)) if method == HYBRID else None
        name = method if method == HYBRID else f"full, {job.sampling.samples} samples"
        yield Contender(name, job, {"kind": "ours", "hybrid": hybrid})
        if options.beside and method == HYBRID:
            yield Contender(f"{name} beside", job, {"kind": "ours", "hybrid": hybrid}, options.beside.resolve())
    for samples in options.plain:
        cycles = {**BLENDERS_DEFAULT, "samples": samples}
        yield Contender(f"plain loop, {samples} samples", views.job, {"kind": "plain", "cycles": cycles})


def rendered(contender: Contender, numbers: list[int], threads: int) -> Rendered:
    """Return the light of the views, after one, or for hybrid rendering all, was rendered to warm up."""
    with RenderProcess(
        "cycles_process.py", contender.job, contender.settings, threads, sys.executable, checkout=contender.checkout
    ) as process:
        has_maps = contender.name.startswith(HYBRID)
        first = process.render(numbers if has_maps else numbers[:1], warm_up=True)
        cost = process.render(numbers)
        by_view = {number: process.light(number) for number in numbers}
        return Rendered(by_view, cost.core_s / len(numbers), max(first.core_s - cost.core_s, 0.0) if has_maps else 0.0)


def flicker(views: Views, lights: Mapping[int, FloatImage], references: Pairs, metered: float) -> Flicker:
    """Return the flicker over all places; `lights` are by the number of the view."""
    by_number = {view.number: view for view in views.job.frames}
    places = [tuple(sorted(by_number)[start : start + 3]) for start in range(0, len(by_number), 3)]
    still = np.stack([still_difference(views, lights[first], lights[again], metered) for first, again, _ in places])
    changes = [
        error_changes(views, (by_number[again], by_number[moved]), lights, references, metered)
        for _, again, moved in places
    ]
    squares = [float(np.mean(first * second)) for first, second in changes]
    uncertain = float(np.linalg.norm([standard_error(pair) for pair in changes])) / len(places)
    moving = max(float(np.mean(squares)), 0.0) ** 0.5
    return Flicker(
        still=float(np.sqrt(np.mean(still**2))),
        worst_still=max(worst_square(difference) for difference in still),
        moving=moving,
        # Of the root of a mean that is not much larger than its error.
        moving_error=uncertain / (2 * max(moving, uncertain**0.5)) if uncertain else 0.0,
    )


def still_difference(views: Views, first: FloatImage, again: FloatImage, metered: float) -> FloatImage:
    """Return the difference (H, W, 3) of two images in grey values."""
    one, other = (develop_part(light, views.job.response, metered, None) for light in (first, again))
    return np.clip(other, 0, 255) - np.clip(one, 0, 255)


def error_changes(
    views: Views,
    pair: tuple[FrameView, FrameView],
    lights: Mapping[int, FloatImage],
    references: Pairs,
    metered: float,
) -> list[FloatImage]:
    """Return for each reference how the error (H, W, 3) has changed from one view to the other; 0 where unknown."""
    before, after = pair
    columns, rows, known = carried_from(views.job, before, after)
    errors = [
        reference_differences(lights[view.number], references[view.number], views.job.response, metered)
        for view in pair
    ]
    # The pixels that are not known are left out of the mean: the others count as many times as there are pixels.
    weight = np.float32(np.sqrt(known.size / max(np.count_nonzero(known), 1)))
    return [
        np.where(known[..., None], (here - carried(there, columns, rows)) * weight, 0).astype(np.float32)
        for there, here in zip(*errors, strict=True)
    ]


def carried(image: FloatImage, columns: FloatImage, rows: FloatImage) -> FloatImage:
    """Return the image (H, W, 3) at places; a filter of 8 x 8 pixels keeps most of the variance of noise."""
    at_places = cv2.remap(image, columns, rows, cv2.INTER_LANCZOS4, borderMode=cv2.BORDER_REPLICATE)
    return at_places.astype(np.float32, copy=False)


def carried_from(job: RenderJob, before: FrameView, after: FrameView) -> tuple[FloatImage, FloatImage, np.ndarray]:
    """Return where each pixel's surface was in the view before: columns and rows (H, W), and where it was visible."""
    camera = job.camera
    depth_before, depth_after = (depth_m(job, view) for view in (before, after))
    return reprojected(camera, (np.array(before.X_WC), depth_before), (np.array(after.X_WC), depth_after))


def reprojected(
    camera: Intrinsics, before: tuple[Array, Array], after: tuple[Array, Array]
) -> tuple[FloatImage, FloatImage, np.ndarray]:
    """Return the same for two poses X_WC of a camera without distortion, each with its depth (H, W)."""
    (X_WC, seen_m), (X_after, depth) = before, after
    row, column = np.mgrid[: camera.height_px, : camera.width_px]
    rays = np.stack([(column - camera.cx_px) / camera.fx_px, (row - camera.cy_px) / camera.fy_px, np.ones(row.shape)])
    finite = np.where(np.isfinite(depth), depth, 0)
    points = np.moveaxis(rays * finite, 0, -1) @ X_after[:3, :3].T + X_after[:3, 3]
    pixels, there_m = project(camera, X_WC, points.reshape(-1, 3))
    columns, rows = pixels.reshape(*depth.shape, 2).astype(np.float32).transpose(2, 0, 1)
    there_m = there_m.reshape(depth.shape)
    inside = (columns >= 0) & (columns <= camera.width_px - 1) & (rows >= 0) & (rows <= camera.height_px - 1)
    known = inside & np.isfinite(depth) & (there_m > 0)
    seen = seen_m[np.where(known, np.rint(rows), 0).astype(int), np.where(known, np.rint(columns), 0).astype(int)]
    known &= np.abs(seen - there_m) < _SAME_DEPTH * np.where(known, there_m, 1)
    return columns, rows, known


def depth_m(job: RenderJob, view: FrameView) -> Array:
    """Return the depth (H, W) of what a view shows; infinite for the sky."""
    scene = job.scene
    numbers = {surface.name: number for number, surface in enumerate(scene.surfaces)}
    moving = [
        Triangles.from_meshes((mesh,), numbers).placed(pose_X_WR(*pose))
        for mesh, pose in zip(scene.moving, view.moving, strict=True)
    ]
    robot = Triangles.from_meshes(scene.robot_in_sight, numbers).placed(pose_X_WR(*view.robot_pose))
    triangles = Triangles.joined([Triangles.from_meshes(scene.meshes, numbers), robot, *moving])
    return rasterise(job.camera, np.array(view.X_WC), triangles).depth_m


def worst_square(difference: FloatImage) -> float:
    """Return the root mean square of the square of pixels with the largest one."""
    return float(np.sqrt(cv2.blur(difference**2, (BLOCK_PX, BLOCK_PX)).mean(axis=-1).max()))


def camera_flicker(views: Views, light: FloatImage, metered: float) -> float:
    """Return the still flicker that camera noise adds to an image of a view."""
    noisy = views.noisy().response
    one, other = (develop_part(light, noisy, metered, number) for number in (1, 2))
    return float(np.sqrt(np.mean((other - one) ** 2)))


def rows_of(case: str, views: Views, floor: str, options: argparse.Namespace) -> Iterator[Row]:
    numbers = [view.number for view in views.job.frames]
    compared = [number for place, number in enumerate(numbers) if place % 3]
    references = Judged(views, compared, options.threads, "CPU").references(options.samples, _SEEDS)
    light = np.concatenate([light.reshape(-1, 3) for pair in references.values() for light in pair])
    metered = median_luminance(light)
    calm = np.mean(references[compared[0]], axis=0)
    for contender in contenders(views, options):
        seen = rendered(contender, numbers, options.threads)
        measured = flicker(views, seen.by_view, references, metered)
        camera = camera_flicker(views, calm, metered)
        yield Row(case, floor, contender.name, measured, seen.image_s, seen.maps_s, camera)


def print_row(row: Row) -> None:
    one = row.flicker
    print(
        f"{row.case:12} {row.floor:13} {row.contender:22} still {one.still:5.2f}, worst square {one.worst_still:5.1f};"
        f" moving {one.moving:5.2f} +- {one.moving_error:4.2f}; camera {row.camera:4.2f};"
        f" {row.image_s:5.2f} core-s, maps {row.maps_s:4.1f}",
        flush=True,
    )


def print_summary(rows: Sequence[Row]) -> None:
    print(f"\nmedians of {len({row.case for row in rows})} cases, in grey values of 8 bits")
    print(f"{'':22} {'still':>6} {'worst square':>13} {'moving':>7} {'core-s':>7}")
    for name in dict.fromkeys(row.contender for row in rows):
        these = [row for row in rows if row.contender == name]
        columns = [[r.flicker.still, r.flicker.worst_still, r.flicker.moving, r.image_s] for r in these]
        still, worst, moving, image_s = np.median(columns, axis=0)
        print(f"{name:22} {still:6.2f} {worst:13.1f} {moving:7.2f} {image_s:7.2f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--looks", nargs="*", choices=LOOKS, default=list(LOOKS))
    parser.add_argument("--draws", type=int, default=4, help="of extreme")
    parser.add_argument("--places", type=int, default=2, help="of each case")
    parser.add_argument("--samples", type=int, default=64, help="of each reference")
    parser.add_argument("--size", nargs=2, type=int, default=[160, 120], metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--plain", nargs="*", type=int, default=[1, 2, 4, 8], help="samples of the plain loop")
    parser.add_argument("--threads", type=int, default=os.cpu_count(), help="of each process")
    parser.add_argument("--seed", type=int, default=secrets.randbelow(2**31), help="of the draws; default: a new one")
    parser.add_argument("--beside", type=Path, help="sources of another version")
    parser.add_argument("--out", type=Path, help="JSON file of the rows")
    options = parser.parse_args()
    print(f"seed {options.seed}", flush=True)
    rows: list[Row] = []
    for case in random_cases(options.looks, options.draws, options.seed):
        size = (options.size[0], options.size[1])
        views, floor = case.repeated_views(options.places, size), case.spec(size).look.floor.material
        for row in rows_of(case.name, views, floor, options):
            rows.append(row)
            print_row(row)
        if options.out:
            text = json.dumps({"seed": options.seed, "rows": [asdict(row) for row in rows]}, indent=1)
            options.out.write_text(text + "\n")
    print_summary(rows)


if __name__ == "__main__":
    main()
