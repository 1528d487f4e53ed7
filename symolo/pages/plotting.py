"""Common part of all plots: colours that colour-blind readers can distinguish, and the encoding as PNG and SVG.

Figures are made without pyplot, which has a global state and needs a display.
"""

import io
from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.typing import LegendLocType

# Okabe and Ito, "Color Universal Design" (2008). In a grey print, dashes and markers distinguish the lines.
BLACK = "#000000"
ORANGE = "#E69F00"
SKY = "#56B4E9"
GREEN = "#009E73"
BLUE = "#0072B2"
VERMILION = "#D55E00"
PURPLE = "#CC79A7"
GREY = "#777777"
PALE = "#DDDDDD"
COLOURS = (BLACK, ORANGE, SKY, GREEN, BLUE, VERMILION, PURPLE)

RESOLUTION_DPI = 130


def png(figure: "Figure") -> bytes:
    """Return the figure as PNG; the same figure gives the same bytes."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415 - commands that only name a colour

    figure.set_dpi(RESOLUTION_DPI)
    buffer = io.BytesIO()
    # `savefig` would draw the figure twice, the first time only for its layout.
    FigureCanvasAgg(figure).print_png(buffer)
    return buffer.getvalue()


def svg(figure: "Figure") -> bytes:
    """Return the figure as SVG; the same figure gives the same bytes. Rasterised parts have `RESOLUTION_DPI`."""
    from matplotlib import rc_context  # noqa: PLC0415 - as above
    from matplotlib.backends.backend_svg import FigureCanvasSVG  # noqa: PLC0415 - as above

    # Letters as shapes do not depend on the reader's fonts. Without a salt, the names of clip paths would be random.
    with rc_context({"svg.fonttype": "path", "svg.hashsalt": "symolo", "path.simplify_threshold": 0.2}):
        FigureCanvasSVG(figure)
        buffer = io.BytesIO()
        figure.savefig(buffer, format="svg", dpi=RESOLUTION_DPI, metadata={"Date": None, "Creator": None})
        return buffer.getvalue()


def set_margins(
    figure: "Figure", columns: int, *, left_in: float, bottom_in: float, top_in: float, between_in: float = 0.0
) -> None:
    """Place a row of panels. Matplotlib's layout engine does it alone, but takes half as long as all the drawing.

    Args:
        figure: The figure, in the size in which it is drawn.
        columns: Number of panels.
        left_in: Margin [in] for the labels of the first panel.
        bottom_in: Margin [in] for the labels below.
        top_in: Margin [in] for the titles.
        between_in: Distance [in] of two panels, for the labels of the second one.
    """
    (width_in, height_in), right_in = figure.get_size_inches(), 0.2
    panel_in = (width_in - left_in - right_in - (columns - 1) * between_in) / columns
    figure.subplots_adjust(
        left=left_in / width_in,
        right=1.0 - right_in / width_in,
        bottom=bottom_in / height_in,
        top=1.0 - top_in / height_in,
        wspace=between_in / panel_in,
    )


def width_of_labels_in(labels: Iterable[str]) -> float:
    """Return about the width [in] of small labels beside an axis, with their distance to it; at most 4 inches."""
    return min(0.2 + 0.075 * max(map(len, labels), default=0), 4.0)


def finished(
    axes: "Axes",
    title: str,
    x: str,
    y: str,
    *,
    legend: bool = True,
    beside: bool = False,
    loc: "LegendLocType" = "best",
    ncols: int = 1,
) -> None:
    """Set title, axis labels with units, a faint grid, and a legend inside the panel or, if `beside`, above it."""
    # With a height, Matplotlib need not look for ticks above the panel, which takes long.
    axes.set_title(title, fontsize="medium", pad=22 if beside else None, y=1.0)
    axes.set(xlabel=x, ylabel=y)
    axes.grid(alpha=0.3)
    axes.set_axisbelow(True)
    if not legend:
        return
    if beside:
        place = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0)}
        axes.legend(fontsize="x-small", ncols=9, frameon=False, columnspacing=1.0, handletextpad=0.4, **place)
    else:
        axes.legend(fontsize="small", loc=loc, ncols=ncols)
