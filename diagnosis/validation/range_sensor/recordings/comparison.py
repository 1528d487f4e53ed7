"""Real scans and records beside the model, and in words what the model has not."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from configs.schema.robot import RobotConfig
from diagnosis.validation.range_sensor.recordings.after_move import DEVICE_PERIOD_S, AfterMove, after_move
from diagnosis.validation.range_sensor.recordings.columns import csv_files
from diagnosis.validation.range_sensor.recordings.edge import EdgeComparison, compare_edge
from diagnosis.validation.range_sensor.recordings.scan import ScanRecord, read_scan
from diagnosis.validation.range_sensor.recordings.static import (
    Record,
    StaticComparison,
    compare_static,
    findings,
    read_record,
)
from diagnosis.validation.range_sensor.stand import Bench

CLEARLY = 0.8
"""Of the residual of one law of light, below which the other explains a scan better."""
SHARE_WITHIN = 0.15
"""Of the way, within which a held value explains the readings after a move."""


@dataclass(frozen=True)
class ScanComparison:
    file: str
    points: int
    readings_per_point: int
    after_move: AfterMove | None
    """None where no move changes the range, or none leaves it."""
    edge: EdgeComparison | None
    """None where nothing near stands before something far."""


@dataclass(frozen=True)
class MeasuredComparison:
    scans: tuple[ScanComparison, ...]
    static: tuple[StaticComparison, ...]
    findings: tuple[str, ...]


@dataclass(frozen=True)
class Measured:
    """Files as read and found good, by name."""

    scans: tuple[tuple[str, ScanRecord], ...]
    static: tuple[tuple[str, Record], ...]


def read_measured(scan: Path | None, static: Path | None) -> Measured:
    """Every .csv file of both folders.

    Raises:
        InputError: A folder or file cannot be used; the text names file, row and column.
    """
    scans = csv_files(scan, "--scan") if scan is not None else []
    records = csv_files(static, "--static") if static is not None else []
    return Measured(
        scans=tuple((path.name, read_scan(path)) for path in scans),
        static=tuple((path.name, read_record(path)) for path in records),
    )


def compare(robot: RobotConfig, seed: int, measured: Measured) -> MeasuredComparison:
    """Edges, first readings after a move, noise and drift of each file, beside the robot's sensor."""
    bench = Bench.of(robot, seed)
    scans = tuple(_scan(bench, name, scan) for name, scan in measured.scans)
    static = tuple(compare_static(bench, name, record) for name, record in measured.static)
    said = [line for scan in scans for line in _findings(bench, scan)]
    said += [line for record in static for line in findings(record)]
    return MeasuredComparison(scans, static, tuple(said))


def _scan(bench: Bench, name: str, scan: ScanRecord) -> ScanComparison:
    points, count = scan.reading_mm.shape
    moved = after_move(scan, bench.tof.period_s, bench.tof.delay_s)
    return ScanComparison(name, points, count, moved, compare_edge(bench, scan))


def _findings(bench: Bench, scan: ScanComparison) -> list[str]:
    lines = []
    if scan.edge is not None:
        lines += [f"{scan.file}: {line}" for line in _edge_findings(scan.edge)]
    if scan.after_move is not None:
        lines += [f"{scan.file}: {line}" for line in _move_findings(bench, scan.after_move)]
    return lines


def _edge_findings(edge: EdgeComparison) -> list[str]:
    plain, falling = edge.sensor_fit, edge.falling_fit
    real, model, would_be = edge.measured, edge.model, edge.falling
    outshine = (
        ". NOT IN THE MODEL: near things outshine far ones in the cone. It weighs a ray by beam and incidence alone, "
        "so that its ranges at edges are too long and near things look too small"
    )
    better = falling.inner_rms_mm < CLEARLY * plain.inner_rms_mm
    lacking = outshine if better else ": falling light explains the scan no better"
    middle = (
        f"a ball before a board at {edge.board_mm:.0f} mm: the middle of the ball fits the model's mean with "
        f"{plain.inner_rms_mm:.1f} mm rms and a radius of {plain.radius_mm:.0f} mm, and one in which light falls with "
        f"the square of the distance with {falling.inner_rms_mm:.1f} mm and {falling.radius_mm:.0f} mm"
    )
    rim = (
        f"past the edge of that ball of {falling.radius_mm:.0f} mm the real range goes from 10 to 90 % in "
        f"{real.width_10_90_mm:.0f} mm about {real.middle_mm:.0f} mm from its centre; the model takes "
        f"{model.width_10_90_mm:.0f} mm about {model.middle_mm:.0f} mm, with falling light it would take "
        f"{would_be.width_10_90_mm:.0f} mm about {would_be.middle_mm:.0f} mm (the footprint at the rim is "
        f"{edge.rim_footprint_mm:.0f} mm){lacking}"
    )
    return [middle, rim]


def _move_findings(bench: Bench, moved: AfterMove) -> list[str]:
    def row(shares: Sequence[float]) -> str:
        return " ".join(f"{share:.2f}" for share in shares)

    off = max(abs(a - b) for a, b in zip(moved.share_of_way, moved.model_at_device_period, strict=True))
    explains = "a held value explains it" if off <= SHARE_WITHIN else "which explains it not"
    held = (
        f"after {moved.moves} moves, reading by reading, the real range has gone {row(moved.share_of_way)} of its way "
        f"to the new place: the first reading is of the old one in {100 * moved.at_old_place[0]:.0f} %, the second in "
        f"{100 * moved.at_old_place[1]:.0f} %. Read as often (every {moved.poll_s:.2f} s), the model with the "
        f"{DEVICE_PERIOD_S:g} s of the device's profile goes {row(moved.model_at_device_period)}: {explains}. As "
        f"configured ({bench.tof.period_s:g} s, delay {bench.tof.delay_s:g} s) the model goes {row(moved.model)}"
    )
    instant = (
        "NOT IN THE MODEL: its value is the scene at one instant, where the device gathers light for its whole period; "
        "a scan that stands still at each point cannot show by how much that differs"
    )
    return [held, instant]
