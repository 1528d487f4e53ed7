"""Errors of the learned localisation method on worn robots, beside those of the other methods.

    python benchmarks/localisation/learned.py OUT [--runs 8] [--judged 3] [--workers 1] [--start-sd-cm 0.1]
        [--start-sd-deg 0.1] [--inputs images,ranges images ranges]

It makes two releases of `symolo` with one image of 80 x 60 px a second: one for training, with the look `extreme` and
robots of a fleet (training_robots.yaml), and one that judges, with the look `classroom`, another seed and worn robots
(judged_robots.yaml). They have `runs` and `judged` laps in each direction. A model is trained for each set of inputs.
The table has the median over the judged laps and the range. Releases and models that are in OUT are used again.
"""

import argparse
import json
import sys
import time
from pathlib import Path
from statistics import median

from pipeline.cli import main as main_of_symolo

HERE = Path(__file__).parent
CAMERA = {
    "rates.camera_hz": "1",
    "render.width_px": "80",
    "render.height_px": "60",
    "render.quality": "draft",
    "render.method": "full",
    "render.light_paths.diffuse_bounces": "3",
}
TRAINING = {"seed": "301", "look": "extreme", "robot": str(HERE / "training_robots.yaml")}
JUDGED = {"seed": "4711", "look": "classroom", "robot": str(HERE / "judged_robots.yaml")}
OTHERS = "odometry,ekf,particles,retrieval"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--runs", type=int, default=8, help="laps in each direction for training")
    parser.add_argument("--judged", type=int, default=3, help="laps in each direction that judge")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--start-sd-cm", type=float, default=0.1)
    parser.add_argument("--start-sd-deg", type=float, default=0.1)
    parser.add_argument("--inputs", nargs="*", default=["images,ranges", "images", "ranges"])
    options = parser.parse_args()
    options.out.mkdir(exist_ok=True)
    start = f"{options.start_sd_cm:g}cm-{options.start_sd_deg:g}deg"
    training = release(options.out / "train", options.runs, TRAINING, options.workers)
    judged = release(options.out / "judge", options.judged, JUDGED, options.workers)
    accuracy = ["--start-sd-cm", str(options.start_sd_cm), "--start-sd-deg", str(options.start_sd_deg)]
    results = baselines(judged, options.out / f"others-{start}", "--methods", OTHERS, *accuracy)
    for inputs in options.inputs:
        name = inputs.replace(",", "-")
        model = options.out / f"{name}.npz"
        if not model.exists():
            began = time.monotonic()
            symolo("train", str(training), "--inputs", inputs, "--out", str(model))
            print(f"{inputs}: trained in {time.monotonic() - began:.0f} s", flush=True)
        arguments = ["--methods", "learned", "--model", str(model), *accuracy]
        errors_of_model = baselines(judged, options.out / f"{name}-{start}", *arguments)
        results |= {f"learned ({inputs})": errors_of_model["learned"]}
    print_table(results)


def release(folder: Path, runs: int, settings: dict[str, str], workers: int) -> Path:
    """Make a release with this number of laps in each direction, or continue it."""
    laps = {"routes.0.runs": str(runs), "routes.1.runs": str(runs)}
    words = [word for name, value in (CAMERA | settings | laps).items() for word in ("--set", f"{name}={value}")]
    symolo("release", "symolo", *words, "--workers", str(workers), "--out", str(folder))
    return folder


def baselines(judged: Path, out: Path, *arguments: str) -> dict[str, list[dict[str, float]]]:
    """Return the errors of each method in all runs."""
    if not out.exists():
        symolo("baselines", str(judged), "--out", str(out), *arguments)
    runs = json.loads((out / "baselines.json").read_text())["runs"].values()
    return {method: [run[method] for run in runs] for method in next(iter(runs))}


def print_table(results: dict[str, list[dict[str, float]]]) -> None:
    print(
        "| method | ATE [mm], median and range | end [mm] | ATE [deg] | NEES | in 95% |\n|---|---:|---:|---:|---:|---:|"
    )
    odometry_m = [errors["ate_m"] for errors in results["odometry"]]
    for method, runs in results.items():
        ate_mm = [1e3 * errors["ate_m"] for errors in runs]
        end_mm, ate_deg, nees, within = (
            factor * median(errors[name] for errors in runs)
            for name, factor in (("end_m", 1e3), ("ate_rad", 57.2958), ("nees", 1.0), ("within", 1.0))
        )
        cells = f"{median(ate_mm):.1f}, {min(ate_mm):.1f} to {max(ate_mm):.1f} | {end_mm:.1f} | {ate_deg:.2f}"
        print(f"| {method} | {cells} | {nees:.1f} | {within:.2f} |")
    for method, runs in results.items():
        if method.startswith("learned"):
            ratios = [errors["ate_m"] / odometry for errors, odometry in zip(runs, odometry_m, strict=True)]
            by_medians = median(errors["ate_m"] for errors in runs) / median(odometry_m)
            print(
                f"{method}: {by_medians:.2f} of odometry by the medians; by lap {min(ratios):.2f} to {max(ratios):.2f}"
            )


def symolo(*arguments: str) -> None:
    if code := main_of_symolo(list(arguments)):
        sys.exit(code)


if __name__ == "__main__":
    main()
