"""All tables of all runs as Apache Parquet, one file for each kind of table, images beside them.

Each column has its unit in the metadata of its field, under `unit` (https://parquet.apache.org/docs/file-format/).
"""

from collections.abc import Callable, Iterator

import pandas as pd

from symolo.core.errors import InputError
from symolo.core.extras import optional_module
from symolo.exporters.base import CopiedFile, ExportedFile, Exporter, ExportSettings, MadeFile
from symolo.exporters.features import stacked_bytes
from symolo.reader.dataset import Dataset
from symolo.reader.run import Image, Run
from symolo.reader.tables import UNITS

_CAMERA = "camera"
FILE_NAME = "file_name"
"""Column of images.parquet that names the picture, from the folder that it lies in."""


def _files(data: Dataset, _settings: ExportSettings) -> Iterator[ExportedFile]:
    optional_module("pyarrow")
    names = data.runs[0].side_names
    for run in data.runs[1:]:
        if run.side_names != names:
            raise InputError("has other side tables than the first run", where=str(run.folder), cure="use --runs")
    yield _table("rows", data, lambda run: run.rows)
    for name in names:
        if name != _CAMERA:
            yield _table(name, data, lambda run, name=name: run.side(name))
    yield _table("images", data, _images)
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


def _table(name: str, data: Dataset, read: Callable[[Run], pd.DataFrame]) -> MadeFile:
    return MadeFile(f"{name}.parquet", lambda: stacked_bytes(data, read))


EXPORTER = Exporter("parquet", "all tables of all runs as Parquet with their units, images beside them", _files)
