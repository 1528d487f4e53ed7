"""The report of a look that was fitted to photographs: the photographs beside images of the look, and the figures."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields

import cv2
import numpy as np

from diagnosis.photographs.camera_fit import model_image
from diagnosis.photographs.fitted_look import FittedLook
from diagnosis.photographs.image_figures import ImageFigures, medians
from diagnosis.photographs.line_place import BgrImage
from diagnosis.photographs.measures import median_of
from symolo.pages.html import render_page
from symolo.pages.sheet import Cell, in_columns

TITLES = {
    "edge_px": "edge of the line, 10 to 90 % [px]",
    "noise": "noise, Immerkaer's estimate [grey values]",
    "mottling_percent": "mottling of the floor, coarser than 3 px [% of its mean]",
    "line_spread": "spread of grey values on the line",
    "contrast": "(floor - line) / (floor + line)",
    "saturation_percent": "saturation [%]",
    "black": "grey value below which 1 % of the pixels are",
    "white": "grey value above which 1 % of the pixels are",
    "spectrum_slope": "slope of the spectrum",
    "high_frequency_percent": "share of the power above 0.25 cycles a pixel [%]",
    "jaggedness_px": "jaggedness of the line's edge [px]",
}
"""Name of each figure for people."""
OF_THE_CAMERA = ("edge_px", "noise", "contrast", "jaggedness_px")
"""Figures that an image without texture has."""
_COLUMNS = 4
_CELL_PX = 320


@dataclass(frozen=True)
class FigureRow:
    """A figure over the photographs, and the same of the model image."""

    name: str
    median: float
    low: float
    high: float
    of_model: float

    @property
    def cells(self) -> tuple[str, ...]:
        """Name, median with smallest and largest value, and the value of the model image."""
        of_model = f"{self.of_model:.3g}" if self.name in OF_THE_CAMERA else "-"
        return TITLES[self.name], f"{self.median:.3g} ({self.low:.3g} to {self.high:.3g})", of_model


def figure_rows(look: FittedLook) -> tuple[FigureRow, ...]:
    """Return a row for each figure of photographs."""
    table = medians([photograph.figures for photograph in look.photographs])
    _, of_model = _of_model(look)
    return tuple(FigureRow(f.name, *table[f.name], getattr(of_model, f.name)) for f in fields(ImageFigures))


def table_lines(rows: Sequence[FigureRow]) -> Iterator[str]:
    """Yield the table for a terminal."""
    head = ("figure", "photographs, median (range)", "model image")
    widths = [max(len(row[k]) for row in (head, *(row.cells for row in rows))) + 2 for k in range(3)]
    for row in (head, *(row.cells for row in rows)):
        yield "".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip()


def report_page(look: FittedLook, notes: Sequence[str]) -> str:
    """Return one page that needs no file beside itself."""
    model, _ = _of_model(look)
    return render_page(
        "diagnosis.photographs",
        title=f"{look.name}: look of photographs",
        look=look,
        notes=notes,
        photographs=_sheet([(p.name, _upright(p.place.image, is_turned=p.place.is_turned)) for p in look.photographs]),
        model=_sheet([("model image", model)]),
        figures=[row.cells for row in figure_rows(look)],
        settings=[(".".join(s.path), str(s.value), s.source) for s in look.settings if s.source],
    )


def _of_model(look: FittedLook) -> tuple[BgrImage, ImageFigures]:
    """Return the image of the camera model, and its figures."""
    shape = look.photographs[0].place.shape
    place = model_image(look.camera, shape, median_of(look.photographs, lambda p: p.place.width_px))
    return place.image, ImageFigures.of(place.image, place.x_px, place.rows_px, is_dark=place.is_dark)


def _upright(image: BgrImage, *, is_turned: bool) -> BgrImage:
    return np.ascontiguousarray(image.transpose(1, 0, 2)) if is_turned else image


def _sheet(images: Sequence[tuple[str, BgrImage]]) -> bytes:
    """Return a PNG file with enlarged images and their names."""
    cells = []
    for name, image in images:
        scale = max(1, round(_CELL_PX / image.shape[1]))
        enlarged = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_CUBIC)
        cells.append(Cell(np.asarray(enlarged, np.uint8), (name,)))
    return cv2.imencode(".png", in_columns(cells, _COLUMNS))[1].tobytes()
