"""Converged images to compare others with, rendered once and stored.

Even thousands of samples leave noise near 40 dB here. So the light on diffuse surfaces, which is smooth, is denoised
apart from their colour, which is not and hardly has noise; both are multiplied again, and gloss and the rest, denoised
by themselves, added. Two such images with different seeds say how good it is; the reference is their mean.
"""

import hashlib
import json
import os
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.render.contenders.cycles_process import PASSES
from benchmarks.render.contenders.render_process import RenderProcess
from blender_scenes.hybrid.denoiser import Denoiser
from blender_scenes.render.job import RenderJob
from blender_scenes.render.light_paths import LIGHT_PATHS

MIN_SAMPLES = 256
SEEDS = (101, 202)
_METHOD = 2
"""Version of the method, to be raised when it gives other images of the same job."""


@dataclass(frozen=True)
class Reference:
    halves: tuple[np.ndarray, np.ndarray]
    """(H, W, 3) linear light, one of each seed."""

    def light(self) -> np.ndarray:
        return 0.5 * (self.halves[0] + self.halves[1])


def references(job: RenderJob, samples: int, folder: Path, threads: int) -> dict[int, Reference]:
    """Return the reference of each of the job's frames by number, with complete light paths; `folder` keeps them.

    Raises:
        ValueError: Fewer samples than a reference must have.
    """
    if samples < MIN_SAMPLES:
        raise ValueError(f"a reference of {samples} samples is too noisy; at least {MIN_SAMPLES}")
    folder.mkdir(parents=True, exist_ok=True)
    job = replace(job, sampling=replace(job.sampling, paths=LIGHT_PATHS["complete"]))
    halves = {seed: _reference_of_seed(job, samples, seed, folder, threads) for seed in SEEDS}
    return {view.number: Reference(tuple(halves[seed][view.number] for seed in SEEDS)) for view in job.frames}


def _reference_of_seed(job: RenderJob, samples: int, seed: int, folder: Path, threads: int) -> dict[int, np.ndarray]:
    files = {view.number: folder / _file_name(job, view.number, samples, seed) for view in job.frames}
    missing = [number for number, file in files.items() if not file.exists()]
    if missing:
        settings = {"kind": "passes", "samples": samples, "seed": seed}
        with RenderProcess("cycles_process.py", job, settings, threads, sys.executable) as process:
            for number in missing:
                cost = process.render([number])
                _keep(clean(process.light(number)), files[number])
                print(f"  reference {number}, seed {seed}: {cost.core_s:.0f} core-s", file=sys.stderr, flush=True)
    gains = {view.number: np.array(view.light_gain, np.float32) for view in job.frames}
    return {number: np.load(file) * gains[number] for number, file in files.items()}


def _file_name(job: RenderJob, number: int, samples: int, seed: int) -> str:
    one = replace(job, frames=tuple(view for view in job.frames if view.number == number))
    content = json.dumps([_METHOD, samples, seed, one.to_json()])
    return f"{hashlib.sha256(content.encode()).hexdigest()[:24]}.npy"


def clean(passes: np.ndarray) -> np.ndarray:
    """Return the light (H, W, 3) of the `PASSES` (5, H, W, 3)."""
    by_name = dict(zip(PASSES, passes, strict=True))
    diffuse = by_name["DiffDir"] + by_name["DiffInd"]
    rest = np.maximum(by_name["Combined"] - by_name["DiffCol"] * diffuse, 0)
    denoise = Denoiser(os.cpu_count() or 1, "HIGH")
    parts = (denoise(part, by_name["Normal"], by_name["DiffCol"]) for part in (diffuse, rest))
    smooth, remaining = parts
    return by_name["DiffCol"] * smooth + remaining


def _keep(light: np.ndarray, file: Path) -> None:
    beside = file.with_suffix(".tmp")
    with beside.open("wb") as stream:
        np.save(stream, light)
    beside.replace(file)
