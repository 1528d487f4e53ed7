"""Strict reading of the side files of a run; tables must have the times of data.csv."""

from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ValidationError

from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.manifest import repair_cure
from symolo.dataset.tables.rows import Rows, parse_table
from symolo.dataset.tables.side_tables import CAMERA, SideTable

Record = TypeVar("Record", bound=BaseModel)


def read_record(path: Path, kind: type[Record]) -> Record:
    """Return the record in a JSON file.

    Raises:
        OSError: There is no such file.
        ValueError: It is damaged; the text is one line.
    """
    try:
        return kind.model_validate_json(read_file(path, FileKind.DOCUMENT))
    except ValidationError as error:
        raise ValueError(first_fault(error)) from None


def first_fault(error: ValidationError) -> str:
    """Return the first fault of a JSON file in one line: the path of the field and what is wrong with it."""
    first = error.errors()[0]
    return ": ".join(filter(None, (".".join(map(str, first["loc"])), first["msg"])))


def read_image_times(path: Path, rows: Rows) -> NDArray[np.int64]:
    """Return the times [ms] of the images of a camera of a log (N,), of its side/camera.csv.

    Raises:
        InputError: The file cannot be read or is damaged, or the times do not increase within those of data.csv.
    """
    try:
        data = read_file(path, FileKind.TABLE)
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", where=str(path), cure="make the run again") from None
    numbers, faults = parse_table(data, CAMERA.header)
    if faults:
        raise InputError(faults[0].what, where=f"{path}: row {faults[0].line}", cure=faults[0].cure)
    try:
        return image_times(numbers, rows)
    except ValueError as error:
        raise InputError(str(error), where=str(path), cure="make the run again") from None


def image_times(numbers: Array, rows: Rows) -> NDArray[np.int64]:
    """Return the times [ms] (N,) in the numbers (N, columns) of side/camera.csv.

    Raises:
        ValueError: They do not increase within those of data.csv; the text is one line.
    """
    t_ms = np.rint(numbers[:, CAMERA.header.index("t")]).astype(np.int64)
    if np.any(np.diff(t_ms) <= 0) or np.any((t_ms < rows.t_ms[0]) | (t_ms > rows.t_ms[-1])):
        raise ValueError("column t does not increase within the times of data.csv")
    return t_ms


def read_side(path: Path, table: SideTable, rows: Rows) -> Array:
    """Return the numbers of a side table, (rows, columns) for the rows of data.csv, its images, or its own samples.

    Raises:
        InputError: It cannot be read, or its format, times or images are wrong.
    """
    cure = repair_cure(path, "make the run again")
    try:
        data = read_file(path, FileKind.TABLE)
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", where=str(path), cure=cure) from None
    numbers, faults = parse_table(data, table.header, may_be_empty=table.empty_names)
    if faults:
        raise InputError(faults[0].what, where=f"{path}: row {faults[0].line}", cure=repair_cure(path, faults[0].cure))
    if table.rows_of == "samples":
        t_ms = numbers[:, 0]
        if np.any(np.diff(t_ms) <= 0.0) or np.any((t_ms < rows.t_ms[0]) | (t_ms > rows.t_ms[-1])):
            what = "column t does not increase within the times of data.csv"
            raise InputError(what, where=str(path), cure=cure)
        return numbers
    taken = rows.image > 0
    is_of_images = table.rows_of == "images"
    keys = np.column_stack((rows.image[taken], rows.t_ms[taken])) if is_of_images else rows.t_ms[:, None]
    for name, column, expected in zip(table.header, numbers.T, keys.T, strict=False):
        if not np.array_equal(column, expected):
            raise InputError(f"column {name} is not that of data.csv", where=str(path), cure=cure)
    return numbers
