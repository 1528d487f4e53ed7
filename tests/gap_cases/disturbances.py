"""How a logger and the day spoil the data of a case, and the families of cases that differ in it.

`narrow` is noise, tolerances and correlation as the nominal file states them, with at most 2 % outliers, each alone.
The wide families use all that the format allows: thresholds may be set on `wide_a`, and are judged on `wide_b`, which
differs in every setting. What a day does is no effect: a program that reports one of these as a cause is wrong, except
for a wrong stated noise and a wandering zero, which have names in the format and are there.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
LONGEST_RUN = 6
CHANNELS = {
    "motor_steady": ("current_A", "omega_rad_s"),
    "motor_step": ("current_A", "omega_rad_s"),
    "tof_bench": ("reading_m",),
    "drive_log": ("tof_front_m", "tof_left_m", "tof_right_m", "x_m", "y_m", "theta_rad"),
}
WANDERS = {
    "motor_steady": ("current_A",),
    "motor_step": ("current_A",),
    "tof_bench": ("reading_m",),
    "drive_log": ("tof_front_m", "tof_left_m", "tof_right_m"),
}
"""Channels whose zero may drift: a counter has none."""
SCALED_NOISE = (
    "current_A",
    "omega_rad_s",
    "polynomial_mm",
    "wheel_speed_rad_s",
    "pose_xy_m",
    "pose_theta_rad",
    "tof_polynomial_mm",
)
LOW_WHEEL_NOISE = 0.75
"""Smallest factor on the noise of wheel speeds: rounding to ticks is most of what is left."""


@dataclass(frozen=True)
class Outliers:
    """Attributes:

    shares: Share of the rows of each channel, by column.
    sigmas: Smallest and largest size, drawn evenly in its logarithm.
    in_runs: Probability that outliers begin a run of 2 to 6 rows.
    sign: -1 or 1 where they are all on one side, else 0.
    together: Whether the channels are hit in the same rows.
    """

    shares: Mapping[str, float]
    sigmas: tuple[float, float]
    in_runs: float
    sign: float
    together: bool

    def struck(self, rng: np.random.Generator, rows: int) -> dict[str, Array]:
        """Error of every row in sigmas, 0 where it is good, by column."""
        found, places = {}, None
        for name, share in self.shares.items():
            if places is None or not self.together:
                places = self._runs(rng, rows, round(share * rows))
            sizes = np.zeros(rows)
            for run in places if share else ():
                sign = self.sign or rng.choice([-1.0, 1.0])
                size = np.exp(rng.uniform(*np.log(self.sigmas)))
                sizes[run] = sign * np.clip(size * rng.uniform(0.8, 1.2, len(run)), *self.sigmas)
            found[name] = sizes
        return found

    def _runs(self, rng: np.random.Generator, rows: int, wanted: int) -> list[Array]:
        free, runs = np.ones(rows, dtype=bool), []
        while wanted > 0:
            length = int(rng.integers(2, LONGEST_RUN + 1)) if rng.random() < self.in_runs else 1
            begin = int(rng.integers(rows))
            run = np.arange(begin, min(begin + min(length, wanted), rows))
            run = run[free[run]]
            if len(run):
                free[run] = False
                runs.append(run)
                wanted -= len(run)
        return runs


@dataclass(frozen=True)
class Day:
    """What is not as the nominal file says, in one case; the default is a case of the narrow family.

    Attributes:
        noise: True over stated standard deviation, by key of `noise` in the nominal file.
        noise_limits: What these factors may be.
        correlation: Of good noise in neighbouring rows; None where it is as stated.
        degrees: Of freedom of Student's t, the shape of good noise; infinite for normal noise.
        tolerance: True over stated tolerance, by parameter.
        tolerance_limit: The largest that this may be.
        wander: Root mean square of a drifting zero in true sigmas, by column.
        clamp_is_last: Whether a limit acts on a reading with its noise; None for what is usual for the limit.
        outliers: None where the logger has a few, each alone.
        seed: Of where outliers are and how zeros drift.
    """

    noise: Mapping[str, float] = field(default_factory=dict)
    noise_limits: tuple[float, float] = (1.0, 1.0)
    correlation: float | None = None
    degrees: float = np.inf
    tolerance: Mapping[str, float] = field(default_factory=dict)
    tolerance_limit: float = 1.0
    wander: Mapping[str, float] = field(default_factory=dict)
    clamp_is_last: bool | None = None
    outliers: Outliers | None = None
    seed: int = 0

    def true(self, nominal: Mapping) -> dict:
        """The nominal file with the noise that the data have."""
        noise = {name: _times(value, self.noise.get(name, 1.0)) for name, value in nominal["noise"].items()}
        if self.correlation is not None:
            noise["lag1_correlation"] = self.correlation
        return {**nominal, "noise": noise}

    def struck(self, rows: int) -> Mapping[str, Array]:
        """Errors of outliers in sigmas by column; no columns in the narrow family."""
        return self.outliers.struck(np.random.default_rng([self.seed, 1]), rows) if self.outliers else {}

    def zero(self, column: str, session: ArrayLike, time_s: Array) -> Array | float:
        """Drift of a channel's zero in sigmas: another value in each session, and a slow wave."""
        level = self.wander.get(column, 0.0)
        if not level:
            return 0.0
        rng = np.random.default_rng([self.seed, 2, *column.encode()])
        number = np.unique(session, return_inverse=True)[1]
        between = rng.standard_normal(number.max() + 1)[number]
        span = max(float(np.ptp(time_s)), 1e-9)
        phase = 2.0 * np.pi * (rng.uniform(0.5, 2.0) * time_s / span + rng.random())
        drift = between + np.sin(phase)
        drift = drift - drift.mean()
        return level * drift / np.sqrt(np.mean(drift**2))


AS_STATED = Day()
"""A day of the narrow family."""


@dataclass(frozen=True)
class Family:
    """Settings from which days and sizes of cases are drawn.

    Attributes:
        few: Share of cases with few rows, by kind.
        some: Share of cases with fewer rows than usual.
        clean: Share of channels without outliers.
        most_outliers: Largest share of rows.
        outlier_sigmas: Smallest and largest size.
        runs: Range of the probability that outliers begin a run.
        together: Probability that several channels are hit in the same rows.
        one_sided: Probability that all outliers have one sign.
        noise: Smallest and largest true over stated noise.
        noise_as_stated: Probability that it is right.
        correlation: Largest that it may be where the file says nothing, and where it states one.
        degrees: Of freedom, one of which is taken.
        tolerance: Smallest and largest true over stated tolerance.
        tolerance_by_parameter: Whether each parameter has a factor of its own.
        wandering: Probability that a zero drifts.
        wander_sigmas: Smallest and largest root mean square.
        two_outside: Probability of two outside effects at once.
    """

    few: Mapping[str, float]
    some: float = 0.0
    is_wide: bool = True
    clean: float = 0.0
    most_outliers: float = 0.0
    outlier_sigmas: tuple[float, float] = (1.0, 1.0)
    runs: tuple[float, float] = (0.0, 0.0)
    together: float = 0.0
    one_sided: float = 0.0
    noise: tuple[float, float] = (1.0, 1.0)
    noise_as_stated: float = 1.0
    correlation: tuple[float, float] = (0.0, 0.0)
    degrees: tuple[float, ...] = (np.inf,)
    tolerance: tuple[float, float] = (1.0, 1.0)
    tolerance_by_parameter: bool = False
    wandering: float = 0.0
    wander_sigmas: tuple[float, float] = (0.0, 0.0)
    two_outside: float = 0.0

    def rows(self, kind: str, chance: float) -> str:
        """How many rows a case has, for a number between 0 and 1."""
        if chance < self.few[kind]:
            return "few"
        return "some" if chance < self.few[kind] + self.some else "usual"

    def day(self, nominal: Mapping, parameters: Sequence[str], rng: np.random.Generator) -> Day:
        """One day; nothing is drawn in the narrow family."""
        if not self.is_wide:
            return AS_STATED
        kind = nominal["kind"]
        common = float(rng.uniform(*self.tolerance))
        own = {name: float(rng.uniform(*self.tolerance)) for name in parameters}
        drifts = rng.random() < self.wandering
        return Day(
            noise={name: self._noise(name, rng) for name in SCALED_NOISE if name in nominal["noise"]},
            noise_limits=(0.5, 2.0),
            correlation=self._correlation(kind, rng),
            degrees=float(rng.choice(self.degrees)),
            tolerance=own if self.tolerance_by_parameter else dict.fromkeys(parameters, common),
            tolerance_limit=self.tolerance[1],
            wander={str(rng.choice(WANDERS[kind])): float(rng.uniform(*self.wander_sigmas))} if drifts else {},
            clamp_is_last=bool(rng.random() < 0.5),
            outliers=self._outliers(kind, rng),
            seed=int(rng.integers(2**31)),
        )

    def _noise(self, name: str, rng: np.random.Generator) -> float:
        factor = float(np.exp(rng.uniform(*np.log(self.noise))))
        factor = 1.0 if rng.random() < self.noise_as_stated else factor
        return max(factor, LOW_WHEEL_NOISE) if name == "wheel_speed_rad_s" else factor

    def _correlation(self, kind: str, rng: np.random.Generator) -> float | None:
        """Rows of a sweep are minutes apart, and those of a drive have a correlation that nobody states."""
        silent, stated = (float(rng.uniform(0.0, most)) for most in self.correlation)
        if kind == "tof_bench":
            return silent if rng.random() < 0.5 else 0.0
        return stated if kind == "motor_step" else None

    def _outliers(self, kind: str, rng: np.random.Generator) -> Outliers:
        share = float(rng.uniform(0.0, self.most_outliers))
        together = bool(rng.random() < self.together)
        shares = {}
        for name in CHANNELS[kind]:
            other = share if together else float(rng.uniform(0.0, self.most_outliers))
            if rng.random() >= self.clean:
                shares[name] = other
        sign = float(rng.choice([-1.0, 1.0])) if rng.random() < self.one_sided else 0.0
        # Channels without any are named too, so that the few of the narrow family do not come in their place.
        shares |= {name: 0.0 for name in CHANNELS[kind] if name not in shares}
        shares = dict(sorted(shares.items(), key=lambda item: -item[1]))
        return Outliers(shares, self.outlier_sigmas, float(rng.uniform(*self.runs)), sign, together)


def _times(value: float | list[float], factor: float) -> float | list[float]:
    return [factor * each for each in value] if isinstance(value, list) else factor * value


FAMILIES: Mapping[str, Family] = {
    "narrow": Family({"motor_steady": 0.25, "motor_step": 0.4, "tof_bench": 0.3, "drive_log": 0.3}, is_wide=False),
    "wide_a": Family(
        {"motor_steady": 0.3, "motor_step": 0.5, "tof_bench": 0.3, "drive_log": 0.5},
        some=0.2,
        clean=0.3,
        most_outliers=0.05,
        outlier_sigmas=(6.0, 25.0),
        runs=(0.0, 0.4),
        together=0.3,
        one_sided=0.25,
        noise=(0.5, 2.0),
        noise_as_stated=0.4,
        correlation=(0.3, 0.5),
        tolerance=(0.7, 1.5),
        wandering=0.25,
        wander_sigmas=(0.3, 0.7),
        two_outside=0.25,
    ),
    "wide_b": Family(
        {"motor_steady": 0.35, "motor_step": 0.5, "tof_bench": 0.35, "drive_log": 0.5},
        some=0.3,
        clean=0.2,
        most_outliers=0.06,
        outlier_sigmas=(4.5, 60.0),
        runs=(0.0, 0.8),
        together=0.4,
        one_sided=0.4,
        noise=(0.5, 2.0),
        noise_as_stated=0.2,
        correlation=(0.4, 0.6),
        degrees=(4.0, 5.0, 6.0, np.inf, np.inf),
        tolerance=(0.7, 1.5),
        tolerance_by_parameter=True,
        wandering=0.35,
        wander_sigmas=(0.3, 1.0),
        two_outside=0.35,
    ),
}
