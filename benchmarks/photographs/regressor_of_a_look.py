"""Does a line regressor find the line in photographs better if it was trained on a look that was fitted to others?

python benchmarks/photographs/regressor_of_a_look.py PHOTOGRAPHS LOOK FOLDER [--scenes 8] [--threads 2]

LOOK is the folder that `symolo look from` has made of img.png, img2.png, img4.png and img6.png; the regressors are
tested on the other photographs only. Each training has the same number of scenes, images and samples:

- lab, extreme: shipped looks, with cameras and lines of many heights, angles and widths
- fitted look: the same cameras and lines
- fitted look and view: the camera and the width of the line of LOOK/scenario.yaml, on the same courses

FOLDER keeps the images, and gets regressor_of_a_look.json.
"""

import argparse
import json
from pathlib import Path

import numpy as np
from line_frames import Kind, frames
from line_position import Regressor, dark_blob
from line_regressor import Figures
from photographs import photographs

from pipeline.look_from_photographs.fit import LOOK, SCENARIO_FILE

FITTED = ("img.png", "img2.png", "img4.png", "img6.png")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("photographs", type=Path)
    parser.add_argument("look", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--scenes", type=int, default=8)
    parser.add_argument("--trainings", nargs="+", default=["lab", "fitted look and view"], help="names, as above")
    parser.add_argument("--frames", type=int, default=8, help="of each scene")
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    look = str((options.look / LOOK).absolute())
    kinds = {
        "lab": Kind("lab"),
        "fitted look": Kind(look),
        "fitted look and view": Kind(look, view=str(options.look / SCENARIO_FILE)),
        "extreme": Kind("extreme"),
    }
    tests = {}
    for name, branch in {"without a branch": False, "along a branch": True}.items():
        everything = photographs(options.photographs, branch=branch)
        labelled = everything.labelled()
        unseen = np.array([everything.names[k] not in FITTED for k in labelled.group])
        tests[name] = labelled.images[unseen], labelled.x_px[unseen], labelled.group[unseen]
    methods = {"widest dark section": dark_blob}
    settings = {}
    written: dict[str, dict[str, object]] = {}
    for name, kind in ((name, kinds[name]) for name in options.trainings):
        print(f"{name}: {options.scenes} scenes of {options.frames} images", flush=True)
        place = options.folder / name.replace(" ", "_")
        known = frames(kind, range(options.scenes), options.frames, place, options.threads)
        regressor = Regressor.fit(known)
        methods[name], settings[name] = regressor.places, regressor.settings()
    print(f"{'trained on':24}" + "".join(f"{f'{test}, median [px] (90 %), 90 % below':>58}" for test in tests))
    for name, method in methods.items():
        cells = []
        written[name] = {}
        for test, (images, x_px, group) in tests.items():
            error_px = np.abs(method(images) - x_px)
            figures = Figures.from_errors(error_px, group)
            spread = f"({figures.median_low_px:.2f} to {figures.median_high_px:.2f})"
            cells.append(f"{figures.median_px:.2f} {spread}, {figures.p90_px:.2f}, {figures.rows} rows")
            written[name][test] = vars(figures) | {"errors_px": np.round(error_px, 2).tolist()}
        print(f"{name:24}" + "".join(f"{cell:>58}" for cell in cells))
    text = json.dumps({"settings": settings, "results": written}, indent=1).replace("NaN", "null")
    (options.folder / "regressor_of_a_look.json").write_text(text)


if __name__ == "__main__":
    main()
