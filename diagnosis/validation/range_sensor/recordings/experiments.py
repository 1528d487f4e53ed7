"""Recorded scans and records of a real sensor beside the model, each file as an experiment."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TypeVar

from configs.schema.robot import RobotConfig
from diagnosis.validation.experiment import Experiment, ExperimentResult, ValidatedPart
from diagnosis.validation.range_sensor.experiments import require_sight
from diagnosis.validation.range_sensor.recordings.after_move import after_move
from diagnosis.validation.range_sensor.recordings.edge import ball_edge
from diagnosis.validation.range_sensor.recordings.scan import ScanRecording, read_scan
from diagnosis.validation.range_sensor.recordings.static import RestRecording, at_rest, read_rest_recording
from diagnosis.validation.range_sensor.stand import SensorOnStand
from symolo.core.errors import InputError

T = TypeVar("T")


def recordings(scans: Path | None, at_rest_: Path | None) -> ValidatedPart | None:
    """Return every .csv file of both folders as an experiment; None without any folder.

    Raises:
        InputError: A folder or file cannot be used; the message names file, row and column.
    """
    of_scans = _experiments(scans, "--scan", read_scan, _scan, "Edges and first readings after a move.")
    of_rest = _experiments(at_rest_, "--static", read_rest_recording, _at_rest, "Noise and drift of a sensor at rest.")
    experiments = (*of_scans, *of_rest)
    return ValidatedPart("range-sensor-recordings", experiments, require_sight) if experiments else None


def _experiments(
    folder: Path | None,
    option: str,
    read: Callable[[Path], T],
    run: Callable[[str, T, RobotConfig, int], ExperimentResult],
    shows: str,
) -> list[Experiment]:
    if folder is None:
        return []
    cure = "name a folder of measured .csv files"
    if not folder.is_dir():
        raise InputError("no such folder", where=f"{option} {folder}", cure=cure)
    files = sorted(path for path in folder.glob("*.csv") if path.is_file())
    if not files:
        raise InputError("holds no .csv file", where=f"{option} {folder}", cure=cure)
    return [Experiment(path.name, shows, partial(run, path.name, read(path))) for path in files]


def _scan(_name: str, scan: ScanRecording, robot: RobotConfig, seed: int) -> ExperimentResult:
    """Return both results of a scan as one; the scan may lack an edge or a move."""
    mounted = SensorOnStand.of_robot(robot, seed)
    results = [result for result in (ball_edge(mounted, scan), after_move(scan, mounted)) if result is not None]
    points, count = scan.reading_mm.shape
    return ExperimentResult(
        {"scan": {"points": points, "readings_per_point": count}}
        | {name: table for result in results for name, table in result.tables.items()},
        [check for result in results for check in result.checks],
        [panel for result in results for panel in result.panels],
        [note for result in results for note in result.notes],
    )


def _at_rest(name: str, recording: RestRecording, robot: RobotConfig, seed: int) -> ExperimentResult:
    return at_rest(SensorOnStand.of_robot(robot, seed), name, recording)
