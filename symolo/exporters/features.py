"""Columns of Parquet files that tell `datasets` what they are (https://huggingface.co/docs/datasets/about_dataset_features).

What `datasets` calls the features of a file stands in the metadata of its schema, as JSON under `huggingface`.
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
    """What a column holds."""

    told: Mapping[str, Any]
    """As `datasets` writes it down."""
    arrow: Any
    """Type of the library."""


def value(kind: str) -> Feature:
    """A number, text or bytes, such as `float64`, `string`, `binary`."""
    arrow = optional_module("pyarrow")
    return Feature({"dtype": kind, "_type": "Value"}, getattr(arrow, kind)())


def column(values: np.ndarray) -> tuple[Feature, Any]:
    """Numbers or texts (N,) as what they are."""
    return value("string" if values.dtype.kind in "OU" else str(values.dtype)), values


def vector(of: Feature, length: int) -> Feature:
    """So many of another; of vectors, a matrix by rows. Told by the name that old and new readers know."""
    arrow = optional_module("pyarrow")
    return Feature({"feature": of.told, "length": length, "_type": "Sequence"}, arrow.list_(of.arrow, length))


def picture() -> Feature:
    """A file of a picture, which `datasets` decodes by Pillow; values as `pictured` makes them."""
    arrow = optional_module("pyarrow")
    return Feature({"_type": "Image"}, arrow.struct({"bytes": arrow.binary(), "path": arrow.string()}))


def pictured(content: bytes, name: str) -> dict[str, object]:
    return {"bytes": content, "path": name}


def parquet_bytes(
    columns: Mapping[str, tuple[Feature, Sequence[Any]]], units: Mapping[str, str], *, rows_per_group: int | None = None
) -> bytes:
    """A file with these columns, the unit of each in the metadata of its field.

    Args:
        columns: Feature and values of each.
        units: By name; columns that are not named have none.
        rows_per_group: How many rows a reader has to take at once; as many as the library likes by default.
    """
    arrow = optional_module("pyarrow")
    fields = [
        arrow.field(name, feature.arrow, metadata={"unit": units[name]} if name in units else None)
        for name, (feature, _values) in columns.items()
    ]
    told = {"info": {"features": {name: feature.told for name, (feature, _values) in columns.items()}}}
    arrays = [arrow.array(values, feature.arrow) for feature, values in columns.values()]
    table = arrow.Table.from_arrays(arrays, schema=arrow.schema(fields, metadata={"huggingface": json.dumps(told)}))
    file = io.BytesIO()
    writer = optional_module("pyarrow.parquet")
    writer.write_table(table, file, compression="zstd", row_group_size=rows_per_group)
    return file.getvalue()


def stacked_bytes(data: Dataset, read: Callable[[Run], pd.DataFrame]) -> bytes:
    """A file of the tables of all runs under each other, the name of the run in the first column."""
    tables = [read(run) for run in data.runs]
    columns = {RUN: column(np.repeat([run.name for run in data.runs], [len(table) for table in tables]))}
    columns |= {str(name): column(np.concatenate([table[name].to_numpy() for table in tables])) for name in tables[0]}
    return parquet_bytes(columns, {RUN: "-"} | tables[0].attrs[UNITS])
