"""Parquet files with typed columns for `datasets` (https://huggingface.co/docs/datasets/about_dataset_features).

`datasets` reads the types, which it calls features, from the metadata of the schema: JSON under `huggingface`. Its own
writer (5.2.0) is not used: it needs a dozen more packages and has no place for the units of the columns.
"""

import io
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from symolo.core.extras import optional_module
from symolo.reader.dataset import RUN, Dataset
from symolo.reader.run import Run
from symolo.reader.tables import UNITS


@dataclass(frozen=True)
class Feature:
    """Type of a column."""

    description: Mapping[str, Any]
    """Description of the type as `datasets` writes it."""
    arrow: Any
    """Type in pyarrow."""


def value(kind: str) -> Feature:
    """Return the type of a number, text or bytes, such as `float64`, `string`, `binary`."""
    arrow = optional_module("pyarrow")
    return Feature({"dtype": kind, "_type": "Value"}, getattr(arrow, kind)())


def column(values: np.ndarray) -> tuple[Feature, Any]:
    """Return the type of numbers or texts (N,), and the values."""
    return value("string" if values.dtype.kind in "OU" else str(values.dtype)), values


def vector(item: Feature, length: int) -> Feature:
    """Return the type of a list with a fixed length; a vector of vectors is a matrix by rows."""
    arrow = optional_module("pyarrow")
    # Old and new versions of `datasets` know the name "Sequence"; new ones write "List".
    return Feature(
        {"feature": item.description, "length": length, "_type": "Sequence"}, arrow.list_(item.arrow, length)
    )


def image_file() -> Feature:
    """Return the type of an image file, decoded with Pillow; values are dicts of `bytes` and `path`."""
    arrow = optional_module("pyarrow")
    return Feature({"_type": "Image"}, arrow.struct({"bytes": arrow.binary(), "path": arrow.string()}))


def parquet_bytes(
    columns: Mapping[str, tuple[Feature, Sequence[Any]]], units: Mapping[str, str], *, rows_per_group: int | None = None
) -> bytes:
    """Return a file with these columns; the metadata of each field has the unit.

    Args:
        columns: Type and values of each column.
        units: Unit of each column, by its name.
        rows_per_group: Number of rows that a reader loads together; None for the library's default.
    """
    arrow = optional_module("pyarrow")
    fields = [
        arrow.field(name, feature.arrow, metadata={"unit": units[name]} if name in units else None)
        for name, (feature, _values) in columns.items()
    ]
    info = {"info": {"features": {name: feature.description for name, (feature, _values) in columns.items()}}}
    arrays = [arrow.array(values, feature.arrow) for feature, values in columns.values()]
    table = arrow.Table.from_arrays(arrays, schema=arrow.schema(fields, metadata={"huggingface": json.dumps(info)}))
    file = io.BytesIO()
    optional_module("pyarrow.parquet").write_table(table, file, compression="zstd", row_group_size=rows_per_group)
    return file.getvalue()


def stacked_bytes(data: Dataset, read: Callable[[Run], pd.DataFrame]) -> bytes:
    """Return a file with the rows of all runs, one run after the other; the first column is the name of the run."""
    tables = [read(run) for run in data.runs]
    columns = {RUN: column(np.repeat([run.name for run in data.runs], [len(table) for table in tables]))}
    columns |= {str(name): column(np.concatenate([table[name].to_numpy() for table in tables])) for name in tables[0]}
    return parquet_bytes(columns, {RUN: "-"} | tables[0].attrs[UNITS])
