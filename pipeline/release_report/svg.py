"""Figures of Matplotlib as SVG: sharp in print, small, and the same bytes for the same figure."""

import io

from matplotlib import rc_context
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from diagnosis.benches.plotting import RESOLUTION_DPI

_NOT_TOLD = {"Date": None, "Creator": None}


def svg(figure: Figure) -> bytes:
    """The figure as SVG; what is rasterised in it has `RESOLUTION_DPI`."""
    # Letters as shapes are as wide as they were measured, whatever fonts the reader has; without a salt the names of
    # clip paths are drawn at random.
    with rc_context({"svg.fonttype": "path", "svg.hashsalt": "symolo", "path.simplify_threshold": 0.2}):
        FigureCanvasSVG(figure)
        buffer = io.BytesIO()
        figure.savefig(buffer, format="svg", dpi=RESOLUTION_DPI, metadata=_NOT_TOLD)
        return buffer.getvalue()
