"""Jaggedness that the camera of the look `lab` gives a perfectly straight line, by its angle, beside photographs.

    python benchmarks/photographs/straight_edge.py PHOTOGRAPHS [--draws 6]

The line is drawn in closed form by counting fine samples in each pixel, on an even floor without any texture, so all
jaggedness comes from the camera response, from JPEG, and from the estimate itself. Nothing is rendered.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
from line_frames import HEIGHT_PX, ROWS, WIDTH_PX, Array
from photographs import photographs
from tell_apart import AFTER

from configs.draw import draw_run
from diagnosis.photographs.image_figures import ImageFigures
from sensors.camera.response import CameraResponse, compressed, develop
from symolo.core.arrays import FloatImage

SLOPES = (0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.85, 1.0)
"""Pixels to the side for each row."""
FINE = 16
"""Samples along each side of a pixel."""
HALF_WIDTH_PX, LINE, FLOOR = 18.0, 0.12, 0.5
"""Of the photographs, and light with about their contrast."""
QUALITY = 92
"""Of the JPEG files of a dataset."""


def middle_px(slope: float, offset_px: float, rows_px: Array) -> Array:
    """Return the middle of the line; 0 is the middle of the first pixel."""
    return 0.5 * (WIDTH_PX - 1) + offset_px + slope * (rows_px - 0.5 * (HEIGHT_PX - 1))


def drawn(slope: float, offset_px: float) -> FloatImage:
    """Return the light (H, W, 3) of a straight line."""
    x_px, rows_px = (((np.arange(length * FINE) + 0.5) / FINE - 0.5) for length in (WIDTH_PX, HEIGHT_PX))
    away_px = np.abs(x_px - middle_px(slope, offset_px, rows_px)[:, None]) / np.hypot(1, slope)
    share = (away_px < HALF_WIDTH_PX).reshape(HEIGHT_PX, FINE, WIDTH_PX, FINE).mean(axis=(1, 3))
    return np.repeat((FLOOR + (LINE - FLOOR) * share)[..., None], 3, axis=-1).astype(np.float32)


def jaggedness_px(response: CameraResponse, slope: float, draws: int, *, jpeg: bool) -> float:
    """Return the median over lines in several places, with different noise."""
    seen = []
    for draw in range(draws):
        light, rows_px = drawn(slope, 0.37 * draw), np.array(ROWS)
        pixels = develop(light, response, float(np.median(light)), draw + 1)
        pixels = compressed(pixels, QUALITY) if jpeg else pixels
        bgr = np.ascontiguousarray(pixels[..., ::-1])
        seen.append(ImageFigures.from_image(bgr, middle_px(slope, 0.37 * draw, rows_px), ROWS).jaggedness_px)
    return float(np.median(seen))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("photographs", type=Path)
    parser.add_argument("--draws", type=int, default=6, help="lines of each slope")
    options = parser.parse_args()
    loaded = AFTER.scenario()
    look = draw_run(loaded, loaded.routes[0].name, 1).look
    camera = look.camera.model_copy(update={"vignetting": 0.0, "compensation_ev": 0.0})
    response = CameraResponse.from_look(camera, (1.0, 1.0, 1.0), 1, QUALITY, WIDTH_PX)
    calm = replace(response, shot_noise=0.0, read_noise=0.0)
    print("slope, jaggedness [px] of a straight line: camera and JPEG, without noise, without noise and JPEG")
    for slope in SLOPES:
        values = [
            jaggedness_px(*case, options.draws, jpeg=jpeg)
            for case, jpeg in (((response, slope), True), ((calm, slope), True), ((calm, slope), False))
        ]
        print(f"{slope:5} " + " ".join(f"{value:7.3f}" for value in values), flush=True)
    print("photograph, slope, jaggedness [px]: as it is, as JPEG")
    real = photographs(options.photographs, branch=False)
    for name, image, x_px in zip(real.names, real.images, real.x_px, strict=True):
        known = np.isfinite(x_px)
        if known.sum() > 1:
            slope = np.polyfit(np.array(ROWS)[known], x_px[known], 1)[0]
            as_jpeg = compressed(np.ascontiguousarray(image[..., ::-1]), QUALITY)[..., ::-1]
            both = [
                ImageFigures.from_image(np.ascontiguousarray(each), x_px, ROWS).jaggedness_px
                for each in (image, as_jpeg)
            ]
            print(f"{name:10} {slope:6.2f} " + " ".join(f"{value:7.3f}" for value in both))


if __name__ == "__main__":
    main()
