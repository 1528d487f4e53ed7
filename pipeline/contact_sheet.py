"""One picture with images of every run, spread evenly over its time, to be looked at by a person."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from blender_scenes.frame_files import frame_name
from configs.errors import InputError
from pipeline.dataset.rows import Rows, read_rows
from pipeline.files import write_file
from pipeline.workspace import STAGES

Pixels = NDArray[np.uint8]

LABEL_PX = 18
LONGEST_SIDE_PX = 65_500
"""JPEG_MAX_DIMENSION of libjpeg's jmorecfg.h; OpenCV would print a line of its own."""
LABEL_FITS_PX = 140
"""Width that a label such as `CCW/test_10 123 s33` takes at full size."""
FONT = cv2.FONT_HERSHEY_SIMPLEX


@dataclass(frozen=True)
class Shown:
    """One image of the sheet."""

    path: Path
    label: str


def contact_sheet(root: Path, per_run: int, width_px: int) -> Pixels:
    """A row for each run below `root`, `per_run` images in it, each `width_px` wide, (H, W, 3) BGR.

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
    shown = [_spread(folder, root, per_run) for folder in folders]
    _check_side("wide", max(map(len, shown)) * width_px, "--per-run or --width-px")
    rows: list[Pixels] = []
    for images in shown:
        rows.append(_row(images, width_px))
        _check_side("high", sum(row.shape[0] for row in rows), "--width-px, or name a single run")
    widest = max(row.shape[1] for row in rows)
    padded = [np.pad(row, ((0, 0), (0, widest - row.shape[1]), (0, 0))) for row in rows]
    return np.concatenate(padded)


def _check_side(which: str, length_px: int, smaller: str) -> None:
    if length_px > LONGEST_SIDE_PX:
        raise InputError(
            f"the sheet would be too {which}",
            got=f"{length_px} px",
            allowed=f"up to {LONGEST_SIDE_PX} px",
            cure=f"choose a smaller {smaller}",
        )


def save(sheet: Pixels, path: Path) -> None:
    """Write the sheet as the format that the file's name asks for, JPEG or PNG."""
    encoded, data = cv2.imencode(path.suffix, sheet)
    if not encoded:
        raise InputError("cannot be encoded", where=str(path))
    write_file(path, data.tobytes())


def _spread(folder: Path, root: Path, count: int) -> list[Shown]:
    rows: Rows = read_rows(folder / "data.csv")
    at = np.flatnonzero(rows.image)
    if not len(at):
        raise InputError(
            "img is 0 in every row, though there are images", where=str(folder / "data.csv"), cure="run `symolo verify`"
        )
    chosen = at[np.unique(np.linspace(0, len(at) - 1, min(count, len(at))).round().astype(int))]
    run = folder.relative_to(root).as_posix()
    return [
        Shown(folder / "images" / frame_name(number), f"{run} {number} s{state}")
        for number, state in zip(rows.image[chosen].tolist(), rows.state[chosen].tolist(), strict=True)
    ]


def _row(images: Sequence[Shown], width_px: int) -> Pixels:
    cells = []
    for shown in images:
        data = shown.path.read_bytes() if shown.path.is_file() else b""
        picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR) if data else None
        if picture is None:
            raise InputError("is missing or cannot be decoded", where=str(shown.path), cure="run `symolo verify`")
        height_px = round(picture.shape[0] * width_px / picture.shape[1])
        method = cv2.INTER_AREA if width_px < picture.shape[1] else cv2.INTER_NEAREST
        small = cv2.resize(picture, (width_px, height_px), interpolation=method)
        label = np.zeros((LABEL_PX, width_px, 3), np.uint8)
        scale = min(0.4, 0.4 * width_px / LABEL_FITS_PX)
        cv2.putText(label, shown.label, (3, LABEL_PX - 5), FONT, scale, (255, 255, 255), 1, cv2.LINE_AA)
        cells.append(np.concatenate((label, small)))
    return np.concatenate(cells, axis=1)
