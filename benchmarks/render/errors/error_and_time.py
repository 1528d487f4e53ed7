"""Cost and error of an image: this renderer, a plain loop of Cycles, and BlenderProc, in turns.

Each contender renders the same views in a process of its own, which renders in its turn after a warm-up with one
sample; core-seconds are those of all its threads. Ours and the plain loop develop and encode each image within that
time, BlenderProc writes its own OpenEXR instead. Light of all goes through one camera without noise, and its 8-bit
images are compared with a converged reference's, beside what JPEG does to that. BlenderProc's defaults leave out
mirror images and more, which counts as error; "our light paths" sets these as ours are.

    python -m benchmarks.render.errors.error_and_time --cache refs --out bench [--looks classroom lab] [--size 320 240]
        [--poses 0.55,-0.20,90 ...] [--reference-samples 256] [--repetitions 3] [--blenderproc DIR/bin/python]

See `blenderproc_loop.py` for its environment. FLIP needs `pip install flip-evaluator`, also in a folder on PYTHONPATH.
"""

import argparse
import json
import os
import sys
from contextlib import ExitStack
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import mean, median
from typing import Any

import cv2
import matplotlib as mpl
import numpy as np

from benchmarks.render.contenders.plain_loop import BLENDERS_DEFAULT, RUN_FRAMES
from benchmarks.render.contenders.render_process import Cost, RenderProcess
from benchmarks.render.references.image_error import HAS_FLIP, Image, flip, mean_square, psnr_dB, ssim
from benchmarks.render.references.reference import MIN_SAMPLES, Reference, references
from benchmarks.render.references.views import LOOKS, POSES, Views, views_of
from blender_scenes.render.sampling import (
    HYBRID_QUALITIES,
    QUALITIES,
    HybridSamples,
    QualitySettings,
    hybrid_samples,
    tracing_settings,
)
from configs.schema.scenario import Render, RenderQuality
from sensors.camera.metering import median_luminance
from sensors.camera.response import develop, encode_jpeg

BLENDERPROCS = {**BLENDERS_DEFAULT, "samples": 1024, "use_adaptive_sampling": True, "adaptive_threshold": 0.01}


@dataclass(frozen=True)
class Contender:
    name: str
    family: str
    script: str
    settings: dict[str, Any]
    python: str = sys.executable


@dataclass(frozen=True)
class Row:
    """One contender under one look."""

    look: str
    contender: str
    family: str
    core_s: float
    """A frame, median over the repetitions."""
    wall_s: float
    core_s_in_a_run: float
    """A frame with its share of the start, warm-up and maps included, over `RUN_FRAMES`."""
    psnr_dB: float
    """PSNR of the mean square error over all poses."""
    worst_psnr_dB: float
    ssim: float
    flip: float | None


def contenders(options: argparse.Namespace) -> list[Contender]:
    rivals = [
        Contender(
            f"ours, {name}", "ours", "cycles_process.py", {"kind": "ours", "sampling": {**settings, "denoise": True}}
        )
        for name, settings in _ours(options).items()
    ]
    for samples in options.plain:
        settings = {"kind": "plain", "cycles": {**BLENDERS_DEFAULT, "samples": samples}}
        rivals.append(Contender(f"plain loop, {samples}", "plain loop", "cycles_process.py", settings))
    for samples in _hybrid_of(options):
        name = f"hybrid, {samples.near}, {samples.far}, {samples.surfaces}"
        rivals.append(Contender(name, "hybrid", "cycles_process.py", {"kind": "ours", "hybrid": asdict(samples)}))
    if options.blenderproc:
        for paths in options.blenderprocs_light_paths:
            python, settings = str(options.blenderproc), {"light_paths": paths}
            words = "defaults" if paths == "defaults" else "our light paths"
            rivals.append(Contender(f"BlenderProc, {words}", "BlenderProc", "blenderproc_loop.py", settings, python))
    elif options.blenderprocs_settings:
        settings = {"kind": "plain", "cycles": BLENDERPROCS}
        rivals.append(Contender("plain loop, BlenderProc's settings", "plain loop", "cycles_process.py", settings))
    return rivals


def _ours(options: argparse.Namespace) -> dict[str, dict[str, Any]]:
    """Return fields of `TracingSettings` by the name of the choice; a quality has those of a run of that size."""
    by_name = {}
    for choice in options.ours:
        if isinstance(choice, QualitySettings):
            name, settings = f"{choice.samples} {choice.prefilter}/{choice.denoise_quality}", asdict(choice)
        else:
            run_settings = tracing_settings(_render(options, choice), seed=0)
            name, settings = (
                choice,
                {field: getattr(run_settings, field) for field in QualitySettings.__dataclass_fields__},
            )
        by_name[name] = settings
    return by_name


def _hybrid_of(options: argparse.Namespace) -> list[HybridSamples]:
    return [
        choice if isinstance(choice, HybridSamples) else hybrid_samples(_render(options, choice))
        for choice in options.hybrid
    ]


def _render(options: argparse.Namespace, quality: RenderQuality) -> Render:
    width_px, height_px = options.size
    return Render(width_px=width_px, height_px=height_px, quality=quality)


def _quality(text: str) -> str | QualitySettings:
    if text in QUALITIES:
        return text
    samples, prefilter, denoise_quality = text.split(",")
    return QualitySettings(int(samples), prefilter, denoise_quality)


def measured(views: Views, converged: dict[int, Reference], options: argparse.Namespace) -> list[Row]:
    """Return the rows of all contenders under one look."""
    numbers = [view.number for view in views.job.frames]
    metered = median_luminance(np.concatenate([converged[n].light().reshape(-1, 3) for n in numbers]))
    true = {n: develop(converged[n].light(), views.job.response, metered, n) for n in numbers}
    with ExitStack() as stack:
        processes = [
            (
                rival,
                stack.enter_context(
                    RenderProcess(rival.script, views.job, rival.settings, options.threads, rival.python)
                ),
            )
            for rival in contenders(options)
        ]
        costs: dict[str, list[Cost]] = {rival.name: [] for rival, _ in processes}
        warm = {rival.name: process.render(numbers, warm_up=True) for rival, process in processes}
        for repetition in range(options.repetitions):
            for rival, process in processes:
                if rival.family == "BlenderProc" and repetition >= options.blenderprocs_repetitions:
                    continue
                costs[rival.name].append(process.render(numbers))
                _say(f"  {views.look} {repetition + 1}: {rival.name} {costs[rival.name][-1].core_s:.1f} core-s")
        rows = []
        for rival, process in processes:
            images = {n: develop(process.light(n), views.job.response, metered, n) for n in numbers}
            start = process.set_up.core_s + warm[rival.name].core_s
            rows.append(row(views.look, rival, costs[rival.name], start, images, true))
            if options.out:
                _keep_images(options.out, views.look, rival.name, images, true)
    return rows


def row(  # noqa: PLR0917 - what a row is made of
    look: str,
    rival: Contender,
    costs: list[Cost],
    start_s: float,
    images: dict[int, Image],
    true: dict[int, Image],
) -> Row:
    squares = [mean_square(images[n], true[n]) for n in true]
    flips = [flip(images[n], true[n]) for n in true] if HAS_FLIP else []
    core_s = median(cost.core_s for cost in costs) / len(true)
    return Row(
        look=look,
        contender=rival.name,
        family=rival.family,
        core_s=core_s,
        wall_s=median(cost.wall_s for cost in costs) / len(true),
        core_s_in_a_run=core_s + start_s / RUN_FRAMES,
        psnr_dB=psnr_dB(mean(squares)),
        worst_psnr_dB=psnr_dB(max(squares)),
        ssim=mean(ssim(images[n], true[n]) for n in true),
        flip=mean(f for f in flips if f is not None) if flips else None,
    )


def comparisons(views: Views, converged: dict[int, Reference]) -> list[Row]:
    """Return rows with the error of JPEG, and with the difference between the two halves of the reference."""
    quality = views.job.response.jpeg_quality
    lights = {n: reference.light() for n, reference in converged.items()}
    metered = median_luminance(np.concatenate([light.reshape(-1, 3) for light in lights.values()]))
    rows = []
    for name, job in (("without noise", views.job), ("with camera noise", views.noisy())):
        true = {n: develop(light, job.response, metered, n) for n, light in lights.items()}
        packed = {n: _decoded(encode_jpeg(image, quality)) for n, image in true.items()}
        rows.append(row(views.look, _comparison(f"JPEG {quality} {name}"), [Cost(0, 0)], 0, packed, true))
    halves = [{n: develop(converged[n].halves[i], views.job.response, metered, n) for n in converged} for i in range(2)]
    rows.append(row(views.look, _comparison("reference, seed against seed"), [Cost(0, 0)], 0, *halves))
    return rows


def _comparison(name: str) -> Contender:
    return Contender(name, "comparison", "", {})


def _decoded(data: bytes) -> Image:
    return cv2.cvtColor(cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB)


def _keep_images(folder: Path, look: str, name: str, images: dict[int, Image], true: dict[int, Image]) -> None:
    """Save image, reference, and their difference eight times as strong about grey, side by side."""
    for number, image in images.items():
        apart = np.clip(128 + 8.0 * (image.astype(float) - true[number]), 0, 255).astype(np.uint8)
        sheet = np.hstack([image, true[number], apart])
        file = folder / f"{look}_{number}_{''.join(c if c.isalnum() else '_' for c in name)}.png"
        cv2.imwrite(str(file), cv2.cvtColor(sheet, cv2.COLOR_RGB2BGR))


def print_rows(rows: list[Row]) -> None:
    print(f"{'':38} core-s  in a run  wall s    PSNR   worst     SSIM    FLIP")
    for look in dict.fromkeys(r.look for r in rows):
        print(look)
        for r in (r for r in rows if r.look == look):
            cost = f"{r.core_s:8.2f}{r.core_s_in_a_run:10.2f}{r.wall_s:8.2f}" if r.core_s else " " * 26
            seen = f"{r.flip:8.4f}" if r.flip is not None else "       -"
            print(f"  {r.contender:36}{cost}{r.psnr_dB:8.2f}{r.worst_psnr_dB:8.2f}{r.ssim:9.5f}{seen}")


def plot(rows: list[Row], size: tuple[int, int], file: Path) -> None:
    mpl.use("Agg")
    from matplotlib import pyplot as plt  # noqa: PLC0415 - after the choice of the backend

    looks = list(dict.fromkeys(r.look for r in rows))
    figure, panes = plt.subplots(1, len(looks), figsize=(5 * len(looks), 5.4), sharey=True, squeeze=False)
    for look, pane in zip(looks, panes[0], strict=True):
        here = [r for r in rows if r.look == look]
        for family, mark in (("ours", "o-"), ("plain loop", "s-"), ("hybrid", "d-"), ("BlenderProc", "^")):
            series = sorted((r.core_s, r.psnr_dB) for r in here if r.family == family)
            if series:
                pane.plot([x for x, _ in series], [y for _, y in series], mark, label=family)
        for r, line in zip((r for r in here if r.family == "comparison"), ("-", "--", ":"), strict=True):
            pane.axhline(r.psnr_dB, color="0.5", linestyle=line, linewidth=1, label=r.contender)
        pane.set(xscale="log", title=look, xlabel=f"core-seconds a frame of {size[0]} x {size[1]} px")
        pane.grid(alpha=0.3, which="both")
    handles, labels = panes[0][0].get_legend_handles_labels()
    panes[0][0].set_ylabel("PSNR against the reference [dB]")
    figure.legend(handles, labels, fontsize=8, loc="lower center", ncols=3)
    figure.tight_layout(rect=(0, 0.11, 1, 1))
    figure.savefig(file, dpi=110)


def _pose(text: str) -> tuple[float, float, float]:
    x, y, yaw = map(float, text.split(","))
    return x, y, yaw


def _hybrid(text: str) -> str | HybridSamples:
    return text if text in HYBRID_QUALITIES else HybridSamples(*map(int, text.split(",")))


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def parsed_options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--looks", nargs="+", choices=LOOKS, default=["classroom", "lab"])
    parser.add_argument("--poses", nargs="+", type=_pose, default=list(POSES), help="x [m],y [m],yaw [deg]")
    parser.add_argument("--size", nargs=2, type=int, default=[320, 240], metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--reference-samples", type=int, default=MIN_SAMPLES)
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    words = "qualities, or samples and denoiser such as 8,FAST,BALANCED"
    parser.add_argument("--ours", nargs="*", type=_quality, default=["draft", "standard", "high"], help=words)
    parser.add_argument("--plain", nargs="*", type=int, default=[2, 4, 8, 16, 32], help="samples")
    words = "samples near, far and of surfaces, such as 3,2,4, of images from hybrid rendering; or their quality"
    parser.add_argument("--hybrid", nargs="*", type=_hybrid, default=["standard"], help=words)
    parser.add_argument("--blenderproc", type=Path, help="interpreter of BlenderProc's environment")
    parser.add_argument("--blenderprocs-repetitions", type=int, default=1, help="it takes minutes a frame")
    paths = ["defaults", "ours"]
    parser.add_argument("--blenderprocs-light-paths", nargs="+", choices=paths, default=paths)
    parser.add_argument("--blenderprocs-settings", action="store_true", help="in a plain loop, for want of it")
    parser.add_argument("--cache", type=Path, default=Path("references"))
    parser.add_argument("--out", type=Path, help="folder for JSON, plot and images")
    options = parser.parse_args()
    if options.reference_samples < MIN_SAMPLES:
        parser.error(f"--reference-samples {options.reference_samples}: at least {MIN_SAMPLES}")
    if options.blenderproc and not options.blenderproc.exists():
        parser.error(f"--blenderproc {options.blenderproc}: no such interpreter; see blenderproc_loop.py")
    return options


def main() -> None:
    options = parsed_options()
    if options.out:
        options.out.mkdir(parents=True, exist_ok=True)
    rows: list[Row] = []
    for look in options.looks:
        views = views_of(look, tuple(options.poses), tuple(options.size))
        converged = references(views.job, options.reference_samples, options.cache, options.threads)
        rows += comparisons(views, converged) + measured(views, converged, options)
        if options.out:
            keep(rows, options)  # after each look: the whole takes hours
    print_rows(rows)


def keep(rows: list[Row], options: argparse.Namespace) -> None:
    settings = {name: value for name, value in vars(options).items() if name not in {"out", "cache", "blenderproc"}}
    settings["ours"], settings["hybrid"] = _ours(options), [asdict(samples) for samples in _hybrid_of(options)]
    text = json.dumps({"arguments": settings, "rows": [asdict(r) for r in rows]}, indent=1)
    (options.out / "error_and_time.json").write_text(text + "\n")
    plot(rows, tuple(options.size), options.out / "error_and_time.png")


if __name__ == "__main__":
    try:
        main()
    except ChildProcessError as error:
        raise SystemExit(str(error)) from None
