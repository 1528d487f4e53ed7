"""What of an image's moment goes beside its picture in formats that have samples."""

import json

from symolo.dataset.tables.rows import COLUMNS
from symolo.reader.run import Image


def row_of(image: Image) -> dict[str, float | int]:
    """The row of data.csv at which it was taken, in the units of the file; counts are integers."""
    row = image.run.table.at(image.row).tolist()
    return {column.name: value if column.decimals else int(value) for column, value in zip(COLUMNS, row, strict=True)}


def record_of(image: Image) -> bytes:
    """That row, the run's name, the camera's pose and its intrinsics, as JSON in one line."""
    camera = image.run.camera
    content = row_of(image) | {"run": image.run.name, "X_WC": image.X_WC.tolist(), "K": camera.K, "D": camera.D}
    return (json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False) + "\n").encode()
