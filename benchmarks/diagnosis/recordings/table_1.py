"""The paper's Table 1 by regressions of its own, beside what the diagnosis makes of it.

Of the rows that move, u = R i + K w and i = a + b w are straight lines; the first takes one number more for each
mechanism that could bend the speed. What number the bend needs is then held against what a motor of this size can have.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from diagnosis.diagnose import Diagnosis, diagnose
from diagnosis.importers.paper import IMPORTER
from diagnosis.inference.evidence.stuck_rows import stuck_rows
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.selection.refusal import needed
from diagnosis.inference.unexplained.leave_one_out import leave_one_out
from diagnosis.motor_identification import TABLE_1
from physics.effects.driver_and_battery.supply_sag import SupplySag

Array = NDArray[np.float64]
Extra = Callable[[Array, Array, Array], Array]
"""Of voltage, current and speed, (n,) each: what stands beside R i + K w, times the number sought."""

SUPPLY_V = 6.0
"""Of the nominal robot; a source of another voltage needs a resistance in proportion to its square."""
COPPER_PER_K = 0.0039
KELVIN_PER_WATT = (20.0, 60.0)
"""From winding to air, of motors of this size."""


@dataclass(frozen=True)
class Mechanism:
    name: str
    extra: Extra | None
    size: str
    """The number that is needed, in words."""
    verdict: str
    missed_rad_s: float
    """Root mean square error of the speed in rows that were left out."""


def mechanisms() -> list[Mechanism]:
    """Return each mechanism alone beside the two straight lines."""
    rows = [Mechanism("none: the paper's straight lines", None, "", "", _left_out(None))]
    for name, extra, judge in _CANDIDATES:
        number, error = _number(extra)
        size, verdict = judge(number, error)
        rows.append(Mechanism(name, extra, size, verdict, _left_out(extra)))
    return rows


def _moving() -> tuple[Array, Array, Array]:
    rows = TABLE_1.speed_rad_s > 0.0
    return TABLE_1.voltage_V[rows], TABLE_1.current_A[rows], TABLE_1.speed_rad_s[rows]


def _regressors(extra: Extra | None, u: Array, i: Array, w: Array) -> Array:
    return np.stack([i, w, *([extra(u, i, w)] if extra else [])], axis=1)


def _number(extra: Extra) -> tuple[float, float]:
    u, i, w = _moving()
    H = _regressors(extra, u, i, w)
    solution, (squares,), _, _ = np.linalg.lstsq(H, u, rcond=None)
    covariance = np.linalg.inv(H.T @ H) * squares / (len(u) - H.shape[1])
    return float(solution[2]), float(np.sqrt(covariance[2, 2]))


def _left_out(extra: Extra | None) -> float:
    u, i, w = _moving()
    missed = []
    for k in range(len(u)):
        rest = np.arange(len(u)) != k
        volts = np.linalg.lstsq(_regressors(extra, u, i, w)[rest], u[rest], rcond=None)[0]
        slope, begin = np.polyfit(w[rest], i[rest], 1)

        def surplus_V(
            speed: float, k: int = k, volts: Array = volts, slope: float = slope, begin: float = begin
        ) -> float:
            arrays = (np.array([value]) for value in (u[k], begin + slope * speed, speed))
            return float((_regressors(extra, *arrays) @ volts)[0] - u[k])

        missed.append(w[k] - brentq(surplus_V, 0.0, 30.0))
    return float(np.sqrt(np.mean(np.square(missed))))


def _judge_sag(number: float, error: float) -> tuple[str, str]:
    limit = SupplySag.plausible_sizes()["source_resistance_ohm"].high
    lost_V = number * (5.0 / SUPPLY_V) * TABLE_1.current_A[-1]
    return (
        f"{number:.2f} +- {error:.2f} ohm: {lost_V:.2f} V lost at the source at 5 V",
        f"large, since cells and leads have 0.1 to {limit:g} ohm, but not impossible",
    )


def _judge_counts(number: float, error: float) -> tuple[str, str]:
    _, constant = np.linalg.lstsq(np.stack(_moving()[1:], axis=1), _moving()[0], rcond=None)[0]
    top = TABLE_1.speed_rad_s[-1]
    share, spread = number * top / constant, error * top / constant
    per_s = 3840 * top / (2 * np.pi)
    size = f"{100 * share:.1f} +- {100 * spread:.1f} % of the counts"
    return f"{size} at {top:.1f} rad/s, where {per_s:.0f} come in a second", "possible where an interrupt counts them"


def _judge_constant(number: float, error: float) -> tuple[str, str]:
    size, _ = _judge_counts(number, error)
    return (
        f"+{size.split(' of')[0]} from standstill to {TABLE_1.speed_rad_s[-1]:.1f} rad/s",
        "ruled out: current and heat weaken a magnet, nothing strengthens it",
    )


def _judge_heat(number: float, error: float) -> tuple[str, str]:
    u, i, _ = _moving()
    cold, _, rise = np.linalg.lstsq(_regressors(_heat, *_moving()), u, rcond=None)[0]
    kelvin = rise * i[-1] ** 2 / cold / COPPER_PER_K
    watt = (cold + rise * i[-1] ** 2) * i[-1] ** 2
    low, high = (watt * kelvin_per_watt for kelvin_per_watt in KELVIN_PER_WATT)
    return (
        f"{kelvin:.0f} +- {kelvin * error / number:.0f} K warmer at 5 V than cold",
        f"ruled out by size: {watt:.2f} W warm it by {low:.0f} to {high:.0f} K",
    )


def _judge_drop(number: float, error: float) -> tuple[str, str]:
    return f"{number:.2f} +- {error:.2f} V", "ruled out: bends nothing, and would have to add voltage"


def _source(u: Array, i: Array, w: Array) -> Array:
    del w
    return (u / SUPPLY_V) ** 2 * i


def _square(u: Array, i: Array, w: Array) -> Array:
    del u, i
    return w**2


def _heat(u: Array, i: Array, w: Array) -> Array:
    """Return the regressor of a resistance that grows with the power in the winding, i^2."""
    del u, w
    return i**3


def _constant(u: Array, i: Array, w: Array) -> Array:
    del i, w
    return np.ones_like(u)


_CANDIDATES: tuple[tuple[str, Extra, Callable[[float, float], tuple[str, str]]], ...] = (
    ("resistance of the supply", _source, _judge_sag),
    ("counts lost at speed", _square, _judge_counts),
    ("torque constant that grows with speed", _square, _judge_constant),
    ("winding that gets warm", _heat, _judge_heat),
    ("drop of bridge or brushes", _constant, _judge_drop),
)


def drag() -> tuple[float, float, float]:
    """Return drags c w^2 [N m s^2/rad^2]: that which the bent speed needs, and that which the current allows with its
    error."""
    u, i, w = _moving()
    resistance, constant, number = np.linalg.lstsq(_regressors(_square, u, i, w), u, rcond=None)[0]
    H = np.stack([np.ones_like(w), w, w**2], axis=1)
    solution, (squares,), _, _ = np.linalg.lstsq(H, constant * i, rcond=None)
    covariance = np.linalg.inv(H.T @ H) * squares / (len(w) - 3)
    return float(number * constant / resistance), float(solution[2]), float(np.sqrt(covariance[2, 2]))


def table_1() -> str:
    """Return the whole comparison as Markdown."""
    diagnosis = diagnose(IMPORTER.read(Path("table-1")))
    return "\n".join([*diagnosed(diagnosis), "", *_mechanism_table(), "", *_effect_table(diagnosis)])


def diagnosed(diagnosis: Diagnosis) -> list[str]:
    """Return lines with the named effect, the errors of rows left out without and with it, and the stuck rows."""
    rms = {}
    for name, fit in (("before", diagnosis.selection.nominal), ("after", diagnosis.fit)):
        rms[name] = {
            k: float(np.sqrt(np.nanmean(v[1:] ** 2))) for k, v in leave_one_out(diagnosis.evidence, fit).items()
        }
    names = [_sentence(n.name, n.values, n.std, n.comparison.confidence) for n in diagnosis.named]
    lines = [f"The diagnosis is {diagnosis.conclusion} and names {'; '.join(names) or 'nothing'}"]
    lines += [
        f"{quantity}: a row left out is missed by {rms['before'][quantity]:.3g}, then by {rms['after'][quantity]:.3g}"
        for quantity in rms["before"]
    ]
    for row in stuck_rows(diagnosis.measurement, diagnosis.nominal):
        motor = diagnosis.nominal.motor
        lines.append(
            f"row {row.row}, {row.voltage_V:g} V: stands still where the nominal motor turns at "
            f"{row.nominal_speed_rad_s:.2f} rad/s. Friction holds {1e3 * row.holds_N_m:.1f} mN m, "
            f"{row.holds_N_m / motor.coulomb_friction_N_m:.2f} times the Coulomb friction, and less than "
            f"{1e3 * (row.moves_N_m or np.nan):.1f} mN m, with which it moves at {row.moves_at_V:g} V; u / i is "
            f"{row.resistance_ohm:.2f} ohm there, {motor.winding_resistance_ohm:.2f} by the paper's line."
        )
    return lines


def _mechanism_table() -> list[str]:
    lines = ["| mechanism | size it needs | verdict | speed left out [rad/s] |", "|---|---|---|---|"]
    lines += [f"| {m.name} | {m.size} | {m.verdict} | {m.missed_rad_s:.3f} |" for m in mechanisms()]
    needed_drag, allowed_drag, error = drag()
    lines.append(
        f"| drag with the square of speed | {1e6 * needed_drag:.0f}e-6 N m s2/rad2 | ruled out: the current allows "
        f"{1e6 * allowed_drag:.1f} +- {1e6 * error:.1f} of these | - |"
    )
    return lines


def _effect_table(diagnosis: Diagnosis) -> list[str]:
    """Return a table of each effect that the bench can show, alone on the nominal motor."""
    lines = [
        "| effect alone, by the diagnosis | number | fall of the cost | speed left out [rad/s] |",
        "|---|---|---|---|",
    ]
    base = diagnosis.selection.nominal
    for effect in diagnosis.candidates.testable:
        having = base.hypothesis.with_effect(effect)
        start = having.null()
        start[: len(base.x)] = base.x
        begun = start.copy()
        begun[having.parameters(effect)] = [c.start for c in effect.coordinates]
        best = min(fits(diagnosis.evidence, [(having, start), (having, begun)]), key=lambda fit: fit.cost)
        numbers = ", ".join(
            f"{k} {v:.3g} +- {best.std(effect)[k]:.2g}" for k, v in having.values(effect, best.x).items()
        )
        left = float(np.sqrt(np.nanmean(leave_one_out(diagnosis.evidence, best)["omega_rad_s"][1:] ** 2)))
        lines.append(
            f"| {effect.name} | {numbers} | {base.cost - best.cost:.1f} of {needed(effect):.0f} | {left:.3f} |"
        )
    return lines


def _sentence(name: str, values: Mapping[str, float], std: Mapping[str, float], confidence: float) -> str:
    numbers = ", ".join(f"{k} {v:.3g} +- {std[k]:.2g}" for k, v in values.items())
    return f"{name}: {numbers} (confidence {100 * confidence:.0f} %)"


def plot(path: Path) -> None:
    """Plot the deviation of the speed from the straight line of the moving rows, and the effects that explain it."""
    import matplotlib.pyplot as plt  # noqa: PLC0415 - drawing alone needs it

    u, _, w = _moving()
    figure, axes = plt.subplots(figsize=(7.5, 4.2))
    line = np.polyfit(u, w, 1)
    axes.axhline(0.0, color="0.6", lw=1)
    axes.plot(u, 1e3 * (w - np.polyval(line, u)), "o", color="#1b6ca8", label="measured")
    axes.plot(u, 1e3 * np.polyval(np.polyfit(u, w - np.polyval(line, u), 2), u), color="#c2410c", label="parabola")
    axes.set(xlabel="voltage [V]", ylabel="speed less its straight line [mrad/s]", title="Table 1: the speed bows")
    axes.legend(frameon=False)
    figure.tight_layout()
    figure.savefig(path, dpi=120)
    plt.close(figure)


if __name__ == "__main__":
    print(table_1())
