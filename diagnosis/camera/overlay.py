"""Plots of a camera identification: the line's edges on a frame, and the residuals of each aspect."""

import numpy as np
from matplotlib.figure import Figure

from diagnosis.camera.diagnose import CameraDiagnosis
from diagnosis.camera.features.levels import LevelModel
from diagnosis.camera.features.line_points import edge_candidates
from diagnosis.camera.views import CameraView, EdgePoints
from symolo.pages.plotting import BLUE, GREY, VERMILION, finished, png

FRAMES = 3
"""Largest number of images in the plot of the edges."""
MIN_EDGES = 5
"""Smallest number of edges in such an image."""
MEASURED = "#F0E442"
CHANNELS = {"red": "#CC3311", "green": "#228833", "blue": "#4477AA"}


def overlay(diagnosis: CameraDiagnosis) -> bytes:
    """Plot the held-out frames that differ most, with edges as measured, by the nominal and the extended camera."""
    case, model = diagnosis.case, diagnosis.edges
    x, null = diagnosis.geometry.fit.x, np.zeros(len(diagnosis.geometry.fit.x))
    width, height = case.size_px
    frames = _shown(diagnosis)
    figure = Figure(figsize=(4.2 * len(frames), 4.2 * height / width + 0.6), layout="constrained")
    for axes, frame in zip(figure.subplots(1, len(frames), squeeze=False)[0], frames, strict=True):
        axes.imshow(case.frames[frame].image, interpolation="nearest")
        middle, outwards, chain = edge_candidates(case.arena)
        for deviations, colour, style, name in ((null, VERMILION, "-", "nominal"), (x, BLUE, "--", "extended")):
            for number in np.unique(chain):
                here = chain == number
                points = EdgePoints(np.full(here.sum(), frame), middle[here], outwards[here])
                at = CameraView(case, deviations).pixels(points)
                inside = (at > -20).all(axis=1) & (at[:, 0] < width + 20) & (at[:, 1] < height + 20)
                at = np.where(inside[:, None], at, np.nan)
                label = name if number == chain[0] else None
                axes.plot(at[:, 0], at[:, 1], style, color=colour, linewidth=1.2, label=label)
        here = model.frame == frame
        axes.plot(
            *model.edges.pixels[here].T, "o", color=MEASURED, markersize=3, markeredgecolor="black", label="measured"
        )
        axes.set(xlim=(-0.5, width - 0.5), ylim=(height - 0.5, -0.5), xticks=[], yticks=[])
        axes.set_title(f"image {case.frames[frame].number}", fontsize="medium")
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, fontsize="small", frameon=False)
    return png(figure)


def _shown(diagnosis: CameraDiagnosis) -> list[int]:
    """Return up to three held-out frames, those with the largest errors of the nominal camera."""
    model = diagnosis.edges
    sizes = np.abs(model.residuals(np.zeros(len(diagnosis.geometry.fit.x))))
    frames = [
        f for f in np.unique(model.frame[model.heldout]).tolist() if np.count_nonzero(model.frame == f) >= MIN_EDGES
    ]
    frames.sort(key=lambda f: -float(np.nanmedian(sizes[model.frame == f])))
    return sorted(frames[:FRAMES]) or [int(model.frame[0])]


def edge_misfit(diagnosis: CameraDiagnosis) -> bytes:
    """Plot the distances of the edges along rows and columns, for the nominal and the extended camera."""
    model, x = diagnosis.edges, diagnosis.geometry.fit.x
    figure = Figure(figsize=(9.5, 3.4), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    before, after = model.residuals(np.zeros_like(x)), model.residuals(x)
    reach = float(np.nanpercentile(np.abs(before), 98)) * 1.2 + 0.3
    shown = model.heldout
    for axes, (name, at) in zip(panels, (("row [px]", 1), ("column [px]", 0)), strict=True):
        places_px = model.edges.pixels[shown, at]
        for misfit, colour, label in ((before, VERMILION, "nominal"), (after, BLUE, "extended")):
            axes.plot(places_px, misfit[shown], "o", markersize=2.5, alpha=0.6, color=colour, label=label)
        axes.axhline(0.0, color=GREY, linewidth=0.6)
        axes.set_ylim(-reach, reach)
        finished(axes, "edges in held-out images", name, "measured - predicted, outwards [px]", legend=at == 1)
    return png(figure)


def level_misfit(diagnosis: CameraDiagnosis) -> bytes | None:
    """Plot measured less predicted levels of each channel; None where no levels were compared."""
    levels = next((aspect for aspect in diagnosis.photometry if aspect.name == LevelModel.name), None)
    if levels is None:
        return None
    x, model, shown = levels.fit.x, levels.model, levels.model.heldout
    figure = Figure(figsize=(9.5, 3.4), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    channel = np.arange(len(shown)) % 3
    for axes, (name, deviations) in zip(panels, (("nominal", np.zeros_like(x)), ("extended", x)), strict=True):
        misfit = 255 * model.residuals(deviations)
        for k, (label, colour) in enumerate(CHANNELS.items()):
            here = shown & (channel == k)
            axes.plot(np.flatnonzero(here), misfit[here], ".", markersize=2.5, color=colour, label=label)
        axes.axhline(0.0, color=GREY, linewidth=0.6)
        finished(axes, name, "patch of a held-out image", "measured - predicted [of 255]", legend=name == "nominal")
    return png(figure)
