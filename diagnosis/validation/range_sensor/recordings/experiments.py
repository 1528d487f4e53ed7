"""Experiments with recordings of a real sensor: each file beside the model."""

from collections.abc import Callable
from pathlib import Path

from configs.schema.robot import RobotConfig
from diagnosis.validation.experiment import Experiment, ExperimentResult, ValidatedPart
from diagnosis.validation.range_sensor.experiments import require_sight
from diagnosis.validation.range_sensor.recordings.after_move import after_move
from diagnosis.validation.range_sensor.recordings.edge import ball_edge
from diagnosis.validation.range_sensor.recordings.scan import read_scan
from diagnosis.validation.range_sensor.recordings.static import at_rest, read_rest_recording
from diagnosis.validation.range_sensor.stand import SensorOnStand
from symolo.core.errors import InputError
from symolo.core.files.paths import check_folder


def recordings(scan_folder: Path | None, static_folder: Path | None) -> ValidatedPart | None:
    """Return an experiment for every .csv file of both folders; None without any folder.

    Raises:
        InputError: A folder or file cannot be used; the message names file, row and column.
    """
    scans = _experiments("--scan", scan_folder, _scan_experiment)
    experiments = (*scans, *_experiments("--static", static_folder, _static_experiment))
    return ValidatedPart("range-sensor-recordings", experiments, require_sight) if experiments else None


def _experiments(option: str, folder: Path | None, experiment_of: Callable[[Path], Experiment]) -> list[Experiment]:
    if folder is None:
        return []
    cure = "name a folder of measured .csv files"
    check_folder(folder, cure, where=f"{option} {folder}")
    files = sorted(path for path in folder.glob("*.csv") if path.is_file())
    if not files:
        raise InputError("holds no .csv file", where=f"{option} {folder}", cure=cure)
    return [experiment_of(path) for path in files]


def _scan_experiment(path: Path) -> Experiment:
    scan = read_scan(path)

    def run(robot: RobotConfig, seed: int) -> ExperimentResult:
        """Return the results for edge and moves as one; the scan may lack either."""
        mounted = SensorOnStand.from_robot(robot, seed)
        results = [result for result in (ball_edge(mounted, scan), after_move(scan, mounted)) if result is not None]
        points, count = scan.reading_mm.shape
        tables = {"scan": {"points": points, "readings_per_point": count}}
        return ExperimentResult(
            tables | {name: table for result in results for name, table in result.tables.items()},
            [check for result in results for check in result.checks],
            [panel for result in results for panel in result.panels],
            [note for result in results for note in result.notes],
        )

    return Experiment(path.name, "Edges and first readings after a move.", run)


def _static_experiment(path: Path) -> Experiment:
    recording = read_rest_recording(path)

    def run(robot: RobotConfig, seed: int) -> ExperimentResult:
        return at_rest(SensorOnStand.from_robot(robot, seed), path.name, recording)

    return Experiment(path.name, "Noise and drift of a sensor at rest.", run)
