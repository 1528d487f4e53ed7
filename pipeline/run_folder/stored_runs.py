"""Runs that an earlier command simulated: their recordings and tables."""

from pathlib import Path
from zipfile import BadZipFile

from pipeline.run_folder.first_stage import TRAJECTORY, has_trajectory, read_recording
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.files.plain_files import check_tree
from symolo.core.tables.time_series import Recording
from symolo.dataset.layout import STAGES
from symolo.dataset.tables.rows import HEADER, Rows, parse_table
from symolo.dataset.tables.sensor_tables import sensor_csv
from symolo.dataset.tables.side_tables import TOF, WHEELS, SideTable, tof_csv, wheels_csv


def simulated_folders(out: Path) -> list[Path]:
    """Return the folders of all runs that were simulated in an output folder, sorted.

    Raises:
        UnsafeFileError: One is a link, or is reached through one.
    """
    check_tree(out, f"{STAGES}/simulate")
    return sorted(path.parent for path in out.glob(f"{STAGES}/simulate/*/*/{TRAJECTORY}"))


def trajectory_folders(out: Path) -> list[Path]:
    """Return the folders of all runs in an output folder whose trajectory was simulated, or taken from elsewhere.

    Raises:
        UnsafeFileError: One is a link, or is reached through one.
    """
    check_tree(out, f"{STAGES}/simulate")
    return sorted(path for path in out.glob(f"{STAGES}/simulate/*/*") if has_trajectory(path))


def run_name(folder: Path) -> str:
    """Return the name of the run in a folder, such as `CW/test_1`."""
    folder = folder.absolute()
    return f"{folder.parent.name}/{folder.name}"


def read_simulated(folder: Path) -> Recording:
    """Return the recording of a run that was simulated.

    Raises:
        InputError: The file is missing or damaged.
    """
    try:
        return read_recording(folder)
    except (OSError, ValueError, KeyError, BadZipFile) as error:
        where = str(folder / TRAJECTORY)
        raise InputError(f"cannot be read: {error}", where=where, cure="simulate again") from None


def tables_of(recording: Recording) -> tuple[Rows, Array, Array]:
    """Return data.csv, side/wheels.csv and side/tof.csv of a recording.

    The numbers go through the text of these files, so that they are the same before and after a release.
    """
    texts = (Rows.from_recording(recording).to_csv(), wheels_csv(recording), tof_csv(recording))
    headers = (HEADER, WHEELS.header, TOF.header)
    data, wheels, tof = (parse_table(text, header)[0] for text, header in zip(texts, headers, strict=True))
    return Rows.from_table(data), wheels, tof


def sensor_numbers(recording: Recording, table: SideTable) -> Array:
    """Return the table (samples, columns) of a sensor of `robot.sensors`, with the digits of its file."""
    return parse_table(sensor_csv(table, recording), table.header)[0]
