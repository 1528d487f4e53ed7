"""The readers of logs behind `symolo import` and `symolo case init`, as `readers.py` has them."""

from collections.abc import Mapping
from functools import cache
from itertools import islice
from pathlib import Path

import numpy as np

from diagnosis.importers.choose import read_measurement
from diagnosis.measured.case_files.case_format import DATA, VOLTAGES
from diagnosis.measured.case_files.nominal import NOMINAL
from diagnosis.measured.case_files.write_case import csv_of, voltages_of
from diagnosis.measured.measurement import CaseKind
from diagnosis.new_case.new_case import new_case
from diagnosis.new_case.nominal_text import nominal_text
from diagnosis.new_case.proposal import propose
from diagnosis.new_case.quantities import KINDS
from diagnosis.new_case.room_corner import from_corner
from logs.log_file import read_log
from logs.mapping import mapping_text
from logs.trajectories.base import ReadSettings
from logs.trajectories.quantities import TRAJECTORY
from pipeline.diagnosing.importers import IMPORTERS
from pipeline.importing.imported_runs import ImportRequest, imported_dataset
from tests.diagnosis.new_case.drives import DT, csv_text, drive_rows
from tests.fuzz.folders import Folder, files
from tests.fuzz.guard import Read
from tests.logs import test_trajectory_readers as formats

T_S = 0.05 * np.arange(60)
TURN = 0.4 * T_S
PLACE = 0.5 * np.column_stack((np.sin(TURN), 1.0 - np.cos(TURN)))
"""A quarter of a circle with a radius of 0.5 m, from the origin along x."""
MAPPED = "mapped.csv"
MAPPING_FILE = "mapped.yaml"
MAPPING_OF_TABLE = """\
kind: trajectory
columns:
  t_s: {column: "c1", unit: ms}
  x_m: {column: "c2", unit: cm}
  y_m: {column: "c3", unit: cm, factor: -1}
  theta_rad: {column: "c4", unit: deg}
"""


def _table(columns: Mapping[str, np.ndarray], separator: str = ",") -> str:
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    return "\n".join([separator.join(columns), *(separator.join(map(str, row)) for row in rows)]) + "\n"


def _poses(x: str = "x_m", y: str = "y_m", heading: str = "heading_deg") -> dict[str, np.ndarray]:
    return {x: PLACE[:, 0].round(4), y: PLACE[:, 1].round(4), heading: np.degrees(TURN).round(3)}


def _parts_of_times(parts_per_s: int, second: str, part: str) -> dict[str, np.ndarray]:
    """Return two columns of times: whole seconds since 1970, and the parts of a second."""
    parts = 1_700_000_000 * parts_per_s + np.rint(parts_per_s * T_S).astype(np.int64)
    return {second: parts // parts_per_s, part: parts % parts_per_s}


@cache
def _trajectories() -> dict[str, bytes]:
    """Return the content of logs by path, one or more of each format that is text."""
    turned = {f"q{axis}": value for axis, value in (("z", np.sin(TURN / 2)), ("w", np.cos(TURN / 2)))}
    places = {"x_m": PLACE[:, 0], "y_m": PLACE[:, 1]}
    titled = _table({"t": T_S, **_poses("x", "y", "yaw"), "battery": 12 - 0.01 * T_S}, "\t")
    texts = {
        "robot.tum": formats.tum(formats.X_WR[:40], formats.T_S[:40]),
        "poses/00.txt": formats.kitti(formats.X_WR[:20]),
        "sequences/00/times.txt": formats.lines(formats.T_S[:20]),
        "sequences/00/calib.txt": "Tr: 0 -1 0 0 0 0 -1 0.2 1 0 0 -0.1\n",
        "sequences/00/origin.txt": "0 0 1 1.1 -1 0 0 2 0 -1 0 0.2\n",
        "euroc.csv": "".join(islice(formats.euroc(formats.X_WR).splitlines(keepends=True), 30)),
        "motive.csv": "".join(islice(formats.motive(formats.X_WR, lost=(5, 6)).splitlines(keepends=True), 40)),
        "named.csv": _table({"time_ms": 1000 * T_S, **_poses("X [mm]", "y (cm)"), "front_range_m": 1 + 0 * T_S}),
        "micro.csv": _table({**_parts_of_times(10**6, "tv_sec", "tv_usec"), **_poses(), "v": 0.2 + 0 * T_S}),
        "stamped.csv": _table(
            {**_parts_of_times(10**9, "header.stamp.sec", "header.stamp.nanosec"), **places, **turned}
        ),
        "titled.csv": f"# of a robot\nRun 7\ts\tm\n{titled}",
        "decimal.csv": _table({"t_s": T_S, **_poses()}, ";").replace(".", ","),
        MAPPED: _table({"c1": 1000 * T_S, **_poses("c2", "c3", "c4")}),
        MAPPING_FILE: MAPPING_OF_TABLE,
    }
    contents = {name: text.encode() for name, text in texts.items()}
    run = next(data for data in files("dataset") if data.startswith(b"@CW/test_1/data.csv\n"))
    return {**contents, "run/data.csv": run.partition(b"\n")[2]}


def trajectories() -> list[bytes]:
    return [f"@{name}\n".encode() + content for name, content in _trajectories().items()]


def import_reader(place: Path) -> Read:
    """Read a log, or the log to which a changed file belongs, as the run of a dataset, and write its mapping file."""
    for name, content in _trajectories().items():
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        (place / name).write_bytes(content)
    folder = Folder.from_path(place)

    def read(data: bytes) -> None:
        with folder.replaced(data) as path:
            log, mapping = path, None
            if path.parent.name == "00":
                log = place / "poses/00.txt"
            if path.stem == Path(MAPPED).stem:
                log, mapping = place / MAPPED, place / MAPPING_FILE
            dataset = imported_dataset(ImportRequest((log,), settings=ReadSettings(mapping)))
            for run in dataset.runs:
                run.rows.to_csv()
                run.spec.model_dump_json()
            for each in dataset.logs:
                if (found := each.trajectory.mapping) is not None:
                    mapping_text(found, TRAJECTORY, read_log(log, found.header), ("symolo", "import"))

    return read


@cache
def _logs_of_cases() -> dict[str, bytes]:
    """Return logs of each kind of case, as nobody but their recorder calls their columns."""
    drive = {name: np.asarray(column) for name, column in drive_rows(DT * np.arange(80)).items()}
    others = {name: column for name, column in drive.items() if name not in {"time_ms", "heading_deg"}}
    halves = np.radians(drive["heading_deg"]) / 2
    micro_s = 1_700_000_000_000_000 + 1000 * drive["time_ms"].astype(np.int64)
    micro = {"tv_sec": micro_s // 10**6, "tv_usec": micro_s % 10**6}
    steps = np.repeat([0.0, 3.0, -3.0, 0.0], 15)
    k = np.arange(60)
    noise = 0.01 * (k % 7)
    texts = {
        "drive.csv": csv_text(drive),
        "micro.csv": _table({**micro, **others, "qz": np.sin(halves), "qw": np.cos(halves)}),
        "step.csv": _table(
            {"t [ms]": 5 * k, "u_V": steps, "current_mA": 50 * steps + noise, "rpm": 80 * steps + noise}
        ),
        "steady.csv": _table({"time_s": 3 * k, "voltage": 0.1 * k, "I_A": 0.05 + 0.001 * k, "speed_rad_s": 2.0 * k}),
        "range.csv": _table({"t_s": 2 * k, "distance_cm": 10 + k, "reading_mm": 100 + 10 * k + noise}),
    }
    return {name: text.encode() for name, text in texts.items()}


def log_of_many_trials() -> bytes:
    """Return a drive whose times begin again after every four rows, each of which is then a trial."""
    columns = {name: np.asarray(column)[:4] for name, column in drive_rows(DT * np.arange(10)).items()}
    header, _, rows = csv_text(columns).partition("\n")
    return f"@drive.csv\n{header}\n{400 * rows}".encode()


def logs_of_cases() -> list[bytes]:
    return [f"@{name}\n".encode() + content for name, content in _logs_of_cases().items()]


def case_reader(place: Path) -> Read:
    """Make a case of a log with the mapping that is proposed for it; the case is read back."""
    for name, content in _logs_of_cases().items():
        (place / name).write_bytes(content)
    folder, written = Folder.from_path(place), place / "case"
    written.mkdir()

    def read(data: bytes) -> None:
        with folder.replaced(data) as path:
            table = read_log(path)
            mapping = from_corner(propose(table).mapping, {})
            case = new_case(table, mapping, "mine")
            assert KINDS[CaseKind(mapping.kind)].suffices(mapping.columns)
            case.compared()
            case.unknown()
            contents = {DATA: csv_of(case.measurement), VOLTAGES: voltages_of(case.measurement)}
            contents[NOMINAL] = nominal_text(case.measurement, {})
            mapping_text(mapping, KINDS[CaseKind(mapping.kind)], table, ("symolo", "case", "init"))
            for name, text in contents.items():
                (written / name).unlink(missing_ok=True)
                if text:
                    (written / name).write_text(text)
            read_measurement(written, IMPORTERS)

    return read
