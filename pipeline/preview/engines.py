"""The two ways in which a preview's pictures are made, and the sheet that they come on."""

import math
import tempfile
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from blender_scenes.frame_files import frame_name
from blender_scenes.preview.renderer import FlatRenderer
from pipeline.dataset.metadata import FailedRun
from pipeline.own_files import keep_own_files
from pipeline.preview import Engine
from pipeline.preview.views import View
from pipeline.progress import Report
from pipeline.sheet import LINE_PX, Cell, Pixels, check_side, row, stacked
from pipeline.stages.render import RenderTask, render_runs
from pipeline.workspace import StageFolder

Made = tuple[dict[int, Pixels], list[FailedRun]]
"""Pictures (H, W, 3) BGR by number, and what went wrong with the others."""


def check_size(view: View, count: int, columns: int) -> None:
    """Refuse a sheet of so many views like this one that no picture file could hold, before any work is done for it."""
    camera, rows = view.job.camera, math.ceil(count / columns)
    check_side("wide", min(columns, count) * camera.width_px, "--columns or --width-px")
    check_side("high", rows * (camera.height_px + len(view.lines) * LINE_PX), "-n or --width-px, or more --columns")


def pictures(engine: Engine, views: Sequence[View], workers: int, report: Report) -> Made:
    """Of all views that can be seen."""
    with tempfile.TemporaryDirectory(prefix="symolo-", ignore_cleanup_errors=True) as folder:
        own_files = Path(folder) / "assets"
        for view in views:
            keep_own_files((view.look,), view.assets, own_files)
        if engine is Engine.FLAT:
            return _flat(views, own_files, report)
        return _cycles(views, Path(folder), own_files, workers, report)


def sheet(views: Sequence[View], made: dict[int, Pixels], columns: int) -> Pixels:
    """What was made in rows of so many, (H, W, 3) BGR."""
    cells = [Cell(made[view.number], view.lines) for view in views if view.number in made]
    width_px = cells[0].picture.shape[1]
    return stacked([row(cells[i : i + columns], width_px) for i in range(0, len(cells), columns)])


def _flat(views: Sequence[View], own_files: Path, report: Report) -> Made:
    """Without Blender, some tenths of a second each."""
    made, failures = {}, []
    with report.stage("preview", len(views), "images") as stage:
        for view in views:
            try:
                picture = FlatRenderer(view.job, own_files).picture(view.job.frames[0])
            except ValueError as error:
                failures.append(FailedRun.of(view.name, "preview", str(error)))
            else:
                made[view.number] = np.ascontiguousarray(picture[..., ::-1])
                stage.update(view.name, 1.0)
    return made, failures


def _cycles(views: Sequence[View], folder: Path, own_files: Path, workers: int, report: Report) -> Made:
    """As the render stage makes them."""
    tasks = [
        RenderTask(
            view.name,
            StageFolder(folder / str(view.number)),
            view.job.to_json(),
            (view.frame,),
            own_files=own_files,
        )
        for view in views
    ]
    failures = render_runs(tasks, workers, report)
    failed = {failure.run for failure in failures}
    good = [(view, task) for view, task in zip(views, tasks, strict=True) if view.name not in failed]
    return {view.number: _read(task.files / frame_name(view.number)) for view, task in good}, failures


def _read(path: Path) -> Pixels:
    return np.asarray(cv2.imdecode(np.frombuffer(path.read_bytes(), np.uint8), cv2.IMREAD_COLOR), np.uint8)
