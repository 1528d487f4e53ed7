"""Checks of one released run: structure, columns, units, ranges, rates, images, positions."""

import codecs
import json
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.progress import plural
from symolo.dataset.documents.camera_model import INTRINSICS, CameraDocument, camera_table, read_camera_document
from symolo.dataset.documents.camera_specification import specification_of
from symolo.dataset.documents.metadata import METADATA, RunRecord
from symolo.dataset.documents.run_document import ArenaSection, RunDocument
from symolo.dataset.documents.run_records import RatesRecord
from symolo.dataset.documents.scene_record import SCENE, read_scene_record
from symolo.dataset.layout import ANNOTATIONS, IMAGES, POSITIONS, SIDE, camera_folder
from symolo.dataset.rates import period_beside_rows_s
from symolo.dataset.tables.camera_rows import image_column, main_camera_rows, rows_at, rows_at_images
from symolo.dataset.tables.obstacles import obstacle_table, off_the_path
from symolo.dataset.tables.rows import HEADER, MAY_BE_EMPTY, Rows, parse_table, semantic_faults
from symolo.dataset.tables.sensor_tables import fractions, sample_times_ms
from symolo.dataset.tables.side_reading import first_fault, image_times
from symolo.dataset.tables.side_tables import BOARD, CAMERA, POSITIONS_HEADER, TOF, WHEELS, SideTable
from symolo.verification.annotations import annotation_faults
from symolo.verification.findings import Finding, limited
from symolo.verification.image_checks import check_images

SpecCheck = Callable[[str], str]
"""Returns the fault of the text of a spec.json; empty if it has none."""

START_TOLERANCE_M = 0.002
FASTEST_M_S = 3.0
FASTEST_RAD_S = 30.0


def check_run(
    root: Path,
    record: RunRecord,
    check_spec: SpecCheck,
    sensor_tables: Sequence[SideTable] = (),
    columns: Sequence[str] = HEADER,
) -> Iterator[Finding]:
    """Yield every fault of a run's folder.

    Args:
        root: The dataset.
        record: The run as metadata.json describes it.
        check_spec: Checks more of spec.json than the fields that a reader needs.
        sensor_tables: Tables of the sensors of `robot.sensors`, as metadata.json describes them.
        columns: Columns of data.csv of an imported trajectory, as metadata.json describes them; a simulation has all.
    """
    run = root / record.run
    if not run.is_dir():
        yield Finding(record.run, "the folder is missing")
        return
    data = f"{record.run}/data.csv"
    columns, may_be_empty = (columns, MAY_BE_EMPTY) if record.is_imported else (HEADER, ())
    table, faults = _table(run / "data.csv", columns, may_be_empty=may_be_empty)
    yield from limited(data, faults)
    if len(table) == 0:
        return
    rows = Rows.from_table(table, columns)
    yield from limited(data, [str(fault) for fault in semantic_faults(rows)])
    yield from _rows_checks(data, rows, record)
    # Without the times of the rows, those of images between them are not known.
    is_in_time = record.rates is not None and np.array_equal(rows.t_ms, _times_ms(len(rows.t_ms), record.rates))
    at_images = main_camera_rows(rows, record.rates if is_in_time else None)
    yield from check_images(run / IMAGES, f"{record.run}/{IMAGES}", at_images, record)
    if record.images:
        yield from _positions(run / POSITIONS, f"{record.run}/{POSITIONS}", at_images)
    content, spec, faults = _specification(run / "side/spec.json", f"{record.run}/side/spec.json", check_spec)
    yield from faults
    yield from _side(run / "side", f"{record.run}/side", rows, record)
    if record.images:
        yield from _camera(run / "side", f"{record.run}/side", at_images, record, spec)
    yield from _sensors(run / "side", f"{record.run}/side", rows, record, spec, sensor_tables)
    if spec is not None and spec.origin != record.origin:
        yield Finding(f"{record.run}/side/spec.json", "origin is not that of metadata.json")
    if spec is not None and isinstance(content, dict):
        yield from _listed(run, content, spec, rows, record, {table.name for table in sensor_tables})
    if content is not None:
        yield from _obstacles(run / "side", f"{record.run}/side", content, rows, record)
    for file, what in annotation_faults(run / ANNOTATIONS, at_images, record, spec):
        yield Finding(f"{record.run}/{ANNOTATIONS}/{file}".rstrip("/"), what)


def _listed(  # noqa: PLR0917 - everything that the cameras of a run depend on
    run: Path, content: Mapping[str, Any], spec: RunDocument, rows: Rows, record: RunRecord, tables: set[str]
) -> Iterator[Finding]:
    """Check that metadata.json has the sensors of spec.json, and check the further cameras."""
    listed = tables | {*record.cameras}
    if {*spec.robot.sensors} != listed:
        names = ", ".join(sorted(listed)) or "none"
        yield Finding(f"{record.run}/side/spec.json", f"robot.sensors are not those of metadata.json, {names}")
        return
    for camera in record.cameras:
        yield from _further_camera(run, content, rows, record, camera)


def _further_camera(
    run: Path, content: Mapping[str, Any], rows: Rows, record: RunRecord, name: str
) -> Iterator[Finding]:
    """Check the folder of a further camera as that of the camera of data.csv."""
    folder, where = run / camera_folder(name), f"{record.run}/{camera_folder(name)}"
    if not folder.is_dir():
        yield Finding(where, "the folder is missing")
        return
    try:
        settings = content["robot"]["sensors"][name]
        is_logged = settings.get("logged") is True and record.is_imported
        spec = RunDocument.model_validate_json(json.dumps(specification_of(content, name)))
        at_images = rows_at_images(rows, settings["period_s"])
    except (KeyError, TypeError, ValueError, InputError):
        yield Finding(f"{record.run}/side/spec.json", f"robot.sensors.{name} does not describe a camera")
        return
    if is_logged:
        numbers, faults = _table(folder / SIDE / CAMERA.file, CAMERA.header)
        try:
            at_images = rows_at(rows, image_times(numbers, rows)) if not faults else at_images
        except ValueError as error:
            yield Finding(f"{where}/{SIDE}/{CAMERA.file}", str(error))
            return
    record_of_camera = record.of_camera(name)
    yield from check_images(folder / IMAGES, f"{where}/{IMAGES}", at_images, record_of_camera, "its period")
    yield from _positions(folder / POSITIONS, f"{where}/{POSITIONS}", at_images, "its path")
    yield from _camera(folder / SIDE, f"{where}/{SIDE}", at_images, record_of_camera, spec, is_logged=is_logged)
    for file, what in annotation_faults(folder / ANNOTATIONS, at_images, record_of_camera, spec):
        yield Finding(f"{where}/{ANNOTATIONS}/{file}".rstrip("/"), what)


def _camera_times(path: Path, name: str, rows: Rows) -> Iterator[Finding]:
    numbers, faults = _table(path, CAMERA.header)
    yield from limited(name, faults)
    if len(numbers) and not np.array_equal(numbers[:, CAMERA.header.index("t")], rows.t_ms[rows.image > 0]):
        yield Finding(name, "column t is not that of the images")


def _rows_checks(name: str, rows: Rows, record: RunRecord) -> Iterator[Finding]:
    if len(rows.t_ms) != record.rows:
        yield Finding(name, f"{plural(len(rows.t_ms), 'row')}, metadata.json says {record.rows}")
    if record.rates:
        yield from _rates(name, rows, record.rates)
    start = np.array([record.start.x_m, record.start.y_m])
    if np.linalg.norm(rows.pose[0, :2] - start) > START_TOLERANCE_M:
        x, y = rows.pose[0, :2]
        yield Finding(name, f"line 2: columns x, y: ({x:g}, {y:g}) m is not the start in metadata.json")
    yield from _values(name, rows)
    if not record.is_imported:  # a measurement may jump, and its sensors may be of any kind
        yield from _ranges(name, rows, record)
        yield from _motion(name, rows)


def _times_ms(rows: int, rates: RatesRecord) -> Array:
    return np.rint(np.arange(rows) * 1000 / rates.control_hz)


def _rates(name: str, rows: Rows, rates: RatesRecord) -> Iterator[Finding]:
    """Check that rows and images are at their rates."""
    row_hz, camera_hz = rates.control_hz, rates.camera_hz
    late = rows.t_ms != _times_ms(len(rows.t_ms), rates)
    yield from limited(name, _at(late, rows.t_ms, "column t", f"ms does not keep {row_hz} Hz"))
    if late.any() and period_beside_rows_s(rates) is not None:
        return
    wrong = rows.image != image_column(rows.t_ms, rates)
    yield from limited(name, _at(wrong, rows.image, "column img", f"does not keep {camera_hz:g} Hz"))


def _ranges(name: str, rows: Rows, record: RunRecord) -> Iterator[Finding]:
    low, high, none = record.tof_min_range_m, record.tof_max_range_m, record.tof_no_target_m
    if low is None or high is None or none is None:
        yield Finding(METADATA, f"{record.run}: the limits of the range sensors are missing")
        return
    outside = ((rows.tof_m < low) | (rows.tof_m > high)) & (rows.tof_m != none)
    for i, column in enumerate(("d_f", "d_l", "d_r")):
        what = f"m is outside {low:g}..{high:g} and not the no-target value {none:g}"
        yield from limited(name, _at(outside[:, i], rows.tof_m[:, i], f"column {column}", what))


def _values(name: str, rows: Rows) -> Iterator[Finding]:
    """Check reflectances, headings and speeds."""
    for i in range(8):
        channel = rows.line[:, i]
        yield from limited(name, _at((channel < 0) | (channel > 1), channel, f"column L{i}", "is outside 0..1"))
    theta = rows.pose[:, 2]
    yield from limited(name, _at(np.abs(theta) > np.pi + 1e-6, theta, "column theta", "rad is outside -pi..pi"))
    for i, (column, fastest, unit) in enumerate((("v", FASTEST_M_S, "m/s"), ("w", FASTEST_RAD_S, "rad/s"))):
        value = rows.twist[:, i]
        what = f"{unit} is beyond what the robot can do ({fastest:g} {unit})"
        yield from limited(name, _at(np.abs(value) > fastest, value, f"column {column}", what))


def _motion(name: str, rows: Rows) -> Iterator[Finding]:
    """Check that position and heading change with the speeds; a column in another unit does not."""
    dt = np.diff(rows.t_ms) / 1000
    if len(dt) == 0 or np.any(dt <= 0):
        return
    steps = np.linalg.norm(np.diff(rows.pose[:, :2], axis=0), axis=1)
    jumps = np.concatenate(([False], steps > FASTEST_M_S * dt))
    yield from limited(name, _at(jumps, np.concatenate(([0.0], steps)), "columns x, y", "m is a jump"))
    mean = 0.5 * (rows.twist[1:] + rows.twist[:-1])
    driven, stepped = float(np.sum(np.abs(mean[:, 0]) * dt)), float(steps.sum())
    if abs(driven - stepped) > 0.02 + 0.1 * max(driven, stepped):
        yield Finding(name, f"column v adds up to {driven:.3f} m, columns x, y to {stepped:.3f} m")
    turned = float(np.sum(mean[:, 1] * dt))
    seen = float(np.unwrap(rows.pose[:, 2])[-1] - rows.pose[0, 2])
    if abs(turned - seen) > 0.3 + 0.1 * abs(seen):
        yield Finding(name, f"column w adds up to {turned:.2f} rad, column theta to {seen:.2f} rad")


def _positions(path: Path, name: str, rows: Rows, source: str = "data.csv") -> Iterator[Finding]:
    table, faults = _table(path, POSITIONS_HEADER, separator=" ")
    yield from limited(name, faults)
    taken = rows.image > 0
    expected = np.column_stack((rows.image[taken], rows.pose[taken]))
    if len(table) == 0:
        return
    if len(table) != len(expected):
        yield Finding(name, f"{plural(len(table), 'position')} for {plural(len(expected), 'image')} in {source}")
        return
    differ = np.flatnonzero(np.any(table != expected, axis=1))
    yield from limited(
        name, [f"line {i + 2}: is not the pose of image {expected[i, 0]:.0f} in {source}" for i in differ]
    )


def _specification(path: Path, name: str, check_spec: SpecCheck) -> tuple[object, RunDocument | None, list[Finding]]:
    """Return a run's specification as plain JSON and as a document, each None if it is damaged, and its faults."""
    try:
        content = json.loads(read_file(path, FileKind.DOCUMENT))
    except (OSError, ValueError, RecursionError) as error:
        return None, None, [Finding(name, f"cannot be read: {error}")]
    text = json.dumps(content)
    try:
        document = RunDocument.model_validate_json(text)
    except ValidationError as error:
        return content, None, [Finding(name, check_spec(text) or first_fault(error))]
    problem = check_spec(text)
    return content, None if problem else document, [Finding(name, problem)] if problem else []


def _side(folder: Path, name: str, rows: Rows, record: RunRecord) -> Iterator[Finding]:
    by_row = () if record.is_imported else (WHEELS, TOF, BOARD) if record.board else (WHEELS, TOF)
    for table in by_row:
        numbers, faults = _table(folder / table.file, table.header)
        yield from limited(f"{name}/{table.file}", faults)
        if len(numbers) and not np.array_equal(numbers[:, table.header.index("t")], rows.t_ms):
            yield Finding(f"{name}/{table.file}", "column t is not that of data.csv")
    yield from _scene(folder / SCENE, f"{name}/{SCENE}")


def _camera(
    folder: Path, name: str, rows: Rows, record: RunRecord, spec: RunDocument | None, *, is_logged: bool = False
) -> Iterator[Finding]:
    """Check the tables of a camera; `rows` has a row for each of its images."""
    yield from _camera_times(folder / CAMERA.file, f"{name}/{CAMERA.file}", rows)
    yield from _camera_model(folder / INTRINSICS, f"{name}/{INTRINSICS}", record, spec, is_logged=is_logged)
    if spec is not None:
        yield from _camera_poses(folder / CAMERA.file, f"{name}/{CAMERA.file}", rows, spec)


def _sensors(  # noqa: PLR0917 - everything that a run's tables depend on
    folder: Path, name: str, rows: Rows, record: RunRecord, spec: RunDocument | None, tables: Sequence[SideTable]
) -> Iterator[Finding]:
    """Check the tables of the sensors of `robot.sensors`."""
    for table in tables:
        file = f"{name}/{table.file}"
        numbers, faults = _table(folder / table.file, table.header, may_be_empty=table.empty_names)
        yield from limited(file, faults or [*fractions(table, numbers)])
        if not faults and spec is not None and record.rates is not None and table.name in spec.robot.sensors:
            period_s = spec.robot.sensors[table.name].period_s
            expected = sample_times_ms(period_s, record.rates.physics_hz, float(rows.t_ms[-1]))
            if not np.array_equal(numbers[:, 0], expected):
                yield Finding(file, f"column t is not one sample every {1000 * period_s:g} ms from 0 to the last row")


def _camera_model(
    path: Path, name: str, record: RunRecord, spec: RunDocument | None, *, is_logged: bool = False
) -> Iterator[Finding]:
    """Check intrinsics.json; of a camera of a log it alone has the lens, since its pixels may not be square."""
    try:
        model = read_camera_document(path)
    except OSError as error:
        yield Finding(name, f"cannot be read: {error.strerror}")
        return
    except ValueError as error:
        yield Finding(name, str(error))
        return
    size = record.image_width_px, record.image_height_px
    if (model.width_px, model.height_px) != size:
        what = f"is of images of {model.width_px} x {model.height_px} px, metadata.json says {size[0]} x {size[1]}"
        yield Finding(name, what)
    elif spec is not None:
        expected = CameraDocument.from_imaging(spec)
        for field in CameraDocument.model_fields:
            if is_logged and field in {"K", "D"}:
                continue
            if getattr(model, field) != getattr(expected, field):
                yield Finding(name, f"{field} is not that of the camera in spec.json")


def _scene(path: Path, name: str) -> Iterator[Finding]:
    """Check the form alone, since the furniture depends on the version; older releases have no such file."""
    try:
        read_scene_record(path)
    except FileNotFoundError:
        return
    except OSError as error:
        yield Finding(name, f"cannot be read: {error.strerror}")
    except ValueError as error:
        yield Finding(name, str(error))


def _camera_poses(path: Path, name: str, rows: Rows, spec: RunDocument) -> Iterator[Finding]:
    """Check poses and exposures against data.csv and the camera's mounting."""
    table, _ = _table(path, CAMERA.header)
    expected = camera_table(spec, rows)
    if not len(table):
        return
    if table.shape != expected.shape:
        yield Finding(name, f"{plural(len(table), 'pose')} for {plural(len(expected), 'image')} in data.csv")
        return
    wrong = np.abs(table - expected) > [1.1 * 10.0**-column.decimals for column in CAMERA.columns]
    for i, column in zip(*np.nonzero(wrong), strict=True):
        header = CAMERA.header[column]
        yield Finding(name, f"line {i + 2}: column {header}: {table[i, column]:g} is not that of the camera's mounting")
        return


def _obstacles(folder: Path, name: str, spec: object, rows: Rows, record: RunRecord) -> Iterator[Finding]:
    """Check the poses of moving obstacles against the paths of spec.json."""
    section = spec.get("arena") if isinstance(spec, dict) else None
    try:
        config = ArenaSection.model_validate_json(json.dumps(section))
    except ValidationError as error:
        yield Finding(f"{name}/spec.json", f"arena.{first_fault(error)}")
        return
    arena = Arena.from_config(config.model_copy(update={"walls": ()}))  # walls of a damaged file may be impossible
    table = obstacle_table(arena)
    if table is None:
        return
    file = f"{name}/{table.file}"
    numbers, faults = _table(folder / table.file, table.header)
    yield from limited(file, faults)
    if not len(numbers):
        return
    if not np.array_equal(numbers[:, 0], rows.t_ms):
        yield Finding(file, "column t is not that of data.csv")
        return
    for obstacle, wrong in off_the_path(arena, numbers, rows, record.rates.control_hz if record.rates else None):
        yield from limited(file, [f"line {i + 2}: {obstacle} is not where its path in spec.json leads" for i in wrong])


def _table(
    path: Path, header: Sequence[str], separator: str = ",", may_be_empty: Collection[str] = ()
) -> tuple[Array, list[str]]:
    try:
        data = read_file(path, FileKind.TABLE)
    except OSError as error:
        return np.empty((0, len(header))), [f"cannot be read: {error.strerror}"]
    table, faults = parse_table(data, header, separator, may_be_empty)
    texts = [str(fault) for fault in faults]
    if not data.endswith(b"\n"):
        texts.append("does not end with a line end: the file is cut off")
    # Both are read, as of logs of other programs, and written by no release.
    if data.startswith(codecs.BOM_UTF8):
        texts.append("begins with a byte-order mark")
    if not faults and b"\r" in data:
        texts.append("has line ends of Windows")
    return table, texts


def _at(wrong: np.ndarray, values: np.ndarray, column: str, what: str) -> list[str]:
    return [f"line {i + 2}: {column}: {values[i]:g} {what}" for i in np.flatnonzero(wrong)]
