"""The places with the largest error of images, enlarged beside the same places of their references."""

from dataclasses import dataclass

import cv2
import numpy as np

from blender_scenes.render.image_errors import square_errors
from sensors.camera.response import CameraResponse, develop_part
from symolo.core.arrays import FloatImage

BLOCK_PX = 8
"""Side of the squares whose mean error is compared."""
_CROP_PX = 64, 48
"""Width and height of what is shown around the worst square."""
_TIMES = 4
_COLUMNS = 3
_GAP_PX = 8


@dataclass(frozen=True)
class WorstPlace:
    mean_square: float
    """Mean square error of the square, in grey values of 8 bits squared."""
    shown: np.ndarray
    """Image (h, w, 3), RGB: the rendering, and the mean of its references at its right."""


def worst_place(
    light: FloatImage, references: tuple[FloatImage, FloatImage], response: CameraResponse, metered: float
) -> WorstPlace:
    """Return the square with the largest mean error; for the arguments see `square_errors`."""
    errors = square_errors(light, references, response, metered).mean(axis=-1)
    height, width = errors.shape
    integral = cv2.integral(errors.astype(np.float64))
    k = BLOCK_PX
    sums = integral[k:, k:] - integral[:-k, k:] - integral[k:, :-k] + integral[:-k, :-k]
    top, left = np.unravel_index(np.argmax(sums), sums.shape)
    crop_w, crop_h = min(_CROP_PX[0], width), min(_CROP_PX[1], height)
    x = int(np.clip(left + k // 2 - crop_w // 2, 0, width - crop_w))
    y = int(np.clip(top + k // 2 - crop_h // 2, 0, height - crop_h))
    whole = beside_reference(light, references, response, metered)
    pair = np.hstack([half[y : y + crop_h, x : x + crop_w] for half in np.split(whole, 2, axis=1)])
    return WorstPlace(float(sums[top, left]) / k**2, pair)


def beside_reference(
    light: FloatImage, references: tuple[FloatImage, FloatImage], response: CameraResponse, metered: float
) -> np.ndarray:
    """Return an image (H, 2 W, 3) of the rendering, and of the mean of its references at its right."""
    calm = [develop_part(each, response, metered, None) for each in (light, 0.5 * (references[0] + references[1]))]
    return np.clip(np.hstack(calm), 0, 255).astype(np.uint8)


def sheet(places: dict[str, WorstPlace]) -> np.ndarray:
    """Return an image (H, W, 3), BGR, of enlarged places with their names."""
    tiles = []
    for name, place in places.items():
        large = cv2.resize(place.shown[..., ::-1], None, fx=_TIMES, fy=_TIMES, interpolation=cv2.INTER_NEAREST)
        tile = cv2.copyMakeBorder(large, 20, _GAP_PX, 0, _GAP_PX, cv2.BORDER_CONSTANT, value=(255, 255, 255))
        cv2.putText(tile, name, (2, 15), cv2.FONT_HERSHEY_SIMPLEX, 0.45, (0, 0, 0), 1, cv2.LINE_AA)
        tiles.append(tile)
    tiles += [np.full_like(tiles[0], 255)] * (-len(tiles) % _COLUMNS)
    return np.vstack([np.hstack(tiles[k : k + _COLUMNS]) for k in range(0, len(tiles), _COLUMNS)])
