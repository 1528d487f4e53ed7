"""All tables of all runs as Apache Parquet, one file for each kind of table, images beside them.

Each column has its unit in the metadata of its field, under `unit` (https://parquet.apache.org/docs/file-format/).
"""

import io
from collections.abc import Callable, Iterator, Mapping
from types import ModuleType

import numpy as np
import pandas as pd

from configs.errors import InputError
from pipeline.exporters.base import CopiedFile, ExportedFile, Exporter, ExportSettings, MadeFile
from pipeline.exporters.optional import PYARROW, optional
from pipeline.reader.dataset import RUN, Dataset
from pipeline.reader.image import Image
from pipeline.reader.run import Run
from pipeline.reader.tables import UNITS

_CAMERA = "camera"
FILE_NAME = "file_name"
"""Column of images.parquet that names the picture, from the folder that it lies in."""


def _files(data: Dataset, _settings: ExportSettings) -> Iterator[ExportedFile]:
    arrow = optional("pyarrow", PYARROW)
    names = data.runs[0].side_names
    for run in data.runs[1:]:
        if run.side_names != names:
            raise InputError("has other side tables than the first run", where=str(run.folder), cure="use --runs")
    yield _table(arrow, "rows", data, lambda run: run.rows)
    for name in names:
        if name != _CAMERA:
            yield _table(arrow, name, data, lambda run, name=name: run.side(name))
    yield _table(arrow, "images", data, _images)
    for image in data.images:
        yield CopiedFile(_file_name(image), image.path)


def _file_name(image: Image) -> str:
    return f"images/{image.run.name}/{image.path.name}"


def _images(run: Run) -> pd.DataFrame:
    """camera.csv, and which file it is of."""
    table = run.side(_CAMERA)
    table[FILE_NAME] = [_file_name(image) for image in run.images]
    table.attrs[UNITS] = table.attrs[UNITS] | {FILE_NAME: "-"}
    return table


def _table(arrow: ModuleType, name: str, data: Dataset, read: Callable[[Run], pd.DataFrame]) -> MadeFile:
    """The tables of all runs under each other, the name of the run in the first column."""

    def make() -> bytes:
        tables = [read(run) for run in data.runs]
        runs = np.repeat([run.name for run in data.runs], [len(table) for table in tables])
        columns = {RUN: runs} | {
            column: np.concatenate([table[column].to_numpy() for table in tables]) for column in tables[0].columns
        }
        return _parquet(arrow, columns, {RUN: "-"} | tables[0].attrs[UNITS])

    return MadeFile(f"{name}.parquet", make)


def _parquet(arrow: ModuleType, columns: Mapping[str, np.ndarray], units: Mapping[str, str]) -> bytes:
    arrays = {name: arrow.array(values) for name, values in columns.items()}
    fields = [arrow.field(name, array.type, metadata={"unit": units[name]}) for name, array in arrays.items()]
    table = arrow.Table.from_arrays([*arrays.values()], schema=arrow.schema(fields))
    file = io.BytesIO()
    optional("pyarrow.parquet", PYARROW).write_table(table, file, compression="zstd")
    return file.getvalue()


EXPORTER = Exporter("parquet", "all tables of all runs as Parquet with their units, images beside them", _files)
