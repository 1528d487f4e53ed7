"""Plot of the readings of one sensor of `robot.sensors` against time."""

from matplotlib.figure import Figure

from symolo.dataset.tables.side_tables import SideTable
from symolo.pages.plotting import BLACK, svg
from symolo.reader.run import Run
from symolo.report.statistics.run_facts import fresh

_WIDTH_IN, _PANEL_IN = 11.0, 1.1


def sensor_plot(run: Run, table: SideTable) -> bytes:
    """Return the plot as SVG, with a panel for each column.

    Raises:
        InputError: The table is missing or damaged.
    """
    values = fresh(run).side(table.name)
    columns = table.columns[1:]
    figure = Figure(figsize=(_WIDTH_IN, _PANEL_IN * len(columns) + 0.6), layout="constrained")
    panels = figure.subplots(len(columns), 1, sharex=True, squeeze=False)[:, 0]
    for axes, column in zip(panels, columns, strict=True):
        # A reading stays what it is until the next row.
        axes.step(values[table.columns[0].name] / 1000, values[column.name], where="post", color=BLACK, linewidth=0.9)
        axes.set_ylabel(column.name if column.unit == "-" else f"{column.name} [{column.unit}]")
        axes.grid(alpha=0.3)
    panels[-1].set_xlabel("time since the start of the run [s]")
    figure.align_ylabels(panels.tolist())
    return svg(figure)
