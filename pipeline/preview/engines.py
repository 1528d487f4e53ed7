"""The two renderers of preview images, and the sheet that shows them."""

import math
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from blender_scenes.preview.renderer import FlatRenderer
from pipeline.executors.local import Local
from pipeline.planning.plan import image_bytes
from pipeline.preview import Engine
from pipeline.preview.views import PreviewImage, on_device
from pipeline.run_folder.user_image_copies import copy_user_images
from pipeline.run_folder.workspace import StageFolder
from pipeline.stages.render import IMAGES, RenderTask, render_runs
from symolo.core.files.disk_space import check_scratch
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.files.scratch_folders import scratch_folder
from symolo.core.progress import Report
from symolo.dataset.documents.metadata import FailedRun
from symolo.dataset.layout import frame_name
from symolo.pages.sheet import LINE_PX, Cell, Pixels, check_side, in_columns

RenderedViews = tuple[dict[int, Pixels], list[FailedRun]]
"""Images by number, (H, W, 3) BGR, and the failures of the other views."""


def check_size(view: PreviewImage, count: int, columns: int) -> None:
    """Refuse a sheet that is too large for an image file, before any work starts."""
    render, rows = view.appearance.render, math.ceil(count / columns)
    check_side("wide", min(columns, count) * render.width_px, "--columns or --width-px")
    check_side("high", rows * (render.height_px + len(view.lines) * LINE_PX), "-n or --width-px, or more --columns")


def render_views(engine: Engine, views: Sequence[PreviewImage], workers: int, report: Report) -> RenderedViews:
    """Return the images of all views that can be rendered."""
    with scratch_folder() as folder:
        user_files = folder / "assets"
        for view in views:
            copy_user_images((view.appearance.look,), view.assets, user_files)
        if engine is Engine.FLAT:
            return _flat(views, user_files, report)
        return _cycles(views, folder, user_files, workers, report)


def usual_columns(count: int) -> int:
    """Return the number of images in a row: all of up to six, else three to six with the fewest places left empty."""
    return min(range(3, 7), key=lambda columns: (-count % columns, -columns)) if count > 6 else count


def sheet(views: Sequence[PreviewImage], images: dict[int, Pixels], columns: int) -> Pixels:
    """Return the images in rows of that many columns, (H, W, 3) BGR."""
    cells = [Cell(images[view.number], view.lines) for view in views if view.number in images]
    return in_columns(cells, columns)


def _flat(views: Sequence[PreviewImage], user_files: Path, report: Report) -> RenderedViews:
    """Render without Blender, some tenths of a second each."""
    images, failures = {}, []
    with report.stage("preview", len(views), "images") as stage:
        for view in views:
            try:
                job = view.job()
                image = FlatRenderer(job, user_files).image(job.frames[0])
            except ValueError as error:
                failures.append(FailedRun.from_error(view.name, "preview", str(error)))
            else:
                images[view.number] = np.ascontiguousarray(image[..., ::-1])
                stage.update(view.name, 1.0)
    return images, failures


def _cycles(
    views: Sequence[PreviewImage], folder: Path, user_files: Path, workers: int, report: Report
) -> RenderedViews:
    """Render as in a release."""
    render = views[0].appearance.render
    each = image_bytes(1, render.width_px * render.height_px, annotated=False)
    check_scratch(len(views) * each, "choose fewer images with -n")
    views = on_device(views)
    folders = {view.number: StageFolder(folder / str(view.number)) for view in views}
    frame_jobs = (
        RenderTask.frame_job(view.name, folders[view.number], view.job(), (view.frame,), user_files) for view in views
    )
    failures = render_runs(frame_jobs, Local(workers), report)
    failed = {failure.run for failure in failures}
    good = [view.number for view in views if view.name not in failed]
    images = {}
    for number in good:
        data = read_file(folders[number].path / IMAGES / frame_name(number), FileKind.IMAGE)
        images[number] = np.asarray(cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR), np.uint8)
    return images, failures
