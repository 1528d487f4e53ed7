"""The OptiOdom robot: fitted on some runs, judged on others, by the diagnosis and by usual calibrations."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from wheel_calibrations import Wheels, by_whole_paths, odometry, turned, umbmark, with_turned_camera

from configs.draw import draw_robot
from configs.effects.registry import EFFECTS
from configs.loader import load_section
from configs.schema.robot import RobotConfig
from diagnosis.diagnose import Diagnosis, diagnose
from diagnosis.importers.optiodom import ENCODER_TICKS_PER_REVOLUTION, IMPORTER, TRACK_M, WHEEL_DIAMETER_M
from diagnosis.inference.evidence.whole_runs import WholeRunFit, fitted_to_whole_runs
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis, deviated
from diagnosis.measured.measurement import Measurement
from diagnosis.nominal_robot import nominal_robot
from diagnosis.nuisances import nuisances
from diagnosis.predictors.pose.by_counts import Pose

Array = NDArray[np.float64]

KINDS = ("square", "circular", "ivanjko")
METHODS = ("nominal", "umbmark", "whole paths", "windows", "extended", "and camera")
"""`whole paths` is the authors' kind of calibration; `windows` is the diagnosis as its windows leave it, `extended`
with its numbers fitted to whole runs; `and camera` a calibration by whole paths that may turn the camera's body too."""
NOMINAL = Wheels(WHEEL_DIAMETER_M, WHEEL_DIAMETER_M, TRACK_M)
COUNTS = ENCODER_TICKS_PER_REVOLUTION
FEWEST_RUNS = 6
"""Of a session that is fitted."""


@dataclass(frozen=True)
class Missed:
    """The end of one run, predicted from its first pose and its counts, against the camera."""

    run: str
    length_m: float
    place_m: float
    heading_rad: float


@dataclass(frozen=True)
class Fitted:
    name: str
    """Session or kind of path."""
    fitted_runs: int
    named: tuple[str, ...]
    """With numbers, errors and confidence."""
    withdrawn: tuple[str, ...]
    unexplained: tuple[str, ...]
    numbers: tuple[str, ...]
    """The nominal parameters as fitted to whole runs."""
    windows: str
    """Error of held-out windows before and after, in sigmas."""
    missed: Mapping[str, Mapping[str, tuple[Missed, ...]]]
    """Errors of each method, by the judged quantity and by the method."""


def fitted_drives(folder: Path) -> Iterator[Fitted]:
    """Yield the fits of each session, of each kind of path, and of all together; each kind has a folder."""
    sessions = sorted(path for kind in KINDS for path in (folder / kind).iterdir() if path.is_dir())
    for path in (*sessions, *(folder / kind for kind in KINDS)):
        measurement = IMPORTER.read(path)
        if len(measurement.trials) >= FEWEST_RUNS:
            others = [IMPORTER.read(folder / kind) for kind in KINDS if kind != path.name] if path.name in KINDS else []
            yield _fitted(path, measurement, others)
    yield _all_together(folder)


def left_out_sessions(folder: Path) -> Iterator[Fitted]:
    """Yield each session, judged by models that were fitted to the whole runs of all other sessions of its kind."""
    for kind in KINDS:
        measurement = IMPORTER.read(folder / kind)
        if measurement.nominal is None:
            raise ValueError(measurement.name)
        nominal = nominal_robot(measurement.nominal, draw_robot(load_section("robot", "nominal"), 0, "real sets")[0])
        for session in sorted({trial.session for trial in measurement.trials}):
            out = [trial.session == session for trial in measurement.trials]
            split = replace(
                measurement,
                trials=tuple(
                    replace(trial, holdout=np.full(len(trial.t_s), is_out))
                    for trial, is_out in zip(measurement.trials, out, strict=True)
                ),
            )
            bare = Hypothesis(nominal, nuisances(measurement.nominal))
            whole = fitted_to_whole_runs(split, bare, bare.null(), ())
            fit = _split(split)[1]
            wheels = {"nominal": NOMINAL, "whole paths": by_whole_paths(fit, NOMINAL, COUNTS)}
            judge = _Judge(
                nominal, wheels, with_turned_camera(fit, NOMINAL, COUNTS), {"extended": whole.robot} if whole else {}
            )
            missed = {"left out": judge.missed(split, out)}
            yield Fitted(f"{kind}/{session}", len(fit), (), (), (), _numbers(whole), "-", missed)


def _fitted(path: Path, measurement: Measurement, others: Sequence[Measurement]) -> Fitted:
    kind = path.name if path.name in KINDS else path.parent.name
    diagnosis = diagnose(measurement)
    whole = fitted_to_whole_runs(measurement, diagnosis.fit.hypothesis, diagnosis.fit.x, diagnosis.candidates.testable)
    held, fit = _split(measurement)
    wheels = {"nominal": NOMINAL, "whole paths": by_whole_paths(fit, NOMINAL, COUNTS)}
    if kind == "square":
        wheels["umbmark"] = _umbmark([Path(f) for f, h in zip(measurement.source.files, held, strict=True) if not h])
    askew = with_turned_camera(fit, NOMINAL, COUNTS)
    robots = {"windows": diagnosis.extended} | ({"extended": whole.robot} if whole else {})
    judge = _Judge(diagnosis.nominal, wheels, askew, robots)
    return Fitted(
        name=f"{kind}/{path.name}" if path.name != kind else kind,
        fitted_runs=len(fit),
        named=_named(diagnosis, whole),
        withdrawn=diagnosis.withdrawn,
        unexplained=_unexplained(diagnosis),
        numbers=(*_numbers(whole), f"camera's heading off by {1e3 * askew[1]:.1f} mrad (calibration with it)"),
        windows=f"{diagnosis.gain.before:.3f} -> {diagnosis.gain.after:.3f}" if diagnosis.gain else "-",
        missed={"held out": judge.missed(measurement, held)}
        | {o.name: judge.missed(o, [True] * len(o.trials)) for o in others},
    )


def _all_together(folder: Path) -> Fitted:
    """Whole runs of all kinds at once, which show more than one kind of path alone; windows are left out."""
    measurement = IMPORTER.read(folder)
    if measurement.nominal is None:
        raise ValueError(measurement.name)
    nominal = nominal_robot(measurement.nominal, draw_robot(load_section("robot", "nominal"), 0, "real sets")[0])
    bare = Hypothesis(nominal, nuisances(measurement.nominal))
    effects = [
        CandidateEffect(effect, choices) for effect in EFFECTS.classes() for choices in _WHOLE_RUN.get(effect.name, ())
    ]
    whole = fitted_to_whole_runs(measurement, bare, bare.null(), effects)
    held, fit = _split(measurement)
    wheels = {"nominal": NOMINAL, "whole paths": by_whole_paths(fit, NOMINAL, COUNTS)}
    askew = with_turned_camera(fit, NOMINAL, COUNTS)
    judge = _Judge(nominal, wheels, askew, {"extended": whole.robot} if whole else {})
    by_kind = {
        kind: [h and t.name.startswith(kind) for h, t in zip(held, measurement.trials, strict=True)] for kind in KINDS
    }
    return Fitted(
        name="all together",
        fitted_runs=len(fit),
        named=_named(None, whole),
        withdrawn=(),
        unexplained=(),
        numbers=(*_numbers(whole), f"camera's heading off by {1e3 * askew[1]:.1f} mrad (calibration with it)"),
        windows="-",
        missed={"held out": judge.missed(measurement, held)}
        | {f"{kind}, held out": judge.missed(measurement, chosen) for kind, chosen in by_kind.items()},
    )


_SIDES = ((("side", "left"),), (("side", "right"),))
_WHOLE_RUN: Mapping[str, tuple[tuple[tuple[str, str], ...], ...]] = {
    "wheel_radius_asymmetry": ((),),
    "wheelbase_scale": ((),),
    "turn_slip": ((),),
    "marker_offset": ((),),
    "pose_time_offset": ((),),
    "encoder_missed_ticks": _SIDES,
}
"""Effects that move a pose, with their choices; a scale of both radii or of the counts is in the nominal parameters."""


def _split(measurement: Measurement) -> tuple[list[bool], list[Array]]:
    """Which trials are held out, and the runs that are not."""
    held = [bool(trial.holdout.all()) for trial in measurement.trials]
    return held, [_run(Path(f)) for f, is_held in zip(measurement.source.files, held, strict=True) if not is_held]


@dataclass(frozen=True)
class _Judge:
    nominal: RobotConfig
    wheels: Mapping[str, Wheels]
    askew: tuple[Wheels, float]
    robots: Mapping[str, RobotConfig]

    def missed(self, judged: Measurement, chosen: Sequence[bool]) -> Mapping[str, tuple[Missed, ...]]:
        """Return the errors of each method at the ends of the chosen runs."""
        names = [trial.name for trial, is_in in zip(judged.trials, chosen, strict=True) if is_in]
        raw = [_run(Path(f)) for f, is_in in zip(judged.source.files, chosen, strict=True) if is_in]
        ends = {name: [odometry(run, w, COUNTS)[-1] for run in raw] for name, w in self.wheels.items()}
        ends["and camera"] = [turned(odometry(run, self.askew[0], COUNTS), self.askew[1])[-1] for run in raw]
        for name, robot in self.robots.items():
            predicted = _ends(judged, robot, self.nominal)
            ends[name] = [end for end, is_in in zip(predicted, chosen, strict=True) if is_in]
        return {
            method: tuple(_missed(n, run, end) for n, run, end in zip(names, raw, ends[method], strict=True))
            for method in METHODS
            if method in ends
        }


def _run(path: Path) -> Array:
    return np.loadtxt(path, delimiter=",", encoding="utf-8-sig")


def _umbmark(files: Sequence[Path]) -> Wheels:
    """Return the mean of the calibrations of all sessions, each from the wheels that its controller assumed."""
    calibrated = []
    for session in sorted({file.parent for file in files}):
        (metadata,) = session.glob("*_metadata.csv")
        rows = dict(line.split(",", 1) for line in metadata.read_text(encoding="utf-8-sig").splitlines())
        track_m, side_m = (float(rows[key].split(",")[0]) for key in ("Li", "L"))
        left_m, right_m = (float(cell) for cell in rows["Di"].split(",")[:2])
        runs = [_run(file) for file in files if file.parent == session]
        w = umbmark(runs, side_m, Wheels(left_m, right_m, track_m), COUNTS)
        # Closed form and counts know the wheels up to a common factor, which is taken to be the nominal size.
        scale = 2.0 * WHEEL_DIAMETER_M / (w.left_diameter_m + w.right_diameter_m)
        calibrated.append([scale * w.left_diameter_m, scale * w.right_diameter_m, scale * w.track_m])
    return Wheels(*np.mean(calibrated, axis=0).tolist())


def _ends(measurement: Measurement, robot: RobotConfig, nominal: RobotConfig) -> list[Array]:
    starts = np.array([[trial[n].values[0] for n in ("x_m", "y_m", "theta_rad")] for trial in measurement.trials])
    last = np.cumsum([len(trial.t_s) for trial in measurement.trials]) - 1
    return list(Pose(measurement, nominal).path(robot, starts)[last])


def _missed(name: str, run: Array, end: Array) -> Missed:
    off = end - run[-1, 1:4]
    length_m = float(np.hypot(*np.diff(run[::10, 1:3], axis=0).T).sum())
    return Missed(name, length_m, float(np.hypot(off[0], off[1])), float(off[2]))


def _named(diagnosis: Diagnosis | None, whole: WholeRunFit | None) -> tuple[str, ...]:
    sentences = []
    for named in diagnosis.named if diagnosis else ():
        numbers = ", ".join(f"{n} {v:.4g} +- {named.std[n]:.1g}" for n, v in named.values.items())
        sentences.append(f"{named.effect.name} ({numbers}; confidence {named.comparison.confidence:.2f})")
    known = {named.effect.name for named in diagnosis.named} if diagnosis else set()
    for effect in whole.hypothesis.effects if whole else ():
        if effect.name not in known and whole:
            values, std = whole.hypothesis.values(effect, whole.x), whole.std(effect)
            numbers = ", ".join(f"{n} {v:.4g} +- {std[n]:.1g}" for n, v in values.items())
            sentences.append(f"{effect.name} ({numbers}; by whole runs)")
    return tuple(sentences)


def _unexplained(diagnosis: Diagnosis) -> tuple[str, ...]:
    best = {}
    for structure in diagnosis.adequacy.structures if diagnosis.unexplained else ():
        if structure.p < 1e-3:
            best.setdefault(structure.observed, f"{structure.observed} along {structure.covariate} ({structure.what})")
    return tuple(best.values())


def _numbers(whole: WholeRunFit | None) -> tuple[str, ...]:
    if whole is None:
        return ()
    errors = np.sqrt(np.diag(whole.covariance)).tolist()
    sentences = []
    for nuisance, x, error in zip(whole.hypothesis.nuisances, whole.x.tolist(), errors, strict=False):
        value = deviated(nuisance, x)
        sentences.append(
            f"{nuisance.name} {value:.6f} +- {error * nuisance.tolerance:.6f} (nominal {nuisance.value:g})"
        )
    return tuple(sentences)
