"""Figures as bytes: what is drawn once is what Matplotlib draws when it saves a figure."""

import io

import numpy as np
import pytest
from matplotlib.figure import Figure

from symolo.pages.plotting import RESOLUTION_DPI, finished, png


def drawn(layout):
    figure = Figure(figsize=(5.0, 3.0), layout=layout)
    for axes in figure.subplots(1, 2):
        points = axes.scatter(np.arange(20.0), np.arange(20.0) ** 2, c=np.arange(20.0), label="squares")
        finished(axes, "squares of\nwhole numbers", "number [1]", "square [1]", beside=layout is None)
    figure.colorbar(points, ax=axes, label="number [1]")
    return figure


@pytest.mark.parametrize("layout", [None, "constrained"])
def test_a_png_is_the_one_that_matplotlib_saves(layout):
    saved = io.BytesIO()
    drawn(layout).savefig(saved, format="png", dpi=RESOLUTION_DPI)
    assert png(drawn(layout)) == saved.getvalue()


def test_a_title_is_where_matplotlib_puts_it_by_itself():
    figure, by_itself = drawn(None), drawn(None)
    for axes in by_itself.axes[:2]:
        axes.set_title(axes.get_title(), fontsize="medium", pad=22)
    assert png(figure) == png(by_itself)
