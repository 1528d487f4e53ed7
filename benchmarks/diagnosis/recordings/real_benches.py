"""Motors of a micromouse and a range sensor at rest: fitted on one part of the data, judged on another."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from diagnosis.diagnose import Diagnosis, diagnose
from diagnosis.importers import micromouse
from diagnosis.inference.selection.plausible import beyond
from diagnosis.measured.case_files.nominal import NominalTof
from diagnosis.measured.channel import Channel, Label, Role
from diagnosis.measured.holdout import select_part
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.predictors.motor.steady import MotorSteady
from diagnosis.validation.range_sensor.recordings.static import read_rest_recording
from sensors.ranging.tof import NOISE_AT_NEAR_MM
from symolo.core.tables.time_series import TimeSeries

Array = NDArray[np.float64]

SETS = (3, 5)
"""Of the wheel speeds, those with the battery's voltage: another day, another battery, another way to count."""
SIDES = ("left wheel", "right wheel")


@dataclass(frozen=True)
class Judged:
    on: str
    rows: int
    nominal: float
    calibrated: float
    extended: float
    """Root mean square errors: speeds in rad/s, ranges in mm."""


@dataclass(frozen=True)
class BenchResult:
    name: str
    named: tuple[str, ...]
    withdrawn: tuple[str, ...]
    unexplained: tuple[str, ...]
    impossible: tuple[str, ...]
    """What the fits would need and no robot has."""
    judged: tuple[Judged, ...]


def motors(folder: Path) -> Iterator[BenchResult]:
    """Yield the result of each wheel in each set: fitted on three rows of four, judged on the fourth and on the
    others."""
    sets = {number: micromouse.IMPORTER.read(folder / f"wheelSpeedCalibration{number}.csv") for number in SETS}
    parts = {f"set {number}, {wheel}": select_part(read, wheel) for number, read in sets.items() for wheel in SIDES}
    for name, measurement in parts.items():
        diagnosis = diagnose(measurement)
        robots = (diagnosis.nominal, diagnosis.selection.nominal.robot, diagnosis.extended)
        judged = []
        for other, data in parts.items():
            speeds = MotorSteady(data, diagnosis.nominal)
            (k,) = (k for k, quantity in enumerate(speeds.observed) if quantity.name == "omega_rad_s")
            quantity = speeds.observed[k]
            rows = quantity.usable & (quantity.holdout if other == name else True)
            errors = [_rms(quantity.values[rows] - mean[rows]) for mean in speeds.predict(robots)[k].mean]
            judged.append(Judged("its rows held out" if other == name else other, int(rows.sum()), *errors))
        yield BenchResult(name, *_conclusions(diagnosis), tuple(_faster_than_free(data=measurement)), tuple(judged))


def _faster_than_free(data: Measurement) -> Iterator[str]:
    """Yield rows whose back-EMF alone exceeds the mean voltage, which no friction, resistance or supply can cause."""
    constant = micromouse.nominal_motor().motor.torque_constant_N_m_A.value
    (trial,) = data.trials
    volts, speed = trial["u_cmd_V"].values, np.where(trial["omega_rad_s"].good, trial["omega_rad_s"].values, np.nan)
    share = constant * speed / np.where(volts == 0.0, np.nan, volts)
    beyond_it = np.flatnonzero(share > 1.0)
    if len(beyond_it):
        worst = int(np.nanargmax(share))
        yield (
            f"{len(beyond_it)} of {np.isfinite(share).sum()} rows turn faster than duty times battery drives a motor "
            f"without any friction, at {volts[worst]:.2f} V {share[worst]:.2f} times as fast"
        )


def range_sensor_at_rest(path: Path) -> BenchResult:
    """Return the result for means over a second; the second half of every ten minutes is held out.

    The true distance is not known, only that it stays the same.
    """
    record = read_rest_recording(path)
    rate = round(record.rate_hz)
    seconds = len(record.readings_mm) // rate
    mean_m = 1e-3 * record.readings_mm[: seconds * rate].reshape(seconds, rate)[:, 0]
    t_s = np.arange(float(seconds))
    held = (t_s % 600.0) >= 300.0
    distance_m = np.full(seconds, float(np.median(mean_m[~held])))
    nominal = NominalTof.model_validate(
        {
            "kind": "tof_bench",
            "tof": {
                # The distance is not known: any offset would do.
                "range_offset_m": {"value": 0.0, "tolerance": 0.02},
                "range_scale": {"value": 1.0, "tolerance": 0.03},
                "reference_temperature_C": 25.0,
                "resolution_m": 0.001,
                "reflectance": {"board": 0.9},
            },
            "noise": {"polynomial_mm": [NOISE_AT_NEAR_MM, 4.88, 2.51, 1.15], "polynomial_origin_m": 0.18},
        }
    )
    channels = (
        Channel.logged(TimeSeries("distance_m", "m", t_s, distance_m), Role.INPUT),
        *(
            Channel.logged(TimeSeries(name, unit, t_s, np.full(seconds, np.nan)), Role.INPUT)
            for name, unit in (("incidence_rad", "rad"), ("temperature_C", "C"), ("ambient_lux", "lx"))
        ),
        Channel.logged(
            TimeSeries("reading_m", "m", t_s, mean_m), Role.READING, noise_sd=np.full(seconds, 1e-3 * NOISE_AT_NEAR_MM)
        ),
    )
    trial = Trial("1", t_s, held, channels, (Label("material", ("board",) * seconds),), begins_s=0.0)
    diagnosis = diagnose(
        Measurement(
            path.stem, CaseKind.TOF_BENCH, MeasurementSource("VL53L0X at rest", (str(path),)), (trial,), nominal
        )
    )
    evidence = diagnosis.measured
    robots = (diagnosis.nominal, diagnosis.selection.nominal.robot, diagnosis.extended)
    errors = [1e3 * _rms((evidence.values - mean)[evidence.heldout]) for mean in evidence.predicted(robots).mean]
    judged = Judged("held out, mm", int(evidence.heldout.sum()), *errors)
    return BenchResult(f"{path.stem}, one reading a second", *_conclusions(diagnosis), (), (judged,))


def _conclusions(diagnosis: Diagnosis) -> tuple[tuple[str, ...], tuple[str, ...], tuple[str, ...]]:
    named = []
    for n in diagnosis.named:
        numbers = ", ".join(f"{k} {v:.3g} +- {n.std[k]:.2g}" for k, v in n.values.items())
        too_large = [f"; impossible: {b.why}" for b in beyond(n.effect.kind, n.values, n.std)]
        named.append(f"{n.effect.name} ({numbers}; confidence {n.comparison.confidence:.2f}{''.join(too_large)})")
    if (slow := diagnosis.random_drift) is not None:
        numbers = ", ".join(f"{k} {v:.3g} +- {slow.std[k]:.2g}" for k, v in slow.effect.model_dump().items())
        named.append(f"{slow.effect.name} ({numbers}; confidence {slow.confidence:.2f})")
    left = diagnosis.adequacy.structures[:1] if diagnosis.unexplained else ()
    return tuple(named), diagnosis.withdrawn, tuple(f"{s.observed} along {s.covariate} (p {s.p:.0e})" for s in left)


def _rms(errors: Array | Sequence[float]) -> float:
    return float(np.sqrt(np.mean(np.square(errors))))
