"""All tables of all runs as Apache Parquet, one file for each kind of table, and the images in a folder.

Each column has its unit in the metadata of its field, under `unit` (https://parquet.apache.org/docs/file-format/).
"""

from collections.abc import Callable, Iterator, Sequence

import pandas as pd

from symolo.core.errors import InputError
from symolo.core.extras import optional_module
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings, copied_file
from symolo.exporters.shared.features import stacked_bytes
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run
from symolo.reader.run_folder import Image, RunFolder
from symolo.reader.tables import UNITS

_CAMERA = "camera"
SPLIT = "split"
"""Column with the split of a run or image, if the dataset is divided."""
FILE_NAME = "file_name"
"""Column of images.parquet with the path of the image file, relative to the export."""


def _files(data: Dataset, _settings: ExportSettings) -> Iterator[ExportedFile]:
    optional_module("pyarrow")
    names, cameras = data.runs[0].side_names, tuple(data.runs[0].cameras)
    for run in data.runs[1:]:
        if (run.side_names, tuple(run.cameras)) != (names, cameras):
            what, cure = "has different side tables or cameras than the first run", "export them separately with --runs"
            raise InputError(what, where=str(run.folder), cure=cure)
    readers: dict[str, Callable[[Run], pd.DataFrame]] = {"rows": lambda run: run.rows}
    readers |= {name: lambda run, name=name: run.side(name) for name in names if name != _CAMERA}
    if data.images:
        readers["images"] = _images
    readers |= {f"cameras/{name}": lambda run, name=name: _images(run.cameras[name]) for name in cameras}
    if data.splits is not None and data.splits.by == "image":
        split_by_image = data.splits.split_by_image
        readers["images"] = lambda run: _with_split(_images(run), [split_by_image[run.name, n] for n in run.numbers])
    elif data.splits is not None:
        split_by_run = data.splits.split_by_run
        for name, read in tuple(readers.items()):
            readers[name] = lambda run, read=read: _with_split(read(run), split_by_run[run.name])
    for name, read in readers.items():
        yield ExportedFile(f"{name}.parquet", lambda read=read: stacked_bytes(data, read))
    further = (image for run in data.runs for camera in run.cameras.values() for image in camera)
    for image in (*data.images, *further):
        yield copied_file(_file_name(image), image.path)


def _with_split(table: pd.DataFrame, names: str | Sequence[str]) -> pd.DataFrame:
    """Return a table of a run with its split, or the split of each image, in the first column."""
    table.insert(0, SPLIT, names)
    table.attrs[UNITS] = table.attrs[UNITS] | {SPLIT: "-"}
    return table


def _file_name(image: Image) -> str:
    return f"images/{image.run.name}/{image.path.name}"


def _images(run: RunFolder) -> pd.DataFrame:
    """Return camera.csv with the path of each image file."""
    table = run.side(_CAMERA)
    table[FILE_NAME] = [_file_name(image) for image in run.images]
    table.attrs[UNITS] = table.attrs[UNITS] | {FILE_NAME: "-"}
    return table


EXPORTER = Exporter("parquet", "all tables of all runs as Parquet with their units, images beside them", _files)
