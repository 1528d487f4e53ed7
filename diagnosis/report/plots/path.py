"""Plot of the measured path of a drive, and of the paths of both robots driven by the voltages alone."""

from matplotlib.figure import Figure

from diagnosis.engine.drive import DrivenPath
from diagnosis.report.plots.panels import AFTER, BEFORE, MEASURED
from symolo.pages.plotting import finished, png


def path_plot(path: DrivenPath) -> bytes:
    """Return the paths on the floor, and the distances to the measured place against time, as PNG."""
    figure = Figure(figsize=(9.3, 4.2), layout="constrained")
    floor, against_time = figure.subplots(1, 2, width_ratios=(1.0, 1.0))
    simulated = (("nominal", BEFORE, path.nominal), ("extended", AFTER, path.extended))
    for name, colour, poses in (("measured", MEASURED, path.measured), *simulated):
        width = 2.6 if name == "measured" else 1.3
        floor.plot(poses[:, 0], poses[:, 1], color=colour, linewidth=width, label=name)
    floor.plot(*path.measured[:1, :2].T, "o", color=MEASURED, markersize=6)
    floor.set_aspect("equal", adjustable="datalim")
    finished(floor, "Path, starting at the dot", "x [m]", "y [m]", beside=False)
    for name, colour, poses in simulated:
        against_time.plot(path.t_s, 1e3 * path.off_m(poses), color=colour, label=name)
    against_time.set_ylim(bottom=0.0)
    finished(against_time, "Distance to the measured path", "time [s]", "distance [mm]", beside=False)
    return png(figure)
