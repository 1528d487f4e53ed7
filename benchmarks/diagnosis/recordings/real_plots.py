"""Where runs end, by the nominal robot, by usual calibrations, and by the extended robot."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib.pyplot as plt
from real_drives import KINDS, Fitted, Missed

SHOWN = {
    "nominal": ("nominal", "0.6", "o"),
    "umbmark": ("UMBmark (squares)", "#7a9e3f", "^"),
    "whole paths": ("calibrated by whole paths", "#1b6ca8", "s"),
    "extended": ("extended robot", "#c2410c", "D"),
}
QUANTITIES = (("place_m", "end misplaced [mm]"), ("heading_rad", "heading off [mrad]"))


def by_session(fits: Sequence[Fitted], path: Path) -> None:
    """Plot the held-out runs of each session, predicted by what was fitted to its other runs."""
    sessions = [fitted for fitted in fits if "/" in fitted.name]
    figure, panels = plt.subplots(2, 1, figsize=(11, 7.5), sharex=True)
    for axes, (name, label) in zip(panels, QUANTITIES, strict=True):
        begin, ticks = 0, []
        for fitted in sessions:
            by = fitted.missed["held out"]
            for method, (legend, colour, marker) in SHOWN.items():
                sizes = _sizes(by.get(method, ()), name)
                x = range(begin, begin + len(sizes))
                axes.semilogy(x, sizes, marker, color=colour, ms=6, label=legend if "umbmark" in by else None)
            ticks.append((begin + (len(by["nominal"]) - 1) / 2.0, fitted.name.replace("/", "\n")))
            begin += len(by["nominal"])
            axes.axvline(begin - 0.5, color="0.88", lw=0.8, zorder=0)
        axes.set(ylabel=label, xlim=(-0.5, begin - 0.5))
        axes.grid(axis="y", color="0.92")
        axes.set_xticks([x for x, _ in ticks], [text for _, text in ticks], rotation=45, fontsize=7)
    handles = dict(zip(*reversed(panels[0].get_legend_handles_labels()), strict=True))
    figure.legend(handles.values(), handles.keys(), ncols=4, frameon=False, loc="upper center")
    figure.suptitle("Each run that was held out, predicted from its first pose and its counts", y=0.94, fontsize=11)
    figure.tight_layout(rect=(0, 0, 1, 0.95))
    figure.savefig(path, dpi=110)
    plt.close(figure)


def one_robot(fitted: Fitted, path: Path) -> None:
    """Plot all kinds of path by one robot, fitted to two thirds of all runs."""
    figure, panels = plt.subplots(2, 1, figsize=(9, 7))
    for axes, (name, label) in zip(panels, QUANTITIES, strict=True):
        begin = 0
        for kind in KINDS:
            by = fitted.missed[f"{kind}, held out"]
            for method, (legend, colour, marker) in SHOWN.items():
                if method in by:
                    sizes = _sizes(by[method], name)
                    x = range(begin, begin + len(sizes))
                    axes.semilogy(x, sizes, marker, color=colour, ms=6, label=legend if kind == KINDS[0] else None)
            axes.text(begin, 1.02, f" {kind}", transform=axes.get_xaxis_transform(), fontsize=9, color="0.3")
            begin += len(by["nominal"])
            axes.axvline(begin - 0.5, color="0.8", lw=0.8)
        axes.set(ylabel=label, xlim=(-0.5, begin - 0.5), xlabel="held-out run")
        axes.grid(axis="y", color="0.92")
    panels[0].legend(frameon=False, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.08))
    figure.suptitle("One robot for every kind of path", fontsize=11)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)


def _sizes(missed: Sequence[Missed], name: str) -> list[float]:
    return [1e3 * max(abs(getattr(one, name)), 1e-5) for one in missed]
