"""metadata.json: all that one needs to understand the data and to make it again; the same data give the same bytes."""

import platform
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import FailFast, Field, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from symolo.arena.geometry import Arena
from symolo.core.files.file_hashes import canonical_json
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.os_errors import NOT_THERE
from symolo.core.versions import versions
from symolo.dataset.annotations import AnnotationName
from symolo.dataset.codes import State
from symolo.dataset.documents.origin import Origin
from symolo.dataset.documents.record import Record, parsed_first
from symolo.dataset.documents.rendering_record import RenderingRecord
from symolo.dataset.documents.run_document import RunDocument, TofSection
from symolo.dataset.documents.run_records import BoardRecord, CameraRecord, ControllerRecord, RatesRecord, StartRecord
from symolo.dataset.documents.scenario_tree import ScenarioTree
from symolo.dataset.documents.splits_record import SplitsRecord
from symolo.dataset.layout import DATA
from symolo.dataset.rates import period_beside_rows_s
from symolo.dataset.tables.camera_rows import main_camera_rows
from symolo.dataset.tables.column import Column, single
from symolo.dataset.tables.obstacles import obstacle_table
from symolo.dataset.tables.rows import COLUMNS, HEADER, IMG_NEAREST, RANGES, Rows
from symolo.dataset.tables.sensor_tables import MAX_COLUMNS, SENSOR_NAME, TAKEN_NAMES, TIME, ListedSensor
from symolo.dataset.tables.side_tables import BOARD, CAMERA, TOF, WHEELS, SideTable

METADATA = "metadata.json"
LOG_TAIL = "; the last lines of its log:"
"""Text in an error of the renderer that comes before its log."""
_FOLDERS = re.compile(r"""(?<=["'])/(?:[^/"'\n]+/)*(?=[^\s/"'])|(?<![\w.)"'])/(?:[^\s/"']+/)*(?=[^\s/"'])""")
FORMAT_VERSION = 1

_MEANINGS = {
    State.LINE: "line following",
    State.RIGHT_WALL: "wall following, wall on the right",
    State.LEFT_WALL: "wall following, wall on the left",
    State.TURN_LEFT: "turn left",
    State.TURN_RIGHT: "turn right",
    State.AVOID_LEFT: "obstacle avoidance by the left",
    State.AVOID_RIGHT: "obstacle avoidance by the right",
    State.LOST_LEFT_WALL: "lost the wall on the left, turns towards it",
    State.LOST_RIGHT_WALL: "lost the wall on the right, turns towards it",
}
STATES = {state.value: _MEANINGS[state] for state in State}
FRAMES = {
    "W": "world: x and y on the floor, z up; theta counter-clockwise from +x",
    "R": "robot: middle of the axle on the floor, x forward, y left, z up",
    "C": "camera, optical (OpenCV's, and REP 103's for optical frames): x right, y down, z along the axis",
    "B": "camera, body (REP 103): x along the axis, y left, z up; X_CB in side/intrinsics.json",
}


class RunRecord(Record):
    """Facts of one released run."""

    run: str
    """Folder of the run, for example `CW/test_1`."""
    seed: int
    start: StartRecord
    rates: RatesRecord | None = Field(default=None, exclude_if=lambda rates: rates is None)
    """Rates of the simulation; None if the trajectory was imported from a log, whose rows may come at any time."""
    image_width_px: int
    image_height_px: int
    render_device: str = "CPU"
    """Name in Cycles of the device that rendered the images."""
    rendering: RenderingRecord | None = Field(default=None, exclude_if=lambda rendering: rendering is None)
    """How the images were rendered; None in datasets of earlier versions."""
    cpu_classes: tuple[str, ...] = Field(default=(), exclude_if=lambda classes: not classes)
    """Classes of the processors that made its images and annotations, if several: the last bits may differ."""
    rows: int
    images: int
    duration_s: float
    distance_m: float
    lap_time_s: float | None
    state_order: list[int]
    """States in the order in which they occurred; empty if they are not known."""
    tof_min_range_m: float | None = Field(default=None, exclude_if=lambda range_m: range_m is None)
    tof_max_range_m: float | None = Field(default=None, exclude_if=lambda range_m: range_m is None)
    """Limits of the range sensors; None if no range was measured."""
    tof_no_target_m: float | None = Field(default=None, exclude_if=lambda range_m: range_m is None)
    """Range in data.csv where a sensor saw no target."""
    warnings: list[str] = Field(default_factory=list)
    """Warnings for users of the images, for example that many are black or overexposed."""
    drawn: dict[str, float | int | str | bool]
    """Every value drawn for this run by its field path."""
    annotations: tuple[AnnotationName, ...] = Field(default=(), exclude_if=lambda kinds: not kinds)
    board: BoardRecord | None = Field(default=None, exclude_if=lambda board: board is None)
    """Record of the controller board; None if the built-in controller drove."""
    controller: ControllerRecord | None = Field(default=None, exclude_if=lambda controller: controller is None)
    """Record of the user's controller; None if the built-in one or a board drove."""
    origin: Origin | None = Field(default=None, exclude_if=lambda origin: origin is None)
    """Origin of the trajectory; None if the run was simulated for this dataset."""
    cameras: dict[Annotated[str, Field(pattern=SENSOR_NAME)], CameraRecord] = Field(
        default_factory=dict, exclude_if=lambda cameras: not cameras
    )
    """Further cameras by name; `images` and the fields beside it are those of the camera of data.csv."""

    @model_validator(mode="after")
    def _simulations_have_rates(self) -> "RunRecord":
        if self.rates is None and not self.is_imported:
            raise PydanticCustomError("missing", "rates: missing, and the trajectory was not imported")
        return self

    @property
    def is_imported(self) -> bool:
        """Whether the trajectory was imported from a log."""
        return self.origin is not None and self.origin.log is not None

    def of_camera(self, name: str) -> "RunRecord":
        """Return the record with the images of a further camera in the place of those of data.csv."""
        camera = self.cameras[name]
        return self.model_copy(update=camera.model_dump(exclude={"period_s"}))

    @classmethod
    def from_specification(
        cls,
        specification: object,
        rows: Rows,
        lap_time_s: float | None,
        warnings: Sequence[str] = (),
        render_device: str = "CPU",
        *,
        cpus: Sequence[str] = (),
        board: BoardRecord | None = None,
        controller: ControllerRecord | None = None,
        cameras: Mapping[str, CameraRecord] | None = None,
        rendering: RenderingRecord | None = None,
    ) -> "RunRecord":
        """Return the facts of a run.

        Args:
            specification: Any object with the fields of a `RunDocument`.
            rows: The content of data.csv.
            lap_time_s: None if the run is not a lap.
            warnings: Warnings for users of the images.
            render_device: Device that rendered the images, in the words of Cycles.
            cpus: Classes of the processors that made images and annotations.
            board: The board that drove, if there was one.
            controller: The user's controller that drove, if there was one.
            cameras: Records of the further cameras by name.
            rendering: How the images were rendered.
        """
        spec = RunDocument.model_validate(specification)
        changes = np.flatnonzero(np.diff(rows.state)) + 1
        steps = np.linalg.norm(np.diff(rows.pose[:, :2], axis=0), axis=1)
        return cls(
            run=spec.key,
            seed=spec.seed,
            start=StartRecord.model_validate(spec.start),
            rates=RatesRecord.model_validate(spec.rates) if spec.rates else None,
            image_width_px=spec.render.width_px,
            image_height_px=spec.render.height_px,
            render_device=render_device,
            rendering=rendering,
            cpu_classes=tuple(cpus) if len(cpus) > 1 else (),
            rows=len(rows.t_ms),
            images=len(main_camera_rows(rows, spec.rates).t_ms),
            duration_s=float(rows.t_ms[-1]) / 1000,
            distance_m=round(float(steps.sum()), 4),
            lap_time_s=lap_time_s,
            state_order=[int(rows.state[i]) for i in (0, *changes)] if rows.has_state else [],
            warnings=list(warnings),
            drawn=dict(spec.drawn),
            annotations=spec.render.annotations,
            board=board,
            controller=controller,
            origin=spec.origin,
            **_range_limits(spec.robot.tof, rows),
            cameras=dict(cameras or {}),
        )


def _range_limits(tof: TofSection, rows: Rows) -> dict[str, float]:
    """Return the limits of the range sensors with the digits of data.csv; nothing if no range was measured."""
    columns = [column for column in rows.definitions if column in RANGES.columns]
    if not columns:
        return {}
    names = ("min_range_m", "max_range_m", "no_target_m")
    return {f"tof_{name}": round(getattr(tof, name), columns[0].decimals) for name in names}


class FailedRun(Record):
    """A run of the scenario that is not released, with the reason."""

    run: str
    stage: str
    problem: str
    """One line without paths, so that the dataset has the same bytes on every machine."""

    @classmethod
    def from_error(cls, run: str, stage: str, text: str) -> "FailedRun":
        """Return the record of an error, whose text may end with a log and name folders of this machine."""
        first = text.partition(LOG_TAIL)[0].strip().partition("\n")[0]
        return cls(run=run, stage=stage, problem=_FOLDERS.sub("", first))


class ColumnRecord(Record):
    """Name, unit and meaning of a column of a table, or of several numbered columns."""

    name: str
    unit: str
    meaning: str = ""
    decimals: int | None = Field(default=None, ge=0, exclude_if=lambda decimals: decimals is None)
    """Digits after the point in the table of a sensor of `sensors`; a column of 0 digits has whole numbers."""
    count: int = Field(default=1, ge=1, le=MAX_COLUMNS, exclude_if=lambda count: count == 1)
    """Number of columns. More than one are numbered from 0: `range` stands for `range_0`, `range_1`..."""

    @classmethod
    def from_column(cls, column: Column) -> "ColumnRecord":
        """Return the record of a column of a sensor's table."""
        return cls(**asdict(column))

    @property
    def column(self) -> Column:
        return Column(self.name, self.unit, self.decimals or 0, self.meaning, self.count)


class SensorRecord(Record):
    """A sensor of `robot.sensors`, whose table is `side/<name>.csv`."""

    kind: str
    """Kind of the sensor; each run's spec.json has its settings."""
    meaning: str
    """Meaning of the table, which has a row for each sample."""


class Metadata(Record):
    """The content of metadata.json."""

    format: str = "SyMoLo"
    format_version: int = FORMAT_VERSION
    name: str
    description: str
    licence: str
    seed: int
    made_with: dict[str, str]
    """Version by program."""
    frames: dict[str, str]
    states: dict[int, str]
    columns: dict[str, list[ColumnRecord]]
    """Columns by file name."""
    sensors: dict[Annotated[str, Field(pattern=SENSOR_NAME)], SensorRecord] = Field(
        default_factory=dict, exclude_if=lambda sensors: not sensors
    )
    """Sensors of `robot.sensors` by name."""
    scenario: ScenarioTree
    """The resolved scenario with arena, robot and look; a mapping such as {uniform: [a, b]} is a distribution."""
    runs: Annotated[list[RunRecord], FailFast()] = Field(min_length=1)
    failed_runs: Annotated[list[FailedRun], FailFast()]
    splits: SplitsRecord | None = Field(default=None, exclude_if=lambda splits: splits is None)
    """Division into training, validation and test; None if the dataset is not divided."""

    _parsed = model_validator(mode="before")(parsed_first)

    @model_validator(mode="after")
    def _splits_have_runs(self) -> "Metadata":
        for fault in self.splits.faults({run.run for run in self.runs}) if self.splits else ():
            raise ValueError(fault)
        return self

    @model_validator(mode="after")
    def _sensors_have_columns(self) -> "Metadata":
        for name in self.sensors:
            file = f"side/{name}.csv"
            columns = self.columns.get(file, [])
            if name in TAKEN_NAMES:
                raise ValueError(f"sensors: {file} is not the table of a sensor")
            if len(columns) < 2 or columns[0].name != TIME.name or any(c.decimals is None for c in columns):
                raise ValueError(f"columns: {file} has not the columns of a sensor: t, and each with its decimals")
        return self

    @property
    def data_columns(self) -> tuple[str, ...]:
        """Columns of data.csv in their order; all of them if the file does not list them."""
        named = {column.name for column in self.columns.get(DATA, ())}
        return tuple(name for name in HEADER if name in named) or HEADER

    @property
    def sensor_tables(self) -> tuple[SideTable, ...]:
        """Tables of the sensors of `robot.sensors`."""
        return tuple(
            SideTable(
                f"{name}.csv",
                sensor.meaning,
                tuple(column.column for column in self.columns[f"side/{name}.csv"]),
                "samples",
                may_be_empty=any(run.is_imported for run in self.runs),
            )
            for name, sensor in self.sensors.items()
        )

    @property
    def listed_sensors(self) -> tuple[ListedSensor, ...]:
        """Sensors of `robot.sensors` with their kinds and tables."""
        return tuple(map(ListedSensor, (sensor.kind for sensor in self.sensors.values()), self.sensor_tables))

    def header(self, file: str) -> tuple[str, ...]:
        """Return the names of the columns of a table, as its first line has them; `file` is a key of `columns`."""
        return tuple(column.name for column in single(column.column for column in self.columns[file]))

    def to_json(self) -> bytes:
        return canonical_json(self.model_dump(mode="json"))


def side_tables(spec: RunDocument, *, has_images: bool = True) -> tuple[SideTable, ...]:
    """Return the tables of a run of the scenario beside those of its sensors.

    All runs have the same moving obstacles. Of a trajectory that was imported, nobody knows voltages, statuses and the
    like.
    """
    obstacles = obstacle_table(Arena.from_config(spec.arena))
    drive = () if spec.is_imported else (WHEELS, TOF)
    camera = (CAMERA,) if has_images else ()
    return (*drive, *camera, *([BOARD] if spec.board else []), *([obstacles] if obstacles else []))


def made_with(*, simulated: bool = True, rendered: bool = True) -> dict[str, str]:
    """Return the versions of the programs that make a dataset whose runs are simulated, rendered, or both."""
    packages = versions("symolo", "pybullet", "bpy", "numpy", "scipy", "opencv-python-headless")
    unused = {*(() if simulated else ("pybullet", "scipy")), *(() if rendered else ("bpy", "opencv-python-headless"))}
    return {"python": platform.python_version()} | {
        name: version for name, version in packages.items() if name not in unused
    }


def describe(
    tree: dict[str, Any],
    specifications: Sequence[object],
    runs: Sequence[RunRecord],
    failed: Sequence[FailedRun],
    sensors: Sequence[ListedSensor] = (),
    *,
    columns_of_data: Sequence[str] = HEADER,
    splits: SplitsRecord | None = None,
) -> Metadata:
    """Return the metadata of a dataset.

    Args:
        tree: The scenario as loaded, before anything is drawn.
        specifications: Specifications of the runs: objects with the fields of a `RunDocument`.
        runs: The released runs.
        failed: The runs that are not released.
        sensors: Sensors of `robot.sensors`.
        columns_of_data: Columns of data.csv, which are the same in all runs.
        splits: Division into training, validation and test.
    """
    first, has_images = RunDocument.model_validate(specifications[0]), any(run.images for run in runs)
    return Metadata(
        name=first.scenario,
        description=str(tree.get("description", "")),
        licence=str(tree.get("licence", "CC-BY-4.0")),
        seed=first.seed,
        made_with=made_with(simulated=not all(run.is_imported for run in runs), rendered=has_images),
        frames=FRAMES,
        states=STATES if "state" in columns_of_data else {},
        columns=_columns_of_tables(first, sensors, columns_of_data, has_images=has_images),
        sensors={one.table.name: SensorRecord(kind=one.kind, meaning=one.table.meaning) for one in sensors},
        scenario=tree,
        runs=list(runs),
        failed_runs=list(failed),
        splits=splits,
    )


def _columns_of_tables(
    run: RunDocument, sensors: Sequence[ListedSensor], columns_of_data: Sequence[str], *, has_images: bool
) -> dict[str, list[ColumnRecord]]:
    """Return the columns of data.csv and of the tables of side/ by the path of the table in a run."""
    meanings = {} if period_beside_rows_s(run.rates) is None else {"img": IMG_NEAREST}
    columns = {
        DATA: [
            ColumnRecord(name=c.name, unit=c.unit, meaning=meanings.get(c.name, c.meaning))
            for c in COLUMNS
            if c.name in columns_of_data
        ]
    }
    for table in side_tables(run, has_images=has_images):
        records = [ColumnRecord(name=c.name, unit=c.unit, meaning=c.meaning) for c in table.columns]
        columns[f"side/{table.file}"] = records
    for sensor in sensors:
        columns[f"side/{sensor.table.file}"] = [ColumnRecord.from_column(column) for column in sensor.table.columns]
    return columns


def read_metadata(root: Path) -> Metadata | None:
    """Return the content of metadata.json of a folder; None if there is none, or if it has a different format."""
    try:
        return Metadata.model_validate_json(read_file(root / METADATA, FileKind.DOCUMENT))
    except (*NOT_THERE, ValidationError):
        return None
