"""Rendered frames beside the real photographs on one sheet, and the numbers of both.

python benchmarks/photographs/beside_photographs.py PHOTOGRAPHS FOLDER [--threads 2]

Frames of the same kind of view are rendered once and stay in FOLDER, which also gets beside_photographs.png and .json.
"""

import argparse
import json
from pathlib import Path

import cv2
import numpy as np
from line_frames import ROWS, Kind, frames
from photographs import photographs

from diagnosis.photographs.image_figures import ImageFigures, medians
from symolo.pages.sheet import Cell, in_columns, save

SCENES = range(2000, 2008)
SHIPPED = Kind("classroom")
ALIKE = Kind(
    "classroom",
    (
        "look.floor.material={choice: [concrete, linoleum, paper_sheets]}",
        "look.floor.dirt=0.9",
        "look.floor.stains=1",
        "look.floor.linoleum.paint={reflectance: 0.5, hue_deg: 60, saturation: 0.03}",
        "look.line=tape",
        "look.tape.roughness=0.2",
        "look.tape.wear=0.7",
        "look.tape.streaks=1",
        "look.camera.lens_blur_px=1.35",
        "look.camera.veiling_glare=0.015",
        "look.camera.vignetting=0.4",
        "look.camera.saturation=0.4",
        "look.camera.contrast=1.3",
        "look.camera.shot_noise=0.014",
        "look.camera.read_noise=0.001",
        "look.camera.sharpening=0.3",
        "look.camera.sharpening_radius_px=2",
        "look.camera.brightness=0.42",
    ),
)
"""The camera of the photographs: a soft cheap lens with dark corners, bright, some sharpening, hardly any colour."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("photographs", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    real = photographs(options.photographs, branch=False)
    rows = {"photograph": list(zip(real.images, real.x_px, strict=True))}
    for name, kind in {"as shipped": SHIPPED, "set like them": ALIKE}.items():
        rendered = frames(kind, SCENES, 1, options.folder / name.replace(" ", "_"), options.threads)
        rows[name] = list(zip(rendered.images, rendered.x_px, strict=True))
    figures = {
        name: [ImageFigures.from_image(image, x_px, ROWS) for image, x_px in labelled]
        for name, labelled in rows.items()
    }
    print(f"{'median (smallest to largest)':26}" + "".join(f"{name:>26}" for name in figures))
    table = {name: medians(values) for name, values in figures.items()}
    for figure in table["photograph"]:
        values = [table[name][figure] for name in table]
        print(f"{figure:26}" + "".join(f"{f'{m:.2f} ({a:.2f} to {b:.2f})':>26}" for m, a, b in values))
    written = {name: [vars(f) for f in values] for name, values in figures.items()}
    (options.folder / "beside_photographs.json").write_text(json.dumps(written, indent=1).replace("NaN", "null"))
    cells = [
        Cell(np.asarray(cv2.resize(image, None, fx=2, fy=2, interpolation=cv2.INTER_CUBIC), np.uint8), (f"{name} {n}",))
        for name, labelled in rows.items()
        for n, (image, _) in enumerate(labelled, start=1)
    ]
    save(in_columns(cells, len(real.names) // 2), options.folder / "beside_photographs.png")


if __name__ == "__main__":
    main()
