"""Does a line-position regressor trained on rendered frames alone find the line in an unseen look and in photographs?

python benchmarks/photographs/line_regressor.py FOLDER [--photographs DIR] [--scenes 30] [--threads 2]

Trains on frames of `lab` (narrow), of `extreme` (wide) and of `extreme` as the flat renderer sees it, all of the same
lines, cameras and places; tests on `classroom` and `night`, and on the photographs labelled in camera_line_photos.csv.
Frames are made once and kept in FOLDER, which also gets line_regressor.json and line_regressor.png.
"""

import argparse
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from line_frames import WIDTH_PX, Array, Kind, LabelledFrames, flat_frames, frames
from line_position import Regressor, constant, dark_blob
from matplotlib.figure import Figure
from photographs import photographs

from symolo.core.random_streams import stream

NARROW = Kind("lab")
WIDE = Kind(
    "extreme", ("look.camera.lens_blur_px={uniform: [0, 1.5]}", "look.camera.veiling_glare={uniform: [0, 0.1]}")
)
UNSEEN = ("classroom", "night")
FIRST_UNSEEN = 1000
"""Scene number; no line, camera or place of the test is one of the training."""
BOOTSTRAP = 1000


@dataclass(frozen=True)
class Figures:
    """Figures of the distances [px] between the detected and the true line, for one method in one set of images."""

    median_px: float
    median_low_px: float
    median_high_px: float
    """90 % of bootstrap draws of whole scenes or photographs lie between."""
    p90_px: float
    rows: int

    @classmethod
    def from_errors(cls, error_px: Array, group: Array) -> "Figures":
        """Return the figures of errors (N, R), which are NaN where there is no label."""
        rng, names = stream(0, "bootstrap"), np.unique(group)
        parts = [error_px[group == name].ravel() for name in names]
        draws = [np.concatenate([parts[i] for i in rng.integers(0, len(parts), len(parts))]) for _ in range(BOOTSTRAP)]
        low, high = np.quantile([np.nanmedian(draw) for draw in draws], [0.05, 0.95])
        whole = error_px[np.isfinite(error_px)]
        return cls(float(np.median(whole)), float(low), float(high), float(np.quantile(whole, 0.9)), len(whole))


def figure(errors: dict[str, dict[str, Array]], path: Path) -> None:
    """Share of the rows whose error is below, one panel per test set."""
    drawn = Figure(figsize=(4 * len(errors), 3.6), layout="constrained")
    panels = drawn.subplots(1, len(errors), sharey=True, squeeze=False)[0]
    for axes, (test, methods) in zip(panels, errors.items(), strict=True):
        for method, error_px in methods.items():
            ordered = np.sort(error_px[np.isfinite(error_px)])
            share = 100 * (np.arange(len(ordered)) + 1) / len(ordered)
            style = "--" if method in {"constant", "dark blob"} else "-"
            axes.step(np.maximum(ordered, 0.1), share, style, where="post", label=method)
        axes.set(
            title=f"{test} ({np.isfinite(methods['constant']).sum()} rows)",
            xscale="log",
            xlim=(0.1, 80),
            xlabel="error [px]",
        )
        axes.grid(alpha=0.3, which="both")
        axes.axhline(50, color="grey", lw=0.5)
        axes.axhline(90, color="grey", lw=0.5)
    drawn.axes[0].set_ylabel("rows with a smaller error [%]")
    drawn.legend(*drawn.axes[0].get_legend_handles_labels(), fontsize=8, loc="outside lower center", ncols=5)
    drawn.savefig(path, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--photographs", type=Path, help="folder of the real frames; without it they are left out")
    parser.add_argument("--scenes", type=int, default=30)
    parser.add_argument("--frames", type=int, default=8, help="of each scene")
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    scenes, unseen = range(options.scenes), range(FIRST_UNSEEN, FIRST_UNSEEN + max(1, options.scenes // 4))

    def traced(name: str, kind: Kind, numbers: range) -> LabelledFrames:
        print(f"{name}: {len(numbers)} scenes of {options.frames} frames, look {kind.look}", flush=True)
        return frames(kind, numbers, options.frames, options.folder / name, options.threads)

    tests = {f"unseen look {look}": traced(f"unseen_{look}", Kind(look), unseen) for look in UNSEEN}
    training = {"wide": traced("wide", WIDE, scenes), "narrow": traced("narrow", NARROW, scenes)}
    training["wide, flat renderer"] = flat_frames(WIDE, scenes, options.frames)
    if options.photographs is not None:
        tests["photographs"] = photographs(options.photographs, branch=False).labelled()
        tests["photographs, at branches"] = photographs(options.photographs, branch=True).labelled()
    methods: dict[str, Callable[[np.ndarray], Array]] = {"constant": constant(training["wide"]), "dark blob": dark_blob}
    settings = {}
    for name, known in training.items():
        regressor = Regressor.fit(known)
        methods[name], settings[name] = regressor.places, regressor.settings()
        print(f"{name}: {settings[name]}", flush=True)
    errors = {test: {m: np.abs(f(seen.images) - seen.x_px) for m, f in methods.items()} for test, seen in tests.items()}
    results = {
        test: {method: Figures.from_errors(error, tests[test].group) for method, error in method_errors.items()}
        for test, method_errors in errors.items()
    }
    print(f"{'':28}{'':22}median [px] (90 % range)   90 % below [px]   in % of {WIDTH_PX} px")
    for test, method_errors in results.items():
        for method, f in method_errors.items():
            spread = f"{f.median_px:6.2f} ({f.median_low_px:.2f} to {f.median_high_px:.2f})"
            percent = f"{100 * f.median_px / WIDTH_PX:.1f}, {100 * f.p90_px / WIDTH_PX:.1f}"
            print(f"{test:28}{method:22}{spread:27}{f.p90_px:6.2f}            {percent}")
    written = {"settings": settings, "scenes": options.scenes, "frames": options.frames}
    written["results"] = {t: {m: vars(f) for m, f in by_method.items()} for t, by_method in results.items()}
    written["errors_px"] = {
        t: {m: np.round(e, 2).tolist() for m, e in by_method.items()} for t, by_method in errors.items()
    }
    (options.folder / "line_regressor.json").write_text(json.dumps(written, indent=1).replace("NaN", "null"))
    figure(errors, options.folder / "line_regressor.png")


if __name__ == "__main__":
    main()
