"""Pictures of a diagnosis: the line's edges on a frame, and what each part leaves."""

import numpy as np
from matplotlib.figure import Figure

from diagnosis.camera.diagnose import PictureDiagnosis
from diagnosis.camera.features.line_points import edge_candidates
from diagnosis.camera.views import EdgePoints, View
from symolo.core.arrays import Array
from symolo.pages.plotting import BLUE, GREY, VERMILION, finished, png

FRAMES = 3
MEASURED = "#F0E442"


def overlay(diagnosis: PictureDiagnosis) -> bytes:
    """Held-out frames that differ most, with edges as measured, by the nominal camera, and by the extended one."""
    case, model = diagnosis.case, diagnosis.edges
    x, null = diagnosis.geometry.fit.x, np.zeros(len(diagnosis.geometry.fit.x))
    width, height = case.size_px
    frames = _shown(diagnosis)
    figure = Figure(figsize=(4.2 * len(frames), 4.2 * height / width + 0.6), layout="constrained")
    for axes, frame in zip(figure.subplots(1, len(frames), squeeze=False)[0], frames, strict=True):
        axes.imshow(case.frames[frame].picture, interpolation="nearest")
        middle, outwards, chain = edge_candidates(case.arena)
        for deviations, colour, style, name in ((null, VERMILION, "-", "nominal"), (x, BLUE, "--", "extended")):
            for number in np.unique(chain):
                here = chain == number
                points = EdgePoints(np.full(here.sum(), frame), middle[here], outwards[here])
                at = View(case, deviations).pixels(points)
                inside = (at > -20).all(axis=1) & (at[:, 0] < width + 20) & (at[:, 1] < height + 20)
                at = np.where(inside[:, None], at, np.nan)
                label = name if number == chain[0] else None
                axes.plot(at[:, 0], at[:, 1], style, color=colour, linewidth=1.2, label=label)
        here = model.frame == frame
        axes.plot(*model.measured[here].T, "o", color=MEASURED, markersize=3, markeredgecolor="black", label="measured")
        axes.set(xlim=(-0.5, width - 0.5), ylim=(height - 0.5, -0.5), xticks=[], yticks=[])
        axes.set_title(f"image {case.frames[frame].number}", fontsize="medium")
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, fontsize="small", frameon=False)
    return png(figure)


def _shown(diagnosis: PictureDiagnosis) -> list[int]:
    """Up to three frames held out, those in which the nominal camera errs most."""
    model = diagnosis.edges
    left = np.abs(model.left(np.zeros(len(diagnosis.geometry.fit.x))))
    seen = [f for f in np.unique(model.frame[model.heldout]).tolist() if np.count_nonzero(model.frame == f) >= 5]
    seen.sort(key=lambda f: -float(np.nanmedian(left[model.frame == f])))
    return sorted(seen[:FRAMES]) or [int(model.frame[0])]


def edge_misfit(diagnosis: PictureDiagnosis) -> bytes:
    """Distances of the edges along rows and columns, nominal and extended."""
    model, x = diagnosis.edges, diagnosis.geometry.fit.x
    figure = Figure(figsize=(9.5, 3.4), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    before, after = model.left(np.zeros_like(x)), model.left(x)
    reach = float(np.nanpercentile(np.abs(before), 98)) * 1.2 + 0.3
    for axes, (name, at) in zip(panels, (("row [px]", 1), ("column [px]", 0)), strict=True):
        for left, colour, label in ((before, VERMILION, "nominal"), (after, BLUE, "extended")):
            shown = model.heldout
            axes.plot(model.measured[shown, at], left[shown], "o", markersize=2.5, alpha=0.6, color=colour, label=label)
        axes.axhline(0.0, color=GREY, linewidth=0.6)
        axes.set_ylim(-reach, reach)
        finished(axes, "edges in pictures held out", name, "measured - predicted, outwards [px]", legend=at == 1)
    return png(figure)


def level_misfit(diagnosis: PictureDiagnosis) -> bytes | None:
    """Measured levels against those predicted, of each channel; None where none were compared."""
    part = next((part for part in diagnosis.photometry if part.name == "levels"), None)
    if part is None:
        return None
    x, model, shown = part.fit.x, part.model, part.heldout
    figure = Figure(figsize=(9.5, 3.4), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    channel = np.arange(len(shown)) % 3
    for axes, (name, deviations) in zip(panels, (("nominal", np.zeros_like(x)), ("extended", x)), strict=True):
        left: Array = 255 * model.left(deviations)
        for k, colour in enumerate(("#CC3311", "#228833", "#4477AA")):
            here = shown & (channel == k)
            axes.plot(
                np.flatnonzero(here), left[here], ".", markersize=2.5, color=colour, label=("red", "green", "blue")[k]
            )
        axes.axhline(0.0, color=GREY, linewidth=0.6)
        finished(axes, name, "patch of a picture held out", "measured - predicted [of 255]", legend=name == "nominal")
    return png(figure)
