"""A folder that `datasets` can load (https://huggingface.co/docs/datasets): images with readings and poses, and rows.

`load_dataset(folder)` gives a row for each image, decoded; `load_dataset(folder, "rows")` gives a row for each control
period, and `load_dataset(folder, NAME)` each sample of a sensor. The Parquet files contain the unchanged bytes of the
image files.
"""

from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from symolo.core.batches import batches
from symolo.core.errors import InputError
from symolo.core.extras import optional_module
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.documents.description import markdown_table
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings, run_of
from symolo.exporters.shared.features import Feature, column, image_file, parquet_bytes, stacked_bytes, value, vector
from symolo.exporters.shared.hub_card import hub_card
from symolo.exporters.shared.labels import label_files, labels_part
from symolo.exporters.shared.splits import images_of_splits, runs_of_splits
from symolo.reader.balance import balance
from symolo.reader.dataset import RUN, Dataset
from symolo.reader.run import Run
from symolo.reader.run_folder import Image
from symolo.reader.tables import UNITS

_CAMERA = "camera"
_IN_16_BIT_COLOUR = ("normals", "flow")
"""Annotations that Pillow would cut to 8 bits; they are stored as the bytes of a PNG file."""
_IMAGES_PER_GROUP = 100
_WHOLE = "00000-of-00001.parquet"
"""End of the name of a file that has all rows of a split."""
_IMAGES_TEXT = (
    "A row of `images` is an image with the row of `rows` at which it was taken, the camera's pose X_WC, K and D."
)
_UNDIVIDED = "train"
"""Split of a dataset without splits, as `datasets` names it."""
_NOT_DIVIDED_ROWS = "all"
"""Split of the rows if only the images are divided."""
Columns = dict[str, tuple[Feature, Sequence[Any]]]


def _files(data: Dataset, settings: ExportSettings) -> Iterator[ExportedFile]:
    optional_module("pyarrow")
    first = data.runs[0]
    for run in data.runs[1:]:
        if _kinds(run) != _kinds(first):
            what = "has different side tables, cameras or annotations than the first run"
            raise InputError(what, where=str(run.folder), cure="export them separately with --runs")
    yield ExportedFile("README.md", cache(lambda: _card(data)))
    yield from label_files(data)
    for split, split_images in images_of_splits(data):
        yield from _shards(f"images/{split or _UNDIVIDED}", split_images, first.annotation_kinds, settings)
    for split, part in _row_splits(data):
        yield ExportedFile(f"rows/{split}-{_WHOLE}", lambda part=part: stacked_bytes(part, _wide))
        for name in _sensors(first):
            yield ExportedFile(
                f"{name}/{split}-{_WHOLE}",
                lambda part=part, name=name: stacked_bytes(part, lambda run: run.side(name)),
            )
    for name, camera in first.cameras.items():
        for split, part in _row_splits(data):
            images = [image for run in part.runs for image in run.cameras[name]]
            yield from _shards(f"{name}/{split}", images, camera.annotation_kinds, settings)


def _shards(
    start: str, images: Sequence[Image], kinds: Sequence[str], settings: ExportSettings
) -> Iterator[ExportedFile]:
    """Yield the files of some images, whose names begin with `start`."""
    shards = list(batches(images, _bytes, settings.shard_bytes))
    for number, shard in enumerate(shards):
        size = sum(map(_bytes, shard))
        name = f"{start}-{number:05d}-of-{len(shards):05d}.parquet"
        yield ExportedFile(name, lambda shard=shard: _images(shard, kinds), lambda size=size: size)


def _kinds(run: Run) -> tuple[object, ...]:
    """Return what all runs of an export must have in common."""
    cameras = {name: camera.annotation_kinds for name, camera in run.cameras.items()}
    return run.side_names, run.annotation_kinds, cameras


def _row_splits(data: Dataset) -> list[tuple[str, Dataset]]:
    """Return each split with its runs; the rows of a dataset that is divided by image are in one split."""
    whole = _UNDIVIDED if data.splits is None else _NOT_DIVIDED_ROWS
    return [(split or whole, part) for split, part in runs_of_splits(data)]


def _bytes(image: Image) -> int:
    """Return the size of an image and its annotations."""
    return sum(path.stat().st_size for path in (image.path, *image.annotation_files.values()))


def _images(images: Sequence[Image], kinds: Sequence[str]) -> bytes:
    rows = np.array([image.run.image_table.at(image.index) for image in images])
    number = value("float64")
    columns: Columns = {
        "image": (image_file(), [_file(image, image.path) for image in images]),
        RUN: (value("string"), [run_of(image)[RUN] for image in images]),
    }
    columns |= {
        reading.name: column(values if reading.decimals else values.astype(np.int64))
        for reading, values in zip(images[0].run.table.definitions, rows.T, strict=True)
    }
    columns |= {
        "X_WC": (vector(vector(number, 4), 4), [image.X_WC.tolist() for image in images]),
        "K": (vector(vector(number, 3), 3), [image.run.camera.K.tolist() for image in images]),
        "D": (vector(number, len(images[0].run.camera.D)), [image.run.camera.D.tolist() for image in images]),
    }
    for kind in kinds:
        paths = [image.annotation_files.get(kind) for image in images]
        if kind in _IN_16_BIT_COLOUR:
            columns[kind] = value("binary"), [read_file(path, FileKind.IMAGE) if path else None for path in paths]
        else:
            files = [_file(image, path) if path else None for image, path in zip(images, paths, strict=True)]
            columns[kind] = image_file(), files
    units = {column.name: column.unit for column in images[0].run.table.definitions}
    return parquet_bytes(columns, units, rows_per_group=_IMAGES_PER_GROUP)


def _file(image: Image, path: Path) -> dict[str, object]:
    return {"bytes": read_file(path, FileKind.IMAGE), "path": f"{image.run.name}/{path.name}"}


def _wide(run: Run) -> pd.DataFrame:
    """Return data.csv with the columns of the side tables, which have the same times."""
    others = {_CAMERA, *_sensors(run)}
    tables, units = [run.rows], {}
    for name in run.side_names:
        if name not in others:
            table = run.side(name).drop(columns="t")
            units |= {column: table.attrs[UNITS][column] for column in table}
            tables.append(table)
    wide = pd.concat(tables, axis=1)
    wide.attrs[UNITS] = tables[0].attrs[UNITS] | units
    return wide


def _sensors(run: Run) -> tuple[str, ...]:
    """Return the names of the sensors of `robot.sensors`, whose samples are at times of their own."""
    return tuple(table.name for table in run.sensor_tables)


def _card(data: Dataset) -> bytes:
    units, sensors, cameras = _wide(data.runs[0]).attrs[UNITS], _sensors(data.runs[0]), tuple(data.runs[0].cameras)
    is_imported = data.metadata is not None and any(run.is_imported for run in data.metadata.runs)
    text = [
        *([_IMAGES_TEXT] if data.images else []),
        f"A row of `rows` is {'a pose of the log' if is_imported else 'a control period'}.",
        *(f"A row of `{name}` is a sample of this sensor, at time `t` in ms." for name in sensors),
        *(f"A row of `{name}` is an image of this further camera, with the columns of `images`." for name in cameras),
        *_balance(data),
        *labels_part(data, "images"),
        "",
        "| column | unit |",
        "|---|---|",
        *(f"| {column} | {unit} |" for column, unit in units.items()),
    ]
    names = (*(["images"] if data.images else []), "rows", *sensors, *cameras)
    row_splits = [split for split, _ in _row_splits(data)]
    image_splits = [split or _UNDIVIDED for split, images in images_of_splits(data) if images]
    configs = [
        line
        for name in names
        for line in _config(name, image_splits if name == "images" else row_splits, default=name == names[0])
    ]
    return hub_card(data, ["configs:", *configs], text)


def _balance(data: Dataset) -> list[str]:
    """Return lines with the content of each split; none if the dataset is not divided."""
    content = balance(data)
    if content is None:
        return []
    names = [split.name for split in content.splits]
    rows = [(name, *cells) for name, cells in content.rows]
    warnings = [f"- {text}." for text in content.warnings]
    return [
        "",
        content.how,
        "",
        *([*warnings, ""] if warnings else []),
        *markdown_table(("", *names), rows).splitlines(),
    ]


def _config(name: str, splits: Sequence[str], *, default: bool = False) -> list[str]:
    lines = [f"- config_name: {name}", "  data_files:"]
    for split in splits:
        files = "*.parquet" if splits == [_UNDIVIDED] else f"{split}-*.parquet"
        lines += [f"  - split: {split}", f"    path: {name}/{files}"]
    return [*lines, "  default: true"] if default else lines


EXPORTER = Exporter("huggingface", "Parquet with images, readings and poses that `datasets` loads, and rows", _files)
