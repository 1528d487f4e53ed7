"""Plot of the readings of one sensor of `robot.sensors` against time."""

import numpy as np
from matplotlib.figure import Figure

from symolo.dataset.tables.side_tables import SideTable
from symolo.pages.plotting import BLACK, svg
from symolo.reader.run import Run
from symolo.report.statistics.run_facts import fresh

_WIDTH_IN, _PANEL_IN = 7.0, 1.1


def sensor_plot(run: Run, table: SideTable) -> bytes:
    """Return the plot as SVG, with a panel for each column; numbered columns are rows of an image.

    Raises:
        InputError: The table is missing or damaged.
    """
    sensor = fresh(run).sensors[table.name]
    columns = table.columns[1:]
    figure = Figure(figsize=(_WIDTH_IN, _PANEL_IN * len(columns) + 0.6), layout="constrained")
    panels = figure.subplots(len(columns), 1, sharex=True, squeeze=False)[:, 0]
    for axes, column in zip(panels, columns, strict=True):
        values = sensor.values(column.name)
        if column.count > 1:
            # Each sample is shown until the next one, as in the panels below.
            ends_s = np.append(sensor.t_s, 2.0 * sensor.t_s[-1] - sensor.t_s[-2] if len(sensor.t_s) > 1 else 1.0)
            axes.pcolormesh(ends_s, np.arange(column.count + 1) - 0.5, values.T, cmap="viridis", rasterized=True)
        else:
            axes.step(sensor.t_s, values, where="post", color=BLACK, linewidth=0.9)
            axes.grid(alpha=0.3)
        axes.set_ylabel(column.name if column.unit == "-" else f"{column.name}\n[{column.unit}]")
    panels[-1].set_xlabel("time since the start of the run [s]")
    figure.align_ylabels(panels.tolist())
    return svg(figure)
