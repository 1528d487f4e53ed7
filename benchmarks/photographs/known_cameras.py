"""How well `symolo look from` gives back cameras that are known.

python benchmarks/photographs/known_cameras.py [--cameras 40]

Each camera is that of a draw of `extreme` or `classroom`, with blur of at least 0.3 px. Its five photographs of 160 x
120 px show a line of random width, level, place and slant on a mottled floor under uneven light. They are developed by
the camera model and compressed like a dataset; nothing is rendered. The base look of the fit is the one that the camera
was drawn from, with another draw.
"""

import argparse

import cv2
import numpy as np

from configs.draw import draw_run
from configs.loader import load_scenario
from configs.schema.appearance.camera_look import CameraLook
from diagnosis.photographs.camera_fit import developed, fit_camera
from diagnosis.photographs.line_place import BgrImage, find_lines
from diagnosis.photographs.measures import PhotographMeasures
from pipeline.look_from_photographs.fit import base_camera
from symolo.core.random_streams import stream

WIDTH_PX, HEIGHT_PX = 160, 120
PHOTOGRAPHS = 5


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cameras", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    errors: dict[str, list[float]] = {}
    for number in range(options.cameras):
        base = ("extreme", "classroom")[number % 2]
        camera = _camera(base, options.seed, number)
        rng = stream(options.seed, "photographs", number)
        images = [photograph(camera, rng) for _ in range(PHOTOGRAPHS)]
        places = find_lines(images)
        measured = [m for place in places if place and (m := PhotographMeasures.from_place("known", place))]
        if len(measured) < 3:
            print(f"camera {number}: a line in {len(measured)} of {PHOTOGRAPHS} photographs")
            continue
        # The tone curve cannot be seen in photographs; the fit takes it from the base look, here the right one.
        fitted = fit_camera(measured, base_camera(base).model_copy(update={"contrast": camera.contrast})).look
        for name, error in _errors(camera, fitted).items():
            errors.setdefault(name, []).append(error)
    print(f"\n{'error':24}{'median':>10}{'90 % below':>12}{'largest':>10}")
    for name, values in errors.items():
        size = np.abs(values)
        print(f"{name:24}{np.median(size):10.3f}{np.quantile(size, 0.9):12.3f}{size.max():10.3f}")


def _camera(base: str, seed: int, number: int) -> CameraLook:
    loaded = load_scenario("smoke", (f"look={base}", f"seed={1000 * seed + number}"))
    camera = draw_run(loaded, loaded.routes[0].name, 1).look.camera
    blur_px = max(camera.lens_blur_px, 0.3)
    return camera.model_copy(update={"exposure_time_s": 0.0, "compensation_ev": 0.0, "lens_blur_px": blur_px})


def photograph(camera: CameraLook, rng: np.random.Generator) -> BgrImage:
    """Return an image of a line on a mottled floor under uneven light, blue first."""
    finer = 4
    y, x = (np.mgrid[0 : HEIGHT_PX * finer, 0 : WIDTH_PX * finer] + 0.5) / finer - 0.5
    middle = WIDTH_PX * rng.uniform(0.35, 0.65) + rng.uniform(-0.4, 0.4) * (y - 0.5 * HEIGHT_PX)
    covered = (np.abs(x - middle) < 0.5 * rng.uniform(24, 40)).astype(np.float32)
    covered = cv2.resize(covered, (WIDTH_PX, HEIGHT_PX), interpolation=cv2.INTER_AREA)[..., None]
    rough = cv2.GaussianBlur(rng.standard_normal((HEIGHT_PX, WIDTH_PX)), (0, 0), 6.0)
    mottled = 1 + rng.uniform(0.02, 0.08) * rough / rough.std()
    slope = rng.uniform(-0.3, 0.3, 2)
    v, u = np.mgrid[0:HEIGHT_PX, 0:WIDTH_PX] / WIDTH_PX - 0.4
    floor = (mottled * (1 + slope[0] * u + slope[1] * v))[..., None] * (1 + rng.uniform(-0.05, 0.05, 3))
    light = floor * (1 - covered * (1 - rng.uniform(0.08, 0.2)))
    light = light * camera.brightness / np.median(light)
    return developed(light.astype(np.float32), camera, seed=int(rng.integers(2**31)))


def _errors(camera: CameraLook, fitted: CameraLook) -> dict[str, float]:
    """Return the errors of the settings; noise is compared at the light of the floor."""

    def noise(look: CameraLook) -> float:
        return float(np.sqrt(look.shot_noise**2 * camera.brightness + look.read_noise**2))

    return {
        "lens_blur_px": fitted.lens_blur_px - camera.lens_blur_px,
        "vignetting": fitted.vignetting - camera.vignetting,
        "brightness, relative": fitted.brightness / camera.brightness - 1,
        "noise, relative": noise(fitted) / max(noise(camera), 1e-3) - 1,
        "sharpening": fitted.sharpening - camera.sharpening,
    }


if __name__ == "__main__":
    main()
