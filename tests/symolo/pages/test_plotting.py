"""Figures as bytes: what is drawn once is what Matplotlib draws when it saves a figure."""

import io

import numpy as np
import pytest
from matplotlib.figure import Figure

from symolo.pages.plotting import RESOLUTION_DPI, finished, png, set_margins, width_of_labels_in


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


@pytest.mark.parametrize("name", ["v", "wheel_right_rad_s", "pose_dtheta_rad, held out"])
def test_margins_leave_room_for_the_labels_and_no_more(name):
    left_in = width_of_labels_in(["u", name])
    figure = Figure(figsize=(left_in + 4.0, 2.0))
    set_margins(figure, 2, left_in=left_in, bottom_in=0.5, top_in=0.3, between_in=0.3)
    panels = figure.subplots(1, 2, sharey=True)
    panels[0].set_yticks([0.0, 1.0], ["u", name], fontsize="small")
    for axes in panels:
        finished(axes, "title", "number [1]", "", legend=False)
    png(figure)
    drawn_inch = [axes.get_tightbbox().transformed(figure.dpi_scale_trans.inverted()) for axes in panels]
    assert 0.0 < drawn_inch[0].x0 < 0.25 * left_in + 0.1
    assert all(box.y0 > 0.0 and box.y1 < 2.0 and box.x1 <= left_in + 4.0 for box in drawn_inch)
    first, second = (axes.get_window_extent().transformed(figure.dpi_scale_trans.inverted()) for axes in panels)
    assert second.x0 - first.x1 == pytest.approx(0.3)
    assert first.width == pytest.approx(second.width)
