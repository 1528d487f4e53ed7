"""Tables with any column names and units: their mapping, by a file or from names and values."""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from logs.columns.drive import COUNTED, DRIVE_TABLE
from logs.columns.missing import missing
from logs.columns.proposal import Proposal, propose_as, unit_faults
from logs.counts import jump_note, running_counts
from logs.log_file import LogFile, read_log
from logs.log_lines import SEPARATORS
from logs.mapping import LogMapping, Source, check_mapping, missing_note, read_mapping, unused_columns
from logs.recognition import first_row, has_separator_below_title, is_file, names_above_numbers
from logs.times import goes_back
from logs.trajectories.base import LoggedTable, LoggedTrajectory, ReadSettings, TrajectoryReader
from logs.trajectories.motion_units import guessable, per_unit, time_and_length
from logs.trajectories.path_direction import headings_along
from logs.trajectories.planar import on_floor
from logs.trajectories.quantities import DRIVE_QUANTITIES, QUATERNION, READING_OF, TRAJECTORY
from logs.units.heading import guessed_heading_unit
from logs.units.names import factor_to, taken_apart
from symolo.core.arrays import Array
from symolo.core.errors import FaultList, InputError
from symolo.core.geometry.poses import rotations
from symolo.core.progress import plural

PATH_LENGTH_M = 0.05
"""Distance over which the direction of a path is its heading."""
_MOTION = ("t_s", "x_m", "y_m", "z_m", "theta_rad")
_NEEDED = (*_MOTION, *QUATERNION)
"""Quantities without which a row is left out."""
LOG_TABLE = "log"
"""Name of the table with the columns that are no quantity of a trajectory."""
DRIVE_LOG = "drive_log"
"""Kind of a mapping file of `symolo case init` whose quantities are also those of a trajectory."""
_WHEELS = (COUNTED, ("u_left_V", "u_right_V"))
_ENDINGS = (".csv", ".txt", ".tsv", ".log", ".dat")


def propose_trajectory(log: LogFile) -> Proposal:
    """Return a mapping of a table to a trajectory; units that no name states are those of a possible motion.

    Raises:
        InputError: Times or places are not among the columns.
    """
    proposal = propose_as(log, TRAJECTORY, left_open=_MOTION)
    sources = dict(proposal.mapping.columns)
    stated = {
        name: bool(source.quaternion or source.nanoseconds or taken_apart(source.column).unit)
        or source.column in log.clocks
        for name, source in sources.items()
    }
    has_our_name = {name: source.column == name for name, source in sources.items()}
    warnings = [*proposal.warnings]
    with suppress(InputError):  # wrong cells are reported together, when the rows are read
        warnings += _guess_motion(log, sources, {name: stated[name] or has_our_name[name] for name in sources})
    mapping = LogMapping.model_validate({"kind": TRAJECTORY.name, "columns": sources})
    return Proposal(mapping, tuple(warnings))


def _guess_motion(log: LogFile, sources: dict[str, Source], known: Mapping[str, bool]) -> list[str]:
    """Give times, places and headings the units of a possible motion; return a sentence for each guess."""
    t, x, y = (sources[name].numbers(log) for name in ("t_s", "x_m", "y_m"))
    good = np.isfinite(t) & np.isfinite(x) & np.isfinite(y)
    t, place = t[good], np.column_stack((x, y))[good]
    if len(t) < 2:
        return []
    length_known = known["x_m"] or known["y_m"]
    times = [sources["t_s"].unit] if known["t_s"] else guessable("s")
    lengths = [sources["x_m"].unit or sources["y_m"].unit] if length_known else guessable("m")
    time, length = time_and_length(t, place, times, lengths)
    lines = []
    if not known["t_s"]:
        sources["t_s"] = sources["t_s"].model_copy(update={"unit": time})
        lines.append(f"{sources['t_s'].column} (t_s): the name has no unit; taken for {time or 's'}")
    if not length_known:
        for name in ("x_m", "y_m", *(["z_m"] if "z_m" in sources else [])):
            sources[name] = sources[name].model_copy(update={"unit": length})
        speed = _usual_speed(t / per_unit("s")[time], place / per_unit("m")[length])
        names = ", ".join(sources[name].column for name in ("x_m", "y_m"))
        lines.append(f"{names} (x_m, y_m): the names have no unit; taken for {length or 'm'}, which gives {speed}")
    if "theta_rad" in sources and not known["theta_rad"]:
        column = sources["theta_rad"].column
        t_s, place_m = t / per_unit("s")[time], place / per_unit("m")[length]
        unit, reason = guessed_heading_unit(t_s, place_m, log.numbers(column)[good])
        if reason:
            sources["theta_rad"] = sources["theta_rad"].model_copy(update={"unit": unit})
            lines.append(f"{column} (theta_rad): the name has no unit; taken for {unit or 'radians'}, {reason}")
    return lines


def _usual_speed(t_s: Array, place_m: Array) -> str:
    ways, steps = np.hypot(*np.diff(place_m, axis=0).T), np.diff(t_s)
    moves = (ways > 0.0) & (steps > 0.0)
    return f"{np.median(ways[moves] / steps[moves]):.3g} m/s" if moves.any() else "no motion"


@dataclass(frozen=True)
class _MappedTable:
    log: LogFile
    mapping: LogMapping
    guesses: tuple[str, ...]

    @classmethod
    def from_file(cls, path: Path, settings: ReadSettings) -> "_MappedTable":
        if settings.mapping is None:
            log = read_log(path)
            proposal = propose_trajectory(log)
            return cls(log, proposal.mapping, proposal.warnings)
        mapping = read_mapping(settings.mapping, [TRAJECTORY], also=[DRIVE_LOG])
        log = read_log(path, mapping.header)
        if mapping.kind == DRIVE_LOG:
            columns = {name: source for name, source in mapping.columns.items() if name in TRAJECTORY.names}
            mapping = LogMapping.model_validate({"kind": TRAJECTORY.name, "header": log.names, "columns": columns})
        check_mapping(mapping, TRAJECTORY, log, str(settings.mapping))
        return cls(log, mapping, ())

    def values(self, notes: list[str]) -> dict[str, Array]:
        """Return the numbers of each quantity in our unit, (N,); `notes` gets what was changed.

        Raises:
            InputError: A cell is no number, or a quantity is out of reach; all are reported.
        """
        faults, values = FaultList(), {}
        for name, source in self.mapping.columns.items():
            with faults.noted():
                if source.constant is not None:
                    values[name] = np.full(self.log.rows, float(source.constant))
                else:
                    factor = source.factor * factor_to(TRAJECTORY.unit_of(name), source.unit, f"columns.{name}")
                    counted = running_counts(source.numbers(self.log), source, name, notes)
                    values[name] = factor * counted + source.offset
        if not faults.faults:
            faults.faults += unit_faults(self.mapping, TRAJECTORY, values, self.log)
        faults.check()
        return values


def _read(path: Path, settings: ReadSettings) -> list[LoggedTrajectory]:
    table = _MappedTable.from_file(path, settings)
    notes = list(table.log.notes)
    values = table.values(notes)
    rows, changes = _usable_rows(values, table)
    values = {name: column[rows] for name, column in values.items()}
    sources = table.mapping.columns
    how = "in a mapping file, with --map"
    jumps = [jump_note(sources[name].column, values[name], values["t_s"], how) for name in COUNTED if name in values]
    notes += [f"CHECK {jump}" for jump in jumps if jump]
    notes += missing_note(table.mapping, table.log, [name for name in DRIVE_QUANTITIES if name in values])
    notes += _lone_wheels(values)
    pose, quantities, lost, warnings, guesses = _poses(values, table, settings)
    others = (*_drive(values), *_others(table, rows))
    return [
        LoggedTrajectory(
            values["t_s"],
            pose,
            {name: source.text for name, source in table.mapping.columns.items()} | quantities,
            {READING_OF[name]: column for name, column in values.items() if name in READING_OF},
            others,
            (*notes, *changes, *lost),
            (*table.guesses, *guesses),
            warnings,
            mapping=table.mapping,
        )
    ]


def _lone_wheels(values: Mapping[str, Array]) -> Iterator[str]:
    """Yield a note for each quantity of a wheel that was not recognised for the other wheel."""
    for pair in _WHEELS:
        absent = [name for name in pair if name not in values]
        if len(absent) == 1:
            yield (
                f"no column was recognised as {absent[0]}, so that a diagnosis cannot use the other wheel either; "
                "rename the column, or name it in a mapping file"
            )


def _usable_rows(values: Mapping[str, Array], table: _MappedTable) -> tuple[np.ndarray, list[str]]:
    """Return the rows with a time and a pose, and what was left out.

    Raises:
        InputError: The time goes back, or no row is left.
    """
    needed = [name for name in _NEEDED if name in values]
    complete = np.isfinite([values[name] for name in needed]).all(axis=0)
    rows = np.flatnonzero(complete)
    if not len(rows):
        empty = ", ".join(
            column
            for name in needed
            if not np.isfinite(values[name]).any()
            for column in table.mapping.columns[name].columns
        )
        what = f"column {empty} is empty" if empty else "no row has both a time and a pose"
        raise InputError(what, where=str(table.log.path), allowed="numbers in the columns of time and pose")
    changes = []
    if len(rows) < len(complete):
        changes.append(f"left out: {plural(len(complete) - len(rows), 'row')} without a time or a pose")
    steps = np.diff(values["t_s"][rows])
    back = np.flatnonzero(steps < 0.0)
    if len(back):
        row = int(rows[int(back[0]) + 1])
        raise goes_back(float(-steps[back[0]]), table.log.where(row))
    repeated = np.concatenate(([False], steps == 0.0))
    if repeated.any():
        changes.append(f"left out: {plural(np.count_nonzero(repeated), 'row')} with the time of the row above")
    return rows[~repeated], changes


def _poses(
    values: Mapping[str, Array], table: _MappedTable, settings: ReadSettings
) -> tuple[Array, dict[str, str], tuple[str, ...], tuple[str, ...], tuple[str, ...]]:
    """Return poses (N, 3), sources of quantities, what is left out, warnings and guesses.

    Raises:
        InputError: There are no headings.
    """
    place = np.column_stack((values["x_m"], values["y_m"]))
    where = str(table.log.path)
    if settings.heading_from_path:
        yaw_rad = headings_along(place, PATH_LENGTH_M)
        if yaw_rad is None:
            raise InputError(f"the path is shorter than {PATH_LENGTH_M} m, so that it has no direction", where=where)
        text = "headings are the direction of the path, because none were measured"
        return np.column_stack((place, yaw_rad)), {"theta_rad": "direction of the path"}, (text,), (), ()
    if "theta_rad" in values:
        return np.column_stack((place, values["theta_rad"])), {}, (), (), ()
    if all(name in values for name in QUATERNION):
        p_OB = np.column_stack((place, values.get("z_m", np.zeros(len(place)))))
        R_OB = rotations(np.column_stack([values[name] for name in QUATERNION]))
        floor = on_floor(p_OB, R_OB, where, up=settings.up, forward=settings.forward)
        return floor.pose, floor.quantities, floor.changes, floor.warnings, floor.guesses
    error = missing(table.log, TRAJECTORY, {name: "" for name in values if name != "theta_rad"} | {"z_m": ""})
    cure = "name the column of the heading in a mapping file, or take the direction of the path: --heading-from-path"
    raise InputError("no column was recognised as the heading", where=where, cure=cure) from error


def _drive(values: Mapping[str, Array]) -> tuple[LoggedTable, ...]:
    """Return what was logged of the drive as one table, in our units."""
    columns = {name: (TRAJECTORY.unit_of(name), values[name]) for name in DRIVE_QUANTITIES if name in values}
    return (
        (LoggedTable(DRIVE_TABLE, "commands, voltages and encoder counts of the wheels", columns),) if columns else ()
    )


def _others(table: _MappedTable, rows: np.ndarray) -> tuple[LoggedTable, ...]:
    """Return the columns of numbers that are no quantity of a trajectory, as one table."""
    columns: dict[str, tuple[str, Array]] = {}
    for name in unused_columns(table.mapping, table.log):
        with suppress(InputError):  # words
            values = table.log.numbers(name)[rows]
            if np.isfinite(values).any():
                columns[name] = taken_apart(name).unit or ("s" if name in table.log.clocks else "-"), values
    meaning = f"columns of {table.log.path.name} that are no quantity of a trajectory, in its own units"
    return (LoggedTable(LOG_TABLE, meaning, columns),) if columns else ()


def _recognises(path: Path) -> bool:
    if not is_file(path) or path.suffix.lower() not in _ENDINGS:
        return False
    # A tab at the end of the line separates nothing; a header may be a comment.
    is_separated = any(separator in first_row(path).strip() for separator in SEPARATORS)
    return is_separated or has_separator_below_title(path, SEPARATORS) or bool(names_above_numbers(path))


READER = TrajectoryReader("table", "a table with a header line, whatever its columns are called", _recognises, _read)
