"""The page that plays runs in a browser: one file with its data, images and script, which needs no network."""

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from symolo.arena.geometry import Arena, Box
from symolo.core.arrays import Array
from symolo.core.progress import Report
from symolo.pages.html import page_data, render_page
from symolo.pages.states import STATE_STYLES, Dash, named
from symolo.pages.thumbnails import thumbnail
from symolo.playback.from_run import playback_of
from symolo.playback.playback import CameraTrack, CurvePlot, Playback, PlottedCurve, Scan, StripePlot
from symolo.reader.dataset import Dataset
from symolo.reader.run_folder import Image
from symolo.report.statistics.run_facts import fresh
from symolo.report.statistics.spread import spread

SCRIPTS = ("map.js", "plots.js", "player.js")
_DECIMALS = 4
"""Digits after the point of lengths [m], angles [rad] and readings: more than a screen can show."""


@dataclass(frozen=True)
class ViewLimits:
    """How much of a dataset is on the page."""

    max_runs: int
    max_images: int
    """Images of all runs and cameras together."""
    max_width_px: int
    """Wider images are scaled down."""


@dataclass(frozen=True)
class ViewPage:
    """The page with the counts for a message."""

    html: bytes
    runs: int
    images: int


def view_page(data: Dataset, limits: ViewLimits, report: Report) -> ViewPage:
    """Return the page; the same runs give the same bytes.

    Args:
        data: At least one run.
        limits: More runs and images are left out, evenly spread; the page says so.
        report: Receives the progress.

    Raises:
        InputError: A file of a run is missing or damaged.
    """
    shown = spread(data.runs, limits.max_runs)
    per_run = max(1, limits.max_images // len(shown))
    runs = []
    with report.stage("view", len(shown), "runs") as stage:
        for number, run in enumerate(shown, start=1):
            shown_run = _run(playback_of(fresh(run)), per_run, limits.max_width_px)
            failure = data.failures.get(run.name)
            runs.append(shown_run | ({"failure": failure} if failure else {}))
            stage.update("all", number)
    images = sum(len(camera["t"]) for run in runs for camera in run["cameras"])
    html = render_page(
        "symolo.view",
        scripts=SCRIPTS,
        title=data.title,
        data=page_data({"runs": runs, "states": _states()}),
        runs=len(data),
        shown_runs=len(runs),
        images=sum(len(run.numbers) for run in shown),
        shown_images=images,
    )
    return ViewPage(html.encode(), len(runs), images)


def _states() -> dict[str, dict[str, str]]:
    return {str(state): {"name": named(state), "colour": style.colour} for state, style in STATE_STYLES.items()}


def _run(playback: Playback, max_images: int, max_width_px: int) -> dict[str, Any]:
    x, y, theta = (_numbers(values) for values in playback.pose.T)
    outline = playback.robot
    per_camera = max(1, max_images // max(len(playback.cameras), 1))
    return {
        "name": playback.name,
        "t": _numbers(playback.t_s),
        "pose": {"x": x, "y": y, "theta": theta},
        "state": playback.state.tolist(),
        "arena": _arena(playback.arena, playback.t_s),
        "robot": {
            "length": outline.length_m,
            "width": outline.width_m,
            "track": outline.track_m,
            "wheel": outline.wheel_diameter_m,
        },
        "beams": [
            {
                "name": beam.name,
                "x": beam.x_m,
                "y": beam.y_m,
                "yaw": beam.yaw_rad,
                "range": _numbers(beam.range_m),
                "colour": beam.colour,
            }
            for beam in playback.beams
        ],
        "scans": [_scan(scan) for scan in playback.scans],
        "plots": [_plot(plot, playback.t_s) for plot in playback.plots],
        "cameras": [_camera(camera, spread(camera.images, per_camera), max_width_px) for camera in playback.cameras],
    }


def _arena(arena: Arena | None, t_s: Array) -> dict[str, Any]:
    if arena is None:
        return {"line": [], "boxes": []}
    outlines = [np.concatenate((left, right[::-1])) for left, right in arena.line.edges()]
    return {"line": [_points(outline) for outline in outlines], "boxes": [_box(box, t_s) for box in arena.boxes]}


def _box(box: Box, t_s: Array) -> dict[str, Any]:
    """Return a box with its pose at each row, or with one pose if it stands still."""
    x, y, theta = (_numbers(values) for values in box.poses_at(t_s if box.motion is not None else t_s[:1]).T)
    size = {"length": box.size[0], "width": box.size[1]}
    return {"name": box.name, "kind": box.kind, "x": x, "y": y, "theta": theta, **size}


def _scan(scan: Scan) -> dict[str, Any]:
    """Return a lidar; its ranges are whole millimetres of 16 bits, low byte first, and 0 where a ray had no return."""
    millimetres = np.clip(np.rint(1000 * np.nan_to_num(scan.range_m)), 0, 65_535).astype("<u2")
    return {
        "name": scan.name,
        "x": scan.x_m,
        "y": scan.y_m,
        "angles": _numbers(scan.angles_rad),
        "t": _numbers(scan.t_s),
        "mm": base64.b64encode(millimetres.tobytes()).decode(),
    }


def _plot(plot: CurvePlot | StripePlot, t_s: Array) -> dict[str, Any]:
    """Return a plot; its times are left out where they are those of the run."""
    times = {} if np.array_equal(plot.t_s, t_s) else {"t": _numbers(plot.t_s)}
    head = {"title": plot.title, "unit": plot.unit, **times}
    if isinstance(plot, CurvePlot):
        curves = [_curve(curve) for curve in plot.curves]
        return {"kind": "curves", **head, "fromZero": plot.from_zero, "curves": curves}
    levels = np.clip(np.rint(255 * np.nan_to_num(plot.levels)), 0, 255).astype(np.uint8)
    rows, channels = levels.shape
    encoded = base64.b64encode(levels.tobytes()).decode()
    shape = {"rows": rows, "channels": channels, "names": plot.names}
    return {"kind": "stripes", **head, **shape, "levels": encoded}


def _curve(curve: PlottedCurve) -> dict[str, Any]:
    dashes = _dashes(curve.dash)
    return {"name": curve.name, "values": _numbers(curve.values), "colour": curve.colour, "dashes": dashes}


def _dashes(dash: Dash) -> list[float]:
    """Return the lengths of dashes and gaps in pixels."""
    return [] if dash == "-" else [1.5 * length for length in dash[1]]


def _camera(camera: CameraTrack, images: Sequence[Image], max_width_px: int) -> dict[str, Any]:
    return {
        "name": camera.name,
        "width": camera.width_px,
        "height": camera.height_px,
        "t": [image.t_s for image in images],
        "number": [image.number for image in images],
        "jpeg": [base64.b64encode(thumbnail(image, max_width_px)).decode() for image in images],
    }


def _numbers(values: Array) -> list[float | None]:
    """Return numbers with the digits of the page; None stands for a gap."""
    rounded = np.round(values, _DECIMALS) + 0.0
    return [None if np.isnan(value) else value for value in rounded.tolist()]


def _points(points: Array) -> list[list[float]]:
    return np.round(points, _DECIMALS).tolist()
