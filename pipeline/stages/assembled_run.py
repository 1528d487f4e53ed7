"""What a release states about one of its runs in metadata.json, read from the folders of its stages."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from configs.schema.scenario import SceneSpec
from pipeline.run_folder.first_stage import TAKEN
from pipeline.run_folder.workspace import Workspace
from pipeline.stages.annotate import processors
from pipeline.stages.cameras import RunCamera, cameras_of, logged_cameras
from pipeline.stages.rendering_facts import Rendered
from pipeline.stages.run_tables import stage_has_images, stage_rows
from pipeline.stages.simulate_runs import read_outcome
from symolo.dataset.documents.metadata import RunRecord
from symolo.dataset.documents.run_records import CameraRecord
from symolo.dataset.layout import IMAGES, camera_folder
from symolo.dataset.tables.rows import Rows


@dataclass(frozen=True)
class AssembledRun:
    """What a release states about one of its runs."""

    spec: SceneSpec
    record: RunRecord
    cpus: frozenset[str]
    """Classes of the processors that made it."""
    columns: tuple[str, ...]
    """Columns of its data.csv."""


def assembled_run(workspace: Workspace, spec: SceneSpec) -> AssembledRun:
    """Return a run as a release of its stages states it."""
    stage = workspace.simulate(spec.key).path
    rows, outcome = stage_rows(stage), read_outcome(stage)
    drivers = {"board": outcome.board, "controller": outcome.controller}
    if not rows.image.any():
        logged = {name: _logged_record(stage, name, one) for name, one in logged_cameras(spec).items()}
        record = RunRecord.from_specification(
            spec, rows, outcome.lap_time_s, outcome.warnings, cameras=logged, **drivers
        )
        return AssembledRun(spec, record, frozenset({outcome.cpu} - {""}), rows.columns)
    cameras = {camera.name: camera for camera in cameras_of(spec)}
    rendered = {name: Rendered.read(workspace.render(spec.key, name).path) for name in cameras}
    annotated = {name: bool(camera.spec.render.annotations) for name, camera in cameras.items()}
    cpus = processors(workspace, spec.key, annotated)
    warnings = (*outcome.warnings, *_image_warnings(rendered))
    record = RunRecord.from_specification(
        spec,
        rows,
        outcome.lap_time_s,
        warnings,
        rendered[""].device,
        cpus=cpus,
        cameras={name: _camera_record(camera, rows, rendered[name]) for name, camera in cameras.items() if name},
        rendering=rendered[""].rendering,
        **drivers,
    )
    return AssembledRun(spec, record, frozenset({outcome.cpu, *cpus} - {""}), rows.columns)


def _image_warnings(rendered: Mapping[str, Rendered]) -> Iterator[str]:
    """Yield the warnings about the images of each camera."""
    for name, images in rendered.items():
        yield from (f"camera {name}: {warning}" if name else warning for warning in images.warnings)


def _camera_record(camera: RunCamera, rows: Rows, rendered: Rendered) -> CameraRecord:
    render = camera.spec.render
    return CameraRecord(
        period_s=camera.period_s,
        images=len(camera.rows(rows).t_ms),
        image_width_px=render.width_px,
        image_height_px=render.height_px,
        render_device=rendered.device,
        rendering=rendered.rendering,
        annotations=render.annotations,
    )


def _logged_record(stage: Path, name: str, settings: Mapping[str, Any]) -> CameraRecord:
    """Return the record of a camera of a log from the folder of the first stage."""
    return CameraRecord(
        period_s=settings["period_s"],
        images=sum(1 for _ in (stage / TAKEN / camera_folder(name) / IMAGES).iterdir()),
        image_width_px=settings["width_px"],
        image_height_px=settings["height_px"],
        render_device="",
    )


def cameras_with_images(workspace: Workspace, spec: SceneSpec) -> Sequence[RunCamera]:
    """Return the cameras of a simulated run that have rendered images."""
    return cameras_of(spec) if stage_has_images(spec, workspace.simulate(spec.key).path) else ()
