"""The figure of `symolo baselines`."""

import pytest
from matplotlib.figure import Figure

from pipeline.baselines.figure import OTHER_STYLES, STYLES, PlainNumbers
from symolo.pages.plotting import BLACK


def test_every_method_is_told_apart_from_the_truth_and_from_the_others():
    """The truth is a black line, which dots and dashes in black hide in."""
    styles = [*STYLES.values(), *OTHER_STYLES]
    assert len(set(styles)) == len(styles)
    assert BLACK not in {colour for colour, _ in styles}


@pytest.mark.parametrize(
    ("low", "high", "labels"),
    [(0.35, 0.95, {"0.4", "0.6"}), (0.3, 900.0, {"1", "10", "100"})],
)
def test_logarithmic_axes_have_plain_numbers(low, high, labels):
    """Within a decade, values between the powers of ten are labelled, without a power."""
    axes = Figure().subplots()
    axes.set_yscale("log")
    axes.set_ylim(low, high)
    axes.yaxis.set_major_formatter(PlainNumbers())
    axes.yaxis.set_minor_formatter(PlainNumbers())
    axes.figure.draw_without_rendering()
    drawn = {label.get_text() for label in axes.get_yticklabels(which="both")}
    assert labels <= drawn
    assert not any("10^" in label or "e" in label for label in drawn)
