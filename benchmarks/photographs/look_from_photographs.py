"""A look fitted to four photographs, judged on the other ones, beside the shipped look `lab`.

python benchmarks/photographs/look_from_photographs.py PHOTOGRAPHS FOLDER [--images 16] [--workers 2]

The fit has img.png, img2.png, img4.png and img6.png, as the fit of `lab` had. Both looks are rendered at other places
of the floor and with another seed than those of the fit, with lines as in the unseen photographs (img3.png, img5.png
and img7.png; img1.png has no line that runs through the image). FOLDER gets the look and its report.
"""

import argparse
from dataclasses import fields
from pathlib import Path

from diagnosis.photographs.image_figures import ImageFigures, medians
from pipeline.look_from_photographs.fit import LOOK, fit_look, write_look
from pipeline.look_from_photographs.photographs import read_photographs
from pipeline.look_from_photographs.refine import RenderSettings, measured_images, refined
from pipeline.look_from_photographs.views import ViewGeometry, look_views
from symolo.core.progress import report_here

FITTED = ("img.png", "img2.png", "img4.png", "img6.png")
UNSEEN = ("img1.png", "img3.png", "img5.png", "img7.png")
GEOMETRY = ViewGeometry(line_width_m=0.019, pitch_down_deg=90, field_of_view_deg=53.5)
"""Usual tape, and the field of view of a Raspberry Pi camera, whose video the robot of the photographs reads."""
SEED = 77


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("photographs", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--images", type=int, default=16)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    seen, unseen = (
        read_photographs(
            [(options.photographs / name, (options.photographs / name).read_bytes()) for name in names], None
        )
        for names in (FITTED, UNSEEN)
    )
    out = options.folder / "fitted"
    if not out.exists():
        look = fit_look(seen, out, "lab", floor=None, floor_reflectance=None, geometry=GEOMETRY)
        look = refined(look, RenderSettings(GEOMETRY, options.workers), report_here())
        write_look(look, seen, out, GEOMETRY)
    places = [photograph.place for photograph in unseen.measured]
    columns = {"photographs, fitted": seen.measured, "photographs, unseen": unseen.measured}
    for name, look in {"fitted look": str(out / LOOK), "lab": "lab"}.items():
        views = list(look_views(look, places, GEOMETRY, options.images, SEED))
        columns[name] = measured_images(views, options.workers, report_here())
    _print({name: medians([image.figures for image in images]) for name, images in columns.items()})


def _print(columns: dict[str, dict[str, tuple[float, float, float]]]) -> None:
    print(f"{'median (smallest to largest)':24}" + "".join(f"{name:>26}" for name in columns) + f"{'ratios':>16}")
    unseen = columns["photographs, unseen"]
    within = dict.fromkeys(("fitted look", "lab"), 0)
    for field in fields(ImageFigures):
        cells = [f"{m:.2f} ({low:.2f} to {high:.2f})" for m, low, high in (c[field.name] for c in columns.values())]
        ratios = {name: columns[name][field.name][0] / unseen[field.name][0] for name in within}
        for name, ratio in ratios.items():
            within[name] += abs(ratio - 1) <= 0.1
        print(
            f"{field.name:24}"
            + "".join(f"{cell:>26}" for cell in cells)
            + "".join(f"{r:8.2f}" for r in ratios.values())
        )
    print("within 10 % of the unseen photographs:", ", ".join(f"{name} {count}" for name, count in within.items()))


if __name__ == "__main__":
    main()
