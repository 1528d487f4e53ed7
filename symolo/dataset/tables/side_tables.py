"""Tables in addition to data.csv: image positions, drive, range statuses, camera poses."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from symolo.core.arrays import Array
from symolo.core.tables.time_series import Recording
from symolo.dataset.codes import BOARD_COLUMNS, TofStatus
from symolo.dataset.tables.column import Column, Series, single
from symolo.dataset.tables.rows import ROW_TIME, Numbers, Rows, csv_bytes, heading

RowsOf = Literal["data", "images", "samples"]
"""Origin of the rows of a table: a row of data.csv, an image, or a sample at a time of its own."""


@dataclass(frozen=True)
class SideTable:
    """One file in `side/`, with the meaning of its columns."""

    file: str
    meaning: str
    columns: tuple[Column, ...]
    rows_of: RowsOf = "data"
    may_be_empty: bool = False
    """Whether cells are empty where nothing was measured, except those of the time."""

    @property
    def empty_names(self) -> tuple[str, ...]:
        """Columns whose cells may be empty."""
        return self.header[1:] if self.may_be_empty else ()

    @property
    def name(self) -> str:
        """Name of the file without its ending."""
        return self.file.partition(".")[0]

    @property
    def cells(self) -> tuple[Column, ...]:
        """Columns of the file, one for each number of a row."""
        return single(self.columns)

    @property
    def header(self) -> tuple[str, ...]:
        return tuple(column.name for column in self.cells)

    def to_csv(self, table: Numbers) -> bytes:
        return csv_bytes(self.header, [column.decimals for column in self.cells], table)


POSITIONS_HEADER = ("img", "x", "y", "theta")
POSITIONS_DECIMALS = (0, 6, 6, 6)

WHEELS_BY_LETTER = {"r": "right", "l": "left"}


def _wheel_columns(name: str, unit: str, meaning: str, decimals: int = 5) -> tuple[Column, ...]:
    """Return the columns `<name>_r` and `<name>_l`; a meaning has {} in the place of the wheel."""
    return tuple(
        Column(f"{name}_{letter}", unit, decimals, meaning.format(wheel)) for letter, wheel in WHEELS_BY_LETTER.items()
    )


STATUSES = ", ".join(f"{status.value} {status.name.lower()}" for status in TofStatus)
COUNTS = Series(
    "encoder_counts",
    "1",
    _wheel_columns(
        "counts", "encoder counts", "counts of the {} encoder since the start, as the controller receives them", 0
    ),
)
RANGE_STATUS = Series(
    "tof_status",
    "1",
    tuple(
        Column(f"status_{name[0]}", "-", 0, f"status of the {name} ToF sensor: {STATUSES}")
        for name in ("front", "left", "right")
    ),
)
WHEELS = SideTable(
    "wheels.csv",
    "drive at each row of data.csv; mean voltages are those since the row before; r is the right wheel, l the left; "
    "odometry counts from (0, 0, 0) at the start pose",
    (
        ROW_TIME,
        Column("command_v", "m/s", 5, "commanded forward speed"),
        Column("command_w", "rad/s", 5, "commanded yaw rate, counter-clockwise positive"),
        *_wheel_columns("speed", "rad/s", "true speed of the {} wheel, with the effects of its sensor"),
        *_wheel_columns("voltage", "V", "commanded voltage of the {} motor"),
        *_wheel_columns("mean_voltage", "V", "mean of the commanded voltage of the {} motor since the row before"),
        *_wheel_columns("current", "A", "true current of the {} motor, with the effects of its sensor"),
        *COUNTS.columns,
        Column("odometry_x", "m", 6, "position by odometry ahead of the start pose"),
        Column("odometry_y", "m", 6, "position by odometry to the left of the start pose"),
        Column("odometry_theta", "rad", 6, "heading by odometry, 0 at the start, from -3.141592 to 3.141593"),
    ),
)
DRIVE_SERIES = ("command", "wheel_speed_rad_s", "voltage_V", "mean_voltage_V", "current_A", COUNTS.name)
TOF = SideTable(
    "tof.csv",
    f"status of each ToF sensor at each row of data.csv: {STATUSES}",
    (ROW_TIME, *RANGE_STATUS.columns),
)
CAMERA = SideTable(
    "camera.csv",
    "pose X_WC of the camera at each shutter: rotation r11..r33 by rows and position p of C in W; "
    "C is the optical frame, x right, y down, z forward; "
    "when the exposure of the first row of pixels begins and how long that of each row is, t being the middle of all",
    (
        Column("img", "-", 0, "number of the image"),
        Column("t", "ms", 0, "middle of the exposure of the image, since the first row of data.csv"),
        *(
            Column(f"r{row}{column}", "-", 9, f"row {row}, column {column} of the rotation from C to W")
            for row in (1, 2, 3)
            for column in (1, 2, 3)
        ),
        *(Column(f"p_{axis}", "m", 6, f"{axis} of the origin of C in W") for axis in "xyz"),
        Column("exposure_start", "ms", 3, "begin of the exposure of the first row of pixels, on the clock of t"),
        Column("exposure", "ms", 3, "duration of the exposure of each row of pixels"),
    ),
    rows_of="images",
)
BOARD_SERIES = "board"
BOARD = SideTable(
    "board.csv",
    "the line to the board that drives, at each row of data.csv: whether it answered, whether the wheels were told to "
    "stand still because it did not, and how many frames were damaged on the way from it and to it, refused as "
    "impossible, answers to an older row, or repeated; whether it re-booted; whether the row began late",
    (ROW_TIME, *(Column(name, "-", 0, meaning) for name, meaning in BOARD_COLUMNS.items())),
)


def image_positions(rows: Rows) -> bytes:
    """Return image_positions.txt: the number of each image and the pose of the robot at its exposure."""
    taken = rows.image > 0
    table = np.column_stack((rows.image[taken], rows.pose[taken]))
    return csv_bytes(POSITIONS_HEADER, POSITIONS_DECIMALS, table, separator=" ")


def wheels_csv(recording: Recording) -> bytes:
    odometry = recording["odometry"].values.astype(np.float64)
    columns = [recording[name].values for name in DRIVE_SERIES]
    theta = heading(odometry[:, 2], WHEELS.columns[-1].decimals)
    return WHEELS.to_csv(np.column_stack((_t_ms(recording), *columns, odometry[:, :2], theta)))


def board_csv(recording: Recording) -> bytes:
    return BOARD.to_csv(np.column_stack((_t_ms(recording), recording[BOARD_SERIES].values)))


def tof_csv(recording: Recording) -> bytes:
    return TOF.to_csv(np.column_stack((_t_ms(recording), recording[RANGE_STATUS.name].values)))


def _t_ms(recording: Recording) -> Array:
    return np.rint(recording.trajectory.t_s * 1000)
