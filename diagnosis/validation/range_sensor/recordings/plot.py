"""The picture of the real scans and records beside the model."""

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from diagnosis.validation.range_sensor.recordings.after_move import AfterMove
from diagnosis.validation.range_sensor.recordings.comparison import MeasuredComparison
from diagnosis.validation.range_sensor.recordings.edge import EdgeComparison
from diagnosis.validation.range_sensor.recordings.static import StaticComparison
from symolo.pages.plotting import BLACK, BLUE, GREY, PALE, VERMILION, finished, png

ACROSS = 3
LONGEST_NAME = 60


def measured_picture(found: MeasuredComparison) -> bytes:
    """PNG, one panel for each thing that a file shows."""
    panels: list[Callable[[Axes], None]] = []
    for scan in found.scans:
        if scan.edge is not None:
            panels.append(lambda axes, name=scan.file, edge=scan.edge: _edge(axes, name, edge))
        if scan.after_move is not None:
            panels.append(lambda axes, name=scan.file, moved=scan.after_move: _after_move(axes, name, moved))
    panels += [lambda axes, record=record: _allan(axes, record) for record in found.static]
    rows = max(1, -(-len(panels) // ACROSS))
    across = min(ACROSS, max(1, len(panels)))
    figure = Figure(figsize=(5.8 * across, 5.4 * rows), layout="constrained")
    for place, draw in enumerate(panels, start=1):
        draw(figure.add_subplot(rows, across, place))
    return png(figure)


def _title(what: str, file: str) -> str:
    """A file's name may be long and is shown as it is: a dollar sign would begin a formula."""
    shown = file if len(file) <= LONGEST_NAME else file[: LONGEST_NAME - 3] + "..."
    return f"{what}\n{shown}".replace("$", r"\$")


def _edge(axes: Axes, name: str, edge: EdgeComparison) -> None:
    real, model, falling = edge.measured, edge.model, edge.falling
    axes.plot(real.radius_mm, real.reading_mm, "o", color=BLACK, markersize=5, label="measured")
    axes.plot(model.radius_mm, model.reading_mm, color=VERMILION, linewidth=2, label="model")
    label = "model, were light to fall as 1/d²"
    axes.plot(falling.radius_mm, falling.reading_mm, "--", color=BLUE, linewidth=2, label=label)
    axes.axvline(edge.falling_fit.radius_mm, color=GREY, linestyle=":", linewidth=2, label="edge of the ball, fitted")
    axes.set_ylim(0.0, 1.45 * edge.board_mm)
    title = _title("Mixed ranges at the edge of a ball", name)
    finished(axes, title, "distance from the ball's centre, across [mm]", "median reading [mm]", loc="upper left")


def _after_move(axes: Axes, name: str, moved: AfterMove) -> None:
    number = np.arange(1, len(moved.share_of_way) + 1)
    axes.bar(number, moved.share_of_way, 0.6, color=PALE, edgecolor=BLACK, label="measured")
    axes.plot(
        number, moved.model_at_device_period, "x-", color=BLUE, markersize=9, markeredgewidth=2, label="model, 0.2 s"
    )
    axes.plot(
        number, moved.model, "+--", color=VERMILION, markersize=10, markeredgewidth=2, label="model as configured"
    )
    axes.set_ylim(-0.05, 1.5)
    axes.set_xticks(number)
    title, y = _title(f"After a move ({moved.moves} moves)", name), "share of the way from the old to the new range"
    finished(axes, title, "number of the reading at the new place", y, loc="upper left")


def _allan(axes: Axes, record: StaticComparison) -> None:
    real, model = record.measured, record.model
    axes.loglog(real.averaged_s, real.deviation_mm, "o-", color=BLACK, markersize=4, label="measured")
    axes.loglog(model.averaged_s, model.deviation_mm, "x--", color=VERMILION, label="model, white board")
    averaged = np.array(real.averaged_s)
    white = record.white_sd_mm / np.sqrt(averaged * record.rate_hz)
    axes.loglog(averaged, white, ":", color=BLUE, linewidth=2, label="white noise of the measured size")
    title = _title(f"Standing still at {record.mean_mm:.0f} mm", record.file)
    finished(axes, title, "averaged over [s]", "Allan deviation [mm]", loc="lower left")
