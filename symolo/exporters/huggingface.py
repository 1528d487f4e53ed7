"""A folder that `datasets` loads (https://huggingface.co/docs/datasets): pictures with what belongs to them, and rows.

`load_dataset(folder)` gives a row for each image, pictures decoded; `load_dataset(folder, "rows")` one for each control
period. The files of pictures are in the Parquet files, byte by byte.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from symolo.core.errors import InputError
from symolo.core.extras import optional_module
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.tables.rows import COLUMNS
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings, MadeFile
from symolo.exporters.features import Feature, column, parquet_bytes, picture, pictured, stacked_bytes, value, vector
from symolo.reader.dataset import RUN, Dataset
from symolo.reader.run import Image, Run
from symolo.reader.tables import UNITS

_CAMERA = "camera"
_IN_16_BIT_COLOUR = ("normals", "flow")
"""Pillow would cut these to 8 bits; they are the bytes of a PNG file."""
_PICTURES_PER_GROUP = 100
Columns = dict[str, tuple[Feature, Sequence[Any]]]


def _files(data: Dataset, settings: ExportSettings) -> Iterator[ExportedFile]:
    optional_module("pyarrow")
    first = data.runs[0]
    for run in data.runs[1:]:
        if (run.side_names, run.annotation_pictures) != (first.side_names, first.annotation_pictures):
            what = "has other side tables or annotations than the first run"
            raise InputError(what, where=str(run.folder), cure="use --runs")
    yield MadeFile("README.md", lambda: _card(data))
    shards = list(_shards(data.images, settings.shard_bytes))
    for number, images in enumerate(shards):
        name = f"images/train-{number:05d}-of-{len(shards):05d}.parquet"
        size = sum(map(_bytes, images))
        yield MadeFile(name, lambda images=images: _pictures(images, first.annotation_pictures), lambda size=size: size)
    yield MadeFile("rows/train-00000-of-00001.parquet", lambda: stacked_bytes(data, _wide))


def _shards(images: Sequence[Image], max_bytes: int) -> Iterator[tuple[Image, ...]]:
    """In their order; the pictures of a shard are more than `max_bytes` only where those of one image alone are."""
    shard: list[Image] = []
    used = 0
    for image in images:
        size = _bytes(image)
        if shard and used + size > max_bytes:
            yield tuple(shard)
            shard, used = [], 0
        shard.append(image)
        used += size
    if shard:
        yield tuple(shard)


def _bytes(image: Image) -> int:
    """Of its picture and annotations."""
    return sum(path.stat().st_size for path in (image.path, *_annotations(image).values()))


def _annotations(image: Image) -> dict[str, Path]:
    """Pictures by kind, but for the flow that the last image has not."""
    paths = {kind: image.run.annotation_picture(kind, image.number) for kind in image.run.annotation_pictures}
    return {kind: path for kind, path in paths.items() if path.is_file()}


def _pictures(images: Sequence[Image], kinds: Sequence[str]) -> bytes:
    rows = np.array([image.run.table.at(image.row) for image in images])
    number = value("float64")
    columns: Columns = {
        "image": (picture(), [_pictured(image, image.path) for image in images]),
        RUN: (value("string"), [image.run.name for image in images]),
    }
    columns |= {
        of.name: column(values if of.decimals else values.astype(np.int64))
        for of, values in zip(COLUMNS, rows.T, strict=True)
    }
    columns |= {
        "X_WC": (vector(vector(number, 4), 4), [image.X_WC.tolist() for image in images]),
        "K": (vector(vector(number, 3), 3), [image.run.camera.K for image in images]),
        "D": (vector(number, 5), [image.run.camera.D for image in images]),
    }
    for kind in kinds:
        found = [_annotations(image).get(kind) for image in images]
        if kind in _IN_16_BIT_COLOUR:
            columns[kind] = value("binary"), [read_file(path, FileKind.IMAGE) if path else None for path in found]
        else:
            shown = zip(images, found, strict=True)
            columns[kind] = picture(), [_pictured(image, path) if path else None for image, path in shown]
    units = {column.name: column.unit for column in COLUMNS}
    return parquet_bytes(columns, units, rows_per_group=_PICTURES_PER_GROUP)


def _pictured(image: Image, path: Path) -> dict[str, object]:
    return pictured(read_file(path, FileKind.IMAGE), f"{image.run.name}/{path.name}")


def _wide(run: Run) -> pd.DataFrame:
    """data.csv and the side tables beside it; the times of these are those of data.csv."""
    sensors = {table.name for table in run.sensor_tables}
    tables, units = [run.rows], {}
    for name in run.side_names:
        if name != _CAMERA:
            table = run.side(name).drop(columns="t")
            prefix = f"{name}_" if name in sensors else ""  # two sensors may have columns of the same name
            units |= {f"{prefix}{column}": table.attrs[UNITS][column] for column in table}
            tables.append(table.add_prefix(prefix))
    wide = pd.concat(tables, axis=1)
    wide.attrs[UNITS] = tables[0].attrs[UNITS] | units
    return wide


def _card(data: Dataset) -> bytes:
    """What the hub calls the card of a dataset; its head says which files are what."""
    told = data.metadata
    name, about = (told.name, told.description) if told else (data.root.name, "")
    licence = [f"license: {told.licence.lower()}"] if told else []
    units = _wide(data.runs[0]).attrs[UNITS]
    lines = [
        "---",
        *licence,
        "configs:",
        *_config("images", default=True),
        *_config("rows"),
        "---",
        f"# {name}",
        "",
        *([about, ""] if about else []),
        "A row of `images` is an image with the row of `rows` at which it was taken, the camera's pose X_WC, K and D;",
        "a row of `rows` is a control period. Depth is in 0.1 mm; `normals` and `flow` are PNG files of 16 bits.",
        "",
        "| column | unit |",
        "|---|---|",
        *(f"| {column} | {unit} |" for column, unit in units.items()),
    ]
    return ("\n".join(lines) + "\n").encode()


def _config(name: str, *, default: bool = False) -> list[str]:
    lines = [f"- config_name: {name}", "  data_files:", "  - split: train", f"    path: {name}/*.parquet"]
    return [*lines, "  default: true"] if default else lines


EXPORTER = Exporter("huggingface", "Parquet with pictures, readings and poses that `datasets` loads, and rows", _files)
