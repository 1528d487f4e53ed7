"""One image file with moments of every run, evenly spread over its time, for a quick look."""

from collections.abc import Sequence

import numpy as np

from symolo.core.errors import InputError, nearest
from symolo.dataset.layout import DATA, IMAGES
from symolo.pages.sheet import Cell, Pixels, check_side, row, stacked, text_line
from symolo.playback.from_run import playback_of
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run
from symolo.reader.run_folder import Image
from symolo.report.statistics.run_facts import fresh
from symolo.report.statistics.spread import spread
from symolo.video.floor import FloorView


def contact_sheet(data: Dataset, per_run: int, width_px: int, camera: str = "") -> Pixels:
    """Return a sheet (H, W, 3) BGR: a row for each run, with `per_run` cells that are `width_px` wide.

    A cell shows an image of the camera of data.csv, or of a further one by its name; of a run without images, the floor
    with the robot.

    Raises:
        InputError: An image cannot be decoded, a run has no such camera, or the sheet is too large.
    """
    if camera:
        return _further_camera(data, per_run, width_px, camera)
    moments = [_moments(run, per_run) for run in data]
    check_side("wide", max(map(len, moments)) * width_px, "--per-run or --width-px")
    rows: list[Pixels] = []
    for run, chosen in zip(data, moments, strict=True):
        rows.append(row(_cells(fresh(run), chosen, width_px), width_px))
        if failure := data.failures.get(run.name):
            rows.append(text_line(f"{run.name} failed: {failure}", rows[-1].shape[1]))
        check_side("high", sum(row.shape[0] for row in rows), "--width-px, or name a single run")
    return stacked(rows)


def _further_camera(data: Dataset, per_run: int, width_px: int, name: str) -> Pixels:
    rows: list[Pixels] = []
    for run in data:
        camera = run.cameras.get(name)
        if camera is None:
            known = ", ".join(run.cameras)
            allowed = f"one of {known}" if known else "nothing: the run has no further camera"
            raise InputError("--camera", got=name, allowed=allowed, nearest=nearest(name, run.cameras))
        images = spread(camera.images, per_run)
        label = f"{run.name}, {name}"
        rows.append(
            row([_image(image, f"{label}, image {image.number}, {image.t_s:.1f} s") for image in images], width_px)
        )
    check_side("wide", max(one.shape[1] for one in rows), "--per-run or --width-px")
    check_side("high", sum(one.shape[0] for one in rows), "--width-px, or name a single run")
    return stacked(rows)


def _image(image: Image, label: str) -> Cell:
    return Cell(np.ascontiguousarray(image.pixels()[..., ::-1]), (label,))


def _moments(run: Run, count: int) -> list[int]:
    """Return rows of a run, evenly spread: those with an image, or any of a run without images."""
    table = fresh(run).table
    if (run.folder / IMAGES).is_dir() and not table.image.any():
        where = str(run.folder / DATA)
        raise InputError("img is 0 in every row, though there are images", where=where, cure="run `symolo verify`")
    with_image = np.flatnonzero(table.image)
    rows = with_image if len(with_image) else np.arange(len(table.image))
    at = np.unique(np.linspace(0, len(rows) - 1, min(count, len(rows))).round().astype(int))
    return rows[at].tolist()


def _cells(run: Run, rows: Sequence[int], width_px: int) -> list[Cell]:
    table = run.table
    if table.image.any():
        images = [run.image(int(table.image[row])) for row in rows]
        return [
            _image(image, _label(run, f"image {image.number}, {run.t_s[image.row]:.1f} s", image.row))
            for image in images
        ]
    floor = FloorView(playback_of(run), width_px, width_px)
    return [
        Cell(
            np.ascontiguousarray(floor.frame(at).pixels[..., ::-1]),
            (_label(run, f"{run.t_s[at]:.1f} s", at),),
        )
        for at in rows
    ]


def _label(run: Run, moment: str, at: int) -> str:
    """Return the text of a cell: run, moment, and the state if it is known."""
    return f"{run.name}, {moment}" + (f", state {run.table.state[at]}" if run.table.has_state else "")
