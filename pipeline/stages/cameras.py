"""The cameras of a run: that of data.csv and the further ones, each with a specification in which it is the camera."""

import json
from dataclasses import dataclass
from typing import Any

from configs.robot_sensors import IS_LOGGED, RobotSensors, UnloadedSettings
from configs.schema.scenario import RunSpec, SceneSpec
from symolo.dataset.documents.camera_specification import KIND, further_cameras, specification_of
from symolo.dataset.layout import camera_folder
from symolo.dataset.rates import period_beside_rows_s
from symolo.dataset.tables.camera_rows import rows_at_images
from symolo.dataset.tables.rows import Rows


@dataclass(frozen=True)
class RunCamera:
    """A camera of a run."""

    name: str
    """Name in `robot.sensors`; empty for the camera of data.csv."""
    spec: SceneSpec
    """Specification of the run in which this camera is that of data.csv."""
    period_s: float
    """Time between two images; 0 for the camera of data.csv, if all its images are at rows."""

    def rows(self, rows: Rows) -> Rows:
        """Return the rows of data.csv, or one row for each image of a camera whose images are between them."""
        return rows_at_images(rows, self.period_s) if self.period_s else rows

    def inner(self, path: str) -> str:
        """Return the path within the folder of the run of a file with this path within the folder of the camera."""
        return f"{camera_folder(self.name)}/{path}" if self.name else path


def cameras_of(spec: SceneSpec) -> tuple[RunCamera, ...]:
    """Return the cameras of a run whose images are rendered, that of data.csv first; none if it takes no images."""
    rates = spec.rates if isinstance(spec, RunSpec) else None
    if rates is not None and not rates.camera_hz:
        return ()
    nominal = RunCamera("", spec, period_beside_rows_s(rates) or 0.0)
    if KIND not in spec.robot.sensors.kinds:
        return (nominal,)
    content = spec.model_dump(mode="json")
    sensors = content["robot"]["sensors"]
    names = (name for name in further_cameras(content) if not sensors[name].get(IS_LOGGED))
    return (nominal, *(_further(spec, content, name) for name in names))


def _further(spec: SceneSpec, content: dict, name: str) -> RunCamera:
    swapped = type(spec).model_validate_json(json.dumps(specification_of(content, name)))
    return RunCamera(name, swapped, content["robot"]["sensors"][name]["period_s"])


def without_further_cameras(spec: RunSpec) -> RunSpec:
    """Return the specification with the camera of data.csv alone."""
    members = tuple((name, settings) for name, settings in spec.robot.sensors if settings.kind != KIND)
    robot = spec.robot.model_copy(update={"sensors": RobotSensors(members)})
    return spec.model_copy(update={"robot": robot})


def logged_cameras(spec: SceneSpec) -> dict[str, dict[str, Any]]:
    """Return the settings of the cameras of a log by name, whose images are not rendered."""
    return {
        name: settings.model_dump()
        for name, settings in spec.robot.sensors
        if isinstance(settings, UnloadedSettings) and settings.kind == KIND
    }
