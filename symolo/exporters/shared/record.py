"""Readings, pose and camera of an image, for formats that store them with each image."""

import json

import numpy as np

from symolo.exporters.base import run_of
from symolo.reader.run_folder import Image


def record_of(image: Image) -> bytes:
    """Return JSON in one line with run, pose X_WC, K and D, and the row of data.csv at which the image was taken; that
    of a further camera has its name, and a row for its own time.

    The row has the names and units of the file; numbers of columns without decimals are integers, and what was not
    measured is null.
    """
    camera, table = image.run.camera, image.run.image_table
    values = [None if np.isnan(value) else value for value in table.at(image.index).tolist()]
    content: dict[str, object] = {
        column.name: value if column.decimals or value is None else int(value)
        for column, value in zip(table.definitions, values, strict=True)
    }
    content |= {**run_of(image), "X_WC": image.X_WC.tolist(), "K": camera.K.tolist(), "D": camera.D.tolist()}
    return (json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False) + "\n").encode()
