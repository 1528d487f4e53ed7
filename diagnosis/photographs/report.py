"""The report of a look that was fitted to photographs: the photographs beside images of the look, and the figures."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields

import cv2
import numpy as np

from diagnosis.photographs.camera_fit import model_image
from diagnosis.photographs.fitted_look import FittedLook
from diagnosis.photographs.image_figures import ImageFigures, medians
from diagnosis.photographs.line_place import BgrImage
from diagnosis.photographs.measures import PhotographMeasures, median_of
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
CAMERA_FIGURES = ("edge_px", "noise", "contrast", "jaggedness_px")
"""Figures that an image without texture has."""
_COLUMNS = 4
_CELL_PX = 320
_MARK_EVERY_PX = 4
_MARK_BGR = (0, 0, 255)


@dataclass(frozen=True)
class FigureRow:
    """A figure over the photographs, and the same of the look."""

    name: str
    photographs: tuple[float, float, float]
    """Median, smallest and largest value."""
    look: tuple[float, ...]
    """Median, smallest and largest value of rendered images, or the value of the model image, or nothing."""

    @property
    def cells(self) -> tuple[str, ...]:
        """Name, value of the photographs, value of the look, and the ratio of the two."""
        ratio = f"{self.look[0] / self.photographs[0]:.2f}" if self.look and self.photographs[0] else "-"
        return TITLES[self.name], _with_range(self.photographs), _with_range(self.look), ratio


def figure_rows(look: FittedLook) -> tuple[FigureRow, ...]:
    """Return a row for each figure of photographs."""
    table = medians([photograph.figures for photograph in look.photographs])
    if look.rendered:
        look_figures: dict[str, tuple[float, ...]] = {**medians([image.figures for image in look.rendered])}
    else:
        _, model_figures = _image_of_model(look)
        look_figures = {name: (getattr(model_figures, name),) for name in CAMERA_FIGURES}
    return tuple(FigureRow(f.name, table[f.name], look_figures.get(f.name, ())) for f in fields(ImageFigures))


def _with_range(values: Sequence[float]) -> str:
    """Return `median (smallest to largest)`, or the only value, or a dash."""
    numbers = [f"{value:.3g}" for value in values]
    return f"{numbers[0]} ({numbers[1]} to {numbers[2]})" if len(numbers) == 3 else (*numbers, "-")[0]


def table_lines(look: FittedLook) -> Iterator[str]:
    """Yield the table for a terminal."""
    head, rows = ("figure", "photographs, median (range)", _column(look), "ratio"), figure_rows(look)
    widths = [max(len(row[k]) for row in (head, *(row.cells for row in rows))) + 2 for k in range(4)]
    for row in (head, *(row.cells for row in rows)):
        yield "".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip()


def report_page(look: FittedLook, notes: Sequence[str]) -> str:
    """Return one page that needs no file beside itself."""
    images = [(image.name, _shown(image)) for image in look.rendered] or [(_column(look), _image_of_model(look)[0])]
    return render_page(
        "diagnosis.photographs",
        title=f"{look.name}: look of photographs",
        look=look,
        notes=notes,
        photographs=_sheet([(photograph.name, _marked(photograph)) for photograph in look.photographs]),
        images=_sheet(images),
        column=_column(look),
        figures=[row.cells for row in figure_rows(look)],
        settings=[(".".join(s.path), s.text, s.source) for s in look.settings if s.source],
    )


def _image_of_model(look: FittedLook) -> tuple[BgrImage, ImageFigures]:
    """Return the image of the camera model, and its figures."""
    shape = look.photographs[0].place.shape
    place = model_image(look.camera, shape, median_of(look.photographs, lambda p: p.place.width_px))
    return place.image, ImageFigures.from_image(place.image, place.x_px, place.rows_px, is_dark=place.is_dark)


def _column(look: FittedLook) -> str:
    """Return the name of what is compared with the photographs."""
    return "rendered images, median (range)" if look.rendered else "model image"


def _shown(measured: PhotographMeasures) -> BgrImage:
    """Return the image as it was before it was turned."""
    image = measured.place.image
    return np.ascontiguousarray(image.transpose(1, 0, 2)) if measured.place.is_turned else image


def _marked(measured: PhotographMeasures) -> BgrImage:
    """Return the image with dots along both edges of the line, over the rows in which it was measured."""
    image, place = _shown(measured).copy(), measured.place
    rows = np.arange(round(place.rows_px[0]), round(place.rows_px[-1]), _MARK_EVERY_PX)
    for edge in place.edges_px(rows.astype(float)):
        columns = np.clip(edge.round().astype(int), 0, place.shape[1] - 1)
        image[(columns, rows) if place.is_turned else (rows, columns)] = _MARK_BGR
    return image


def _sheet(images: Sequence[tuple[str, BgrImage]]) -> bytes:
    """Return a PNG file with enlarged images and their names."""
    cells = []
    for name, image in images:
        scale = max(1, round(_CELL_PX / image.shape[1]))
        enlarged = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_CUBIC)
        cells.append(Cell(np.asarray(enlarged, np.uint8), (name,)))
    return cv2.imencode(".png", in_columns(cells, _COLUMNS))[1].tobytes()
