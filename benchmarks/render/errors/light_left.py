"""Share of the light that limited light paths leave, compared with complete ones, and what each costs.

Cases are one draw of each shipped look and several draws of `extreme`, with a new seed each time, seen by a camera of
random place, direction and pitch. All settings trace the same views with the same random numbers, without denoiser, and
the table has the ratio of the mean luminance over all views of a case. Its standard error comes from independent seeds.
With `--denoised`, it also has the light of the denoised images of both presets, and with `--hybrid` that of their
hybrid images of `standard` quality, with other maps for each seed.

    python -m benchmarks.render.errors.light_left [--draws 30] [--poses 3] [--seeds 4] [--samples 8] [--seed N]
        [--size 64 48] [--clamps 4 16 64] [--bounces 8 32] [--denoised] [--hybrid] [--out light.json]
"""

import argparse
import json
import secrets
import sys
import tempfile
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.render.contenders.child_side import reply_stream
from benchmarks.render.references.views import LOOKS, RandomCase, Views, random_cases
from blender_scenes.blender_side.loading import load_bpy
from blender_scenes.render.light_paths import LIGHT_PATHS, LightPathLimits
from blender_scenes.render.sampling import hybrid_samples
from configs.schema.scenario import Render
from sensors.camera.colour import LUMINANCE
from symolo.core.arrays import Array

COMPLETE = "complete"
IN_UNITS_OF_LIGHT = {"diffuse_bounces": 3, "glossy_bounces": 3, "sample_clamp_indirect": 1.0}
"""Properties of Cycles in 0.2: three bounces and a limit of 1000 cd/m2, whatever the exposure."""
MAX_DEVIATION = 0.03
"""Largest deviation of the share of light from 1 for the preset `standard` (docs/rendering.md)."""


@dataclass(frozen=True)
class Setting:
    name: str
    paths: LightPathLimits
    cycles: dict[str, Any]
    """Properties of Cycles in place of those of `paths`."""
    denoise: bool = False
    hybrid: bool = False


@dataclass(frozen=True)
class Row:
    """One setting in one case."""

    case: str
    floor: str
    light: str
    setting: str
    share: float
    """Mean luminance, relative to that of complete light paths."""
    standard_error: float
    core_s: float


def settings(options: argparse.Namespace) -> list[Setting]:
    standard = LIGHT_PATHS["standard"]
    chosen = [Setting("as in 0.2", standard, IN_UNITS_OF_LIGHT), Setting("standard", standard, {})]
    chosen += [Setting(f"clamp {clamp:g}", replace(standard, clamp=clamp), {}) for clamp in options.clamps]
    for number in options.bounces:
        fewer = replace(standard, diffuse_bounces=number, glossy_bounces=number, transmission_bounces=number, clamp=0.0)
        chosen.append(Setting(f"{number} bounces, no clamp", fewer, {}))
    if options.denoised:
        chosen += [Setting(f"{preset}, denoised", paths, {}, denoise=True) for preset, paths in LIGHT_PATHS.items()]
    if options.hybrid:
        chosen += [Setting(f"{preset}, hybrid", paths, {}, hybrid=True) for preset, paths in LIGHT_PATHS.items()]
    return [*chosen, Setting(COMPLETE, LIGHT_PATHS[COMPLETE], {})]


def mean_luminance(views: Views, setting: Setting, options: argparse.Namespace, scratch: Path) -> tuple[Array, float]:
    """Return the mean luminance (seeds, poses) of the views under a setting, and the core-seconds of an image."""
    import bpy  # noqa: PLC0415 - it must not be loaded before `load_bpy`

    from blender_scenes.blender_side import build, engine  # noqa: PLC0415 - they import bpy

    sampling = replace(views.job.sampling, paths=setting.paths, denoise=setting.denoise, samples=options.samples)
    if setting.hybrid:
        width, height = options.size
        sampling = replace(sampling, hybrid=hybrid_samples(Render(method="hybrid", width_px=width, height_px=height)))
    job = replace(views.job, sampling=sampling)
    build.start()
    build.build(job.scene, job.camera, caustics=setting.paths.caustics)
    engine.configure(job, 1, scratch)
    first = engine.FrameTracer(job, 1, scratch)
    first.light(job.frames[0])  # prepares the scene, which is not timed
    means, begin = [], time.process_time()
    for seed in range(options.seeds):
        tracer = engine.FrameTracer(replace(job, sampling=replace(sampling, seed=seed)), 1, scratch, first.metered)
        for name, value in setting.cycles.items():
            setattr(bpy.context.scene.cycles, name, value)
        means.append([float((tracer.light(view) @ LUMINANCE).mean()) for view in job.frames])
    return np.array(means), (time.process_time() - begin) / np.size(means)


def share(means: Array, complete: Array) -> tuple[float, float]:
    """Return the ratio of two means of (seeds, poses), and its standard error by the jackknife over the seeds.

    Both have the same random numbers, so that most of their noise cancels.
    """
    one, other = means.sum(axis=1), complete.sum(axis=1)
    count = len(one)
    without_one = (one.sum() - one) / (other.sum() - other)
    error = np.sqrt((count - 1) / count * ((without_one - without_one.mean()) ** 2).sum())
    return float(one.sum() / other.sum()), float(error)


def rows_of(case: RandomCase, options: argparse.Namespace, scratch: Path) -> list[Row]:
    views, spec = case.views(options.poses, tuple(options.size)), case.spec(tuple(options.size))
    by_name = {setting.name: mean_luminance(views, setting, options, scratch) for setting in settings(options)}
    complete, _ = by_name[COMPLETE]
    light = f"sun {spec.look.sun.illuminance_klx:.1f} klx, {spec.look.window.covering}"
    return [
        Row(case.name, spec.look.floor.material, light, name, *share(means, complete), core_s)
        for name, (means, core_s) in by_name.items()
    ]


def print_case(rows: list[Row]) -> None:
    shares = "  ".join(f"{row.setting} {100 * row.share:.1f}+-{100 * row.standard_error:.1f}" for row in rows)
    print(f"{rows[0].case:12} {rows[0].floor:13} {rows[0].light:22} {shares}", flush=True)


def print_summary(rows: list[Row]) -> None:
    complete_s = np.mean([row.core_s for row in rows if row.setting == COMPLETE])
    print(f"\n{'setting':22} {'lowest':>7} {'median':>7} {'highest':>8}  within 3 %  time of `complete`")
    for name in dict.fromkeys(row.setting for row in rows):
        setting_rows = [row for row in rows if row.setting == name]
        shares = np.array([row.share for row in setting_rows])
        inside = np.count_nonzero(np.abs(shares - 1) <= MAX_DEVIATION)
        low, middle, high = 100 * np.quantile(shares, [0, 0.5, 1])
        cost = np.mean([row.core_s for row in setting_rows]) / complete_s
        print(f"{name:22} {low:6.1f}% {middle:6.1f}% {high:7.1f}%  {inside} of {len(shares)}   {cost:.2f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--looks", nargs="*", choices=LOOKS, default=list(LOOKS))
    parser.add_argument("--draws", type=int, default=30, help="draws of the look extreme")
    parser.add_argument("--poses", type=int, default=3)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--samples", type=int, default=8, help="samples of each image")
    parser.add_argument("--size", nargs=2, type=int, default=[64, 48], metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--clamps", nargs="*", type=float, default=[], help="further limits, in multiples of white")
    parser.add_argument("--bounces", nargs="*", type=int, default=[], help="further numbers of bounces")
    parser.add_argument("--denoised", action="store_true", help="also the light of denoised images")
    parser.add_argument("--hybrid", action="store_true", help="also the light of hybrid images")
    parser.add_argument(
        "--seed", type=int, default=secrets.randbelow(2**31), help="seed of the draws; default: a new one"
    )
    parser.add_argument("--out", type=Path, help="JSON file of the rows")
    options = parser.parse_args()
    sys.stdout = reply_stream()  # Blender writes to the standard output, which now is the standard error
    print(f"seed {options.seed}", flush=True)
    load_bpy(1)
    rows: list[Row] = []
    with tempfile.TemporaryDirectory() as scratch:
        for case in random_cases(options.looks, options.draws, options.seed):
            rows += (case_rows := rows_of(case, options, Path(scratch)))
            print_case(case_rows)
    print_summary(rows)
    if options.out:
        options.out.write_text(json.dumps({"seed": options.seed, "rows": [asdict(row) for row in rows]}, indent=1))


if __name__ == "__main__":
    main()
