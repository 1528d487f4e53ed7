"""How well a classifier on the figures of an image distinguishes photographs from rendered images.

python benchmarks/photographs/tell_apart.py PHOTOGRAPHS FOLDER [--scenes 16] [--threads 2]

The rendered images are those of the look `lab` before its camera and floor were fitted, and of `lab` as it is shipped.
Every second photograph was used for the fit (img.png, img2.png, ...); the others were not, and are counted alone as
well. The area under the curve is the share of pairs of a photograph and a rendered image in which the classifier finds
the photograph the more likely one: 0.5 is a guess, 1 is without error. Each image is judged by a classifier that was
trained without it. Frames stay in FOLDER, which also gets tell_apart.png and tell_apart.json.
"""

import argparse
import json
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path

import cv2
import numpy as np
from line_frames import ROWS, Array, Kind, frames
from photographs import photographs

from diagnosis.photographs.image_figures import ImageFigures, medians
from symolo.core.random_streams import stream
from symolo.pages.sheet import Cell, in_columns, save

FIRST_SCENE = 2200
"""Scenes of the fit had lower numbers."""
ON_THE_FLOOR = "look.camera.defocus_share=0.0134"
"""Out of focus as at the distance of the photographs, 84 mm: their tape is 36 px wide, and tape of 19 mm is usual."""
BEFORE = Kind(
    "lab",
    (
        "look.floor.material={choice: [concrete, ceramic_tile, linoleum, vinyl]}",
        "look.floor.dirt={uniform: [0.05, 0.3]}",
        "look.floor.stains={uniform: [0, 0.2]}",
        "look.floor.linoleum.paint.reflectance=0.4",
        "look.floor.linoleum.paint.saturation={uniform: [0.05, 0.25]}",
        "look.line={choice: [tape, paint]}",
        "look.line_sheets.width_m=0",
        "look.tape.roughness={choice: [0.2, 0.5, 0.6]}",
        "look.tape.wear={uniform: [0, 0.4]}",
        "look.tape.streaks={uniform: [0, 0.3]}",
        "look.lamps.rows=3",
        "look.lamps.columns=3",
        "look.lamps.flux_klm={uniform: [3, 6]}",
        f"look.camera={Path(__file__).with_name('good_camera.yaml')}",
    ),
)
AFTER = Kind("lab", (ON_THE_FLOOR,))
RIDGE = 1.0
"""Variance that is added to each figure, in units of its own."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("photographs", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--scenes", type=int, default=16)
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    real = photographs(options.photographs, branch=False)
    scenes = range(FIRST_SCENE, FIRST_SCENE + options.scenes)
    photograph_figures = [
        ImageFigures.from_image(image, x_px, ROWS) for image, x_px in zip(real.images, real.x_px, strict=True)
    ]
    unseen = photograph_figures[1::2]
    result = {"photographs, fitted": medians(photograph_figures[::2]), "photographs, unseen": medians(unseen)}
    areas, shown = {}, [(name, image) for name, image in zip(real.names, real.images, strict=True)]
    for name, kind in {"lab before": BEFORE, "lab": AFTER}.items():
        rendered = frames(kind, scenes, 1, options.folder / name.replace(" ", "_"), options.threads)
        figures = [ImageFigures.from_image(*one, ROWS) for one in zip(rendered.images, rendered.x_px, strict=True)]
        result[name] = medians(figures)
        areas[name] = {
            "all figures": area(photograph_figures, figures),
            "without jaggedness": area(photograph_figures, figures, without="jaggedness_px"),
            "unseen photographs": area(unseen, figures),
        }
        areas[name] |= {f"{f.name} alone": alone(photograph_figures, figures, f.name) for f in fields(ImageFigures)}
        if kind is AFTER:
            shown += [(f"scene {scene}", image) for scene, image in zip(scenes, rendered.images, strict=True)]
    print(f"{'median (smallest to largest)':24}" + "".join(f"{name:>26}" for name in result))
    for field in fields(ImageFigures):
        cells = [result[name][field.name] for name in result]
        print(f"{field.name:24}" + "".join(f"{f'{m:.2f} ({low:.2f} to {high:.2f})':>26}" for m, low, high in cells))
    print(f"\n{'area under the curve':32}" + "".join(f"{name:>14}" for name in areas))
    for what in areas["lab"]:
        print(f"{what:32}" + "".join(f"{areas[name][what]:14.2f}" for name in areas))
    (options.folder / "tell_apart.json").write_text(json.dumps({"figures": result, "areas": areas}, indent=1))
    order = stream(1, "sheet").permutation(len(shown)).tolist()
    print("\nsheet, row by row:", ", ".join(shown[k][0] for k in order))
    cells = [Cell(_enlarged(shown[k][1]), (str(place),)) for place, k in enumerate(order, start=1)]
    save(in_columns(cells, 6), options.folder / "tell_apart.png")


def area(real: Sequence[ImageFigures], rendered: Sequence[ImageFigures], without: str = "") -> float:
    """Return the area under the curve of a linear discriminant, each image left out in turn."""
    names = [field.name for field in fields(ImageFigures) if field.name != without]
    values = np.array([[getattr(image, name) for name in names] for image in (*real, *rendered)])
    is_real = np.arange(len(values)) < len(real)
    scores = np.array([_score(values, is_real, k) for k in range(len(values))])
    return _area(scores[is_real], scores[~is_real])


def alone(real: Sequence[ImageFigures], rendered: Sequence[ImageFigures], name: str) -> float:
    """Return the area under the curve of one figure, at least 0.5."""
    groups = [np.array([getattr(image, name) for image in group]) for group in (real, rendered)]
    one = _area(*(group[np.isfinite(group)] for group in groups))
    return max(one, 1 - one)


def _score(values: Array, is_real: np.ndarray, k: int) -> float:
    """Return how much image k is like a photograph, by the other images."""
    others = np.arange(len(values)) != k
    # Figures vary by factors. Signs do not matter, and what could not be measured counts as typical.
    logs = np.log(np.abs(values) + 1e-3)
    logs = np.where(np.isfinite(logs), logs, np.nanmedian(logs[others], axis=0))
    # Both kinds count alike, so that leaving one image out does not shift the boundary towards its kind.
    middle = 0.5 * (logs[others & is_real].mean(axis=0) + logs[others & ~is_real].mean(axis=0))
    spread = logs[others].std(axis=0)
    scaled = (logs - middle) / spread
    real, rendered = scaled[others & is_real], scaled[others & ~is_real]
    within = 0.5 * (np.cov(real.T) + np.cov(rendered.T))
    towards = np.linalg.solve(within + RIDGE * np.eye(len(within)), real.mean(axis=0) - rendered.mean(axis=0))
    return float(scaled[k] @ towards)


def _area(real: Array, rendered: Array) -> float:
    difference = real[:, None] - rendered[None, :]
    return float((difference > 0).mean() + 0.5 * (difference == 0).mean())


def _enlarged(image: np.ndarray) -> np.ndarray:
    return np.asarray(cv2.resize(image, None, fx=2, fy=2, interpolation=cv2.INTER_CUBIC), np.uint8)


if __name__ == "__main__":
    main()
