"""The measured path of a drive, and those to which its voltages alone take the nominal and the extended robot."""

from matplotlib.figure import Figure

from diagnosis.engine.drive import DrivenPath
from diagnosis.report.plots.panels import AFTER, BEFORE, MEASURED
from symolo.pages.plotting import finished, png


def path_picture(path: DrivenPath) -> bytes:
    """As PNG: the floor, and the distance to the measured place against time."""
    figure = Figure(figsize=(9.3, 4.2), layout="constrained")
    floor, against_time = figure.subplots(1, 2, width_ratios=(1.0, 1.0))
    of = (("measured", MEASURED, path.measured, 2.6), ("nominal", BEFORE, path.nominal, 1.3))
    for name, colour, poses, width in (*of, ("extended", AFTER, path.extended, 1.3)):
        floor.plot(poses[:, 0], poses[:, 1], color=colour, linewidth=width, label=name)
    floor.plot(*path.measured[:1, :2].T, "o", color=MEASURED, markersize=6)
    floor.set_aspect("equal", adjustable="datalim")
    finished(floor, "Path, from the dot on", "x [m]", "y [m]", beside=False)
    for name, colour, poses in (("nominal", BEFORE, path.nominal), ("extended", AFTER, path.extended)):
        against_time.plot(path.t_s, 1e3 * path.off_m(poses), color=colour, label=name)
    against_time.set_ylim(bottom=0.0)
    finished(against_time, "Off the measured place", "time [s]", "distance [mm]", beside=False)
    return png(figure)
