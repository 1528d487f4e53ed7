"""One image file with images of every run, evenly spread over its time, for a quick look."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from symolo.core.errors import InputError
from symolo.core.files.plain_files import FileKind, check_folders, read_file
from symolo.dataset.layout import STAGES, frame_name
from symolo.dataset.pixels import decoded_bytes
from symolo.dataset.tables.rows import Rows, read_rows
from symolo.pages.sheet import Cell, Pixels, check_side, row, stacked


@dataclass(frozen=True)
class SheetImage:
    """One image of the sheet."""

    path: Path
    label: str
    """Text below the image."""


def contact_sheet(root: Path, per_run: int, width_px: int) -> Pixels:
    """Return a sheet (H, W, 3) BGR: a row for each run below `root`, with `per_run` images that are `width_px` wide.

    Raises:
        InputError: There is no run with images below `root`, an image cannot be decoded, or the sheet is too large.
    """
    folders = sorted(
        path.parent
        for path in root.rglob("data.csv")
        if STAGES not in path.relative_to(root).parts and (path.parent / "images").is_dir()
    )
    if not folders:
        raise InputError(
            "holds no data.csv with images beside it", where=str(root), cure="name a dataset or a run folder"
        )
    for folder in folders:
        check_folders(root, folder.relative_to(root).as_posix())
    images_by_run = [_spread(folder, root, per_run) for folder in folders]
    check_side("wide", max(map(len, images_by_run)) * width_px, "--per-run or --width-px")
    rows: list[Pixels] = []
    for images in images_by_run:
        rows.append(_row(images, width_px))
        check_side("high", sum(row.shape[0] for row in rows), "--width-px, or name a single run")
    return stacked(rows)


def _spread(folder: Path, root: Path, count: int) -> list[SheetImage]:
    rows: Rows = read_rows(folder / "data.csv")
    at = np.flatnonzero(rows.image)
    if not len(at):
        raise InputError(
            "img is 0 in every row, though there are images", where=str(folder / "data.csv"), cure="run `symolo verify`"
        )
    chosen = at[np.unique(np.linspace(0, len(at) - 1, min(count, len(at))).round().astype(int))]
    run = folder.relative_to(root).as_posix()
    return [
        SheetImage(folder / "images" / frame_name(number), f"{run} {number} s{state}")
        for number, state in zip(rows.image[chosen].tolist(), rows.state[chosen].tolist(), strict=True)
    ]


def _row(images: Sequence[SheetImage], width_px: int) -> Pixels:
    cells = []
    for image in images:
        data = read_file(image.path, FileKind.IMAGE) if image.path.is_file() else b""
        pixels = decoded_bytes(data, in_colour=True)
        if pixels is None:
            raise InputError("is missing or cannot be decoded", where=str(image.path), cure="run `symolo verify`")
        cells.append(Cell(np.asarray(pixels, np.uint8), (image.label,)))
    return row(cells, width_px)
