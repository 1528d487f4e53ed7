"""Blind cases with an effect that is in no list, and cases with nothing hidden, given to `diagnose --discover`.

    python -m benchmarks.diagnosis.evaluations.discovery --cases 100 --nothing 60 --seed 606 --out evaluation.jsonl
    python -m benchmarks.diagnosis.evaluations.discovery --kinds motor_step --cases 48 --seed 606 --out steps.jsonl
    python -m benchmarks.diagnosis.evaluations.discovery --kinds drive_log --cases 22 --seed 606 --out drives.jsonl

The cases come from `independent_cases`, whose simulator shares no code with symolo: benches, half of them motors and
half range sensors, step logs of motors, or drives. Each effect outside the list comes about equally often. The results
are written case by case, so that the same command goes on where it was interrupted.

A law has the same structure as the hidden effect if slot, shape, covariates and material agree (`SAME`); its numbers
are not judged. A straight line counts as a power law with an exponent of 0.7 to 1.4.

The share of the gain compares held-out errors in sigmas (root mean square without the largest 3 %): (calibrated -
extended) / (calibrated - true), where `true` are the readings that the generator had before it added noise. It is
judged where the true law gains at least a tenth of the error, by the error that is left beyond the truth.
"""

import argparse
import json
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from benchmarks.diagnosis.independent_cases.case import KINDS, draw_case
from benchmarks.diagnosis.independent_cases.files import write_case
from benchmarks.diagnosis.independent_cases.judge import wilson
from benchmarks.diagnosis.independent_cases.recipes import Array, Variant, variant_of
from benchmarks.diagnosis.independent_cases.setting import Setting
from diagnosis.diagnose import Diagnosis, diagnose
from diagnosis.discovery.discover import OPEN, with_law
from diagnosis.discovery.places import FACING
from diagnosis.importers.choose import read_measurement
from diagnosis.inference.gain import trimmed_rms
from pipeline.diagnosing.importers import IMPORTERS

BENCHES = ("motor_steady", "tof_bench")
EXAMINED = (*BENCHES, "motor_step", "drive_log")
SAME: Mapping[str, tuple[str, str, tuple[str, ...]]] = {
    "friction_bump": ("friction", "bump", ("omega_rad_s",)),
    "parameter_jump Tc": ("friction", "step", ("t_s",)),
    "parameter_jump R": ("resistance", "step", ("t_s",)),
    "parameter_jump K": ("torque_constant", "step", ("t_s",)),
    "current_kink": ("current_reading", "rise", ("current_A",)),
    "sweep_hysteresis": ("friction", "hysteresis", ("voltage_step_V",)),
    "current_dead_zone": ("current_reading", "dead_zone", ("current_A",)),
    "gain_drift current_A": ("current_gain", "line", ("t_s",)),
    "gain_drift omega_rad_s": ("speed_gain", "line", ("t_s",)),
    "winding_memory": ("resistance", "lag", ("u_cmd_V",)),
    "periodic_friction": ("friction", "wave", ("t_s",)),
    "speed_counter_limit": ("speed_reading", "limit", ("omega_rad_s",)),
    "periodic_error": ("range", "wave", ("distance_m",)),
    "memory": ("range", "memory", ("distance_step_m",)),
    "jump": ("range", "step", ("t_s",)),
    "distance_bump": ("range", "bump", ("distance_m",)),
    "scale_drift": ("range", "line", ("t_s", "distance_m")),
    "approach_hysteresis": ("range", "hysteresis", ("distance_step_m",)),
    "near_floor": ("range", "floor", ("distance_m",)),
    "light_bias": ("range", "line", ("ambient_lux",)),
    "material_angle": ("range", "sine_squared", ("incidence_rad",)),
    "coarse_steps": ("range", "rounding", ("distance_m",)),
    "parameter_drift Tc": ("friction", "line", ("t_s",)),
    "parameter_drift R": ("resistance", "line", ("t_s",)),
    "parameter_drift K": ("torque_constant", "line", ("t_s",)),
    "voltage_dead_zone": ("voltage", "dead_zone", ("u_cmd_V",)),
    "driver_limit": ("voltage", "limit", ("u_cmd_V",)),
    "supply_drift": ("supply", "line", ("t_s",)),
    "encoder_eccentricity": ("speed_ripple", "wave", ("angle_rad",)),
    "hum current_A": ("current_error", "wave", ("t_s",)),
    "hum omega_rad_s": ("speed_error", "wave", ("t_s",)),
    "tacho_compression": ("speed_reading", "power", ("omega_rad_s",)),
    "friction_jump": ("friction", "step", ("t_s",)),
    "command_dead_zone": ("voltage", "dead_zone", ("u_V",)),
    "range_periodic": ("range", "wave", ("distance_m",)),
    "range_gain_drift": ("range", "line", ("t_s", "distance_m")),
    "friction_patch": ("friction", "disc", ("x_m", "y_m")),
    "wheel_cogging 1": ("torque", "wave", ("wheel_angle_rad",)),
    "wheel_cogging 2": ("torque", "double_wave", ("wheel_angle_rad",)),
    "wheel_cogging 3": ("torque", "triple_wave", ("wheel_angle_rad",)),
    "slippery_patch": ("travel", "disc", ("x_m", "y_m")),
    "geometry_jump radius": ("travel", "step", ("t_s",)),
    "geometry_jump track": ("turning", "step", ("t_s",)),
    "heading_distortion": ("heading", "double_wave", ("theta_rad",)),
    "glass_wall": ("range", "offset", ()),
    "range_memory": ("range", "memory", ("distance_step_m",)),
}
"""Place, shape and covariates by hidden effect, with the parameter or the channel that it changes, or the number of its
cycles; `t_s` is the time since power-on.
"""
WALLS = tuple(FACING)
"""Walls of a room in the order of the generator: x = 0, x at its end, y = 0, y at its end."""
NEARLY_STRAIGHT = (0.7, 1.4)
MIN_GAIN = 0.1
"""Share of the error that the true law must remove for a share of the gain to be judged."""

Result = dict[str, Any]


def main() -> None:
    """Make and judge the cases, and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=100, help="cases with an effect in no list")
    parser.add_argument("--nothing", type=int, default=60, help="cases with nothing hidden")
    parser.add_argument("--kinds", nargs="+", choices=EXAMINED, default=BENCHES, help="kinds of cases, in turn")
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--always", action="store_true", help="search even where the diagnosis leaves nothing open")
    parser.add_argument("--out", type=Path, required=True, help="file of the results, one line a case")
    args = parser.parse_args()
    results = [json.loads(line) for line in args.out.read_text().splitlines()] if args.out.exists() else []
    known = {result["case"] for result in results}
    with args.out.open("a", encoding="utf-8") as file:
        for case, kind, names in dealt(args.cases, args.nothing, args.kinds):
            if case not in known:
                results.append(judged(case, kind, names, args.seed, always=args.always))
                print(json.dumps(results[-1]), file=file, flush=True)
    for line in figures(results):
        print(line)


def dealt(cases: int, nothing: int, kinds: Sequence[str]) -> Iterator[tuple[str, str, list[str]]]:
    """Yield name, kind and hidden effects of each case, those with nothing hidden evenly among the others."""
    order = [(k / max(cases, 1), "outside", k) for k in range(cases)]
    order += [((k + 0.5) / max(nothing, 1), "none", k) for k in range(nothing)]
    for _, category, k in sorted(order):
        kind = kinds[k % len(kinds)]
        outside = [*KINDS[kind].OUTSIDE, *KINDS[kind].FURTHER]
        names = [outside[(k // len(kinds)) % len(outside)]] if category == "outside" else []
        yield f"{category}_{k + 1:03d}", kind, names


def judged(case: str, kind: str, names: Sequence[str], seed: int, *, always: bool = False) -> Result:
    """Draw one case, diagnose it with a search for a law, and judge the law."""
    category, _, number = case.partition("_")
    rng = np.random.default_rng([seed, EXAMINED.index(kind), category == "none", int(number)])
    try:
        drawn, _ = draw_case(KINDS[kind], category, list(names), rng)
    except RuntimeError as error:  # no setting shows this effect
        return {"case": case, "kind": kind, "hidden": list(names), "skipped": str(error)}
    variant = variant_of(drawn.sized)
    with tempfile.TemporaryDirectory() as folder:
        write_case(Path(folder) / case, drawn.setting.produce(variant, rng))
        measurement = read_measurement(Path(folder) / case, IMPORTERS)
    begin = process_time()
    before = diagnose(measurement)
    middle = process_time()
    diagnosis = with_law(before, always=always)
    after = process_time()
    law, discovery = diagnosis.law, diagnosis.discovery
    return {
        "case": case,
        "kind": kind,
        "hidden": list(names),
        "parameters": variant.outside[0].parameters if variant.outside else {},
        "conclusion": str(diagnosis.conclusion),
        "named": list(diagnosis.names),
        "searched": always or diagnosis.conclusion in OPEN,
        "law": law.form.label if law else "",
        "values": dict(law.values) if law else {},
        "is_curve": law.is_curve if law else False,
        "reason": discovery.reason if discovery else "",
        "is_same": bool(names) and law is not None and is_same(names[0], variant, diagnosis),
        "has_slot": bool(names) and has_slot(names[0], variant),
        "errors": errors(diagnosis, drawn.setting, variant),
        "diagnose_s": middle - begin,
        "discover_s": after - middle,
    }


def has_slot(name: str, variant: Variant) -> bool:
    """Return whether a law in a slot of the simulator can be the hidden effect."""
    return structure(name, variant) in SAME


def structure(name: str, variant: Variant) -> str:
    """Return the name of the hidden effect among those of `SAME`."""
    parameters = variant.outside[0].parameters
    cycles = [f"{parameters['cycles_per_turn']:.0f}"] if "cycles_per_turn" in parameters else []
    return " ".join([name, *(parameters[key] for key in ("parameter", "channel") if key in parameters), *cycles])


def member(variant: Variant) -> str:
    """Return the only wheel, sensor or wall that has the hidden effect; empty for all."""
    parameters = variant.outside[0].parameters
    if "wall" in parameters:
        return WALLS[parameters["wall"]]
    return parameters.get("side", parameters.get("sensor", ""))


def is_same(name: str, variant: Variant, diagnosis: Diagnosis) -> bool:
    """Return whether the law has the structure of the hidden effect."""
    if diagnosis.law is None or not has_slot(name, variant):
        return False
    form, parameters = diagnosis.law.form, variant.outside[0].parameters
    prefix, shape, covariates = SAME[structure(name, variant)]
    is_line = shape == "line" and form.shape == "power"
    low, high = NEARLY_STRAIGHT
    is_line = is_line and low <= diagnosis.law.values["exponent"] <= high
    names = tuple("t_s" if name == "session_time_s" else name for name in form.covariates)
    if (form.shape != shape and not is_line) or names != covariates:
        return False
    is_of_same = form.material == parameters.get("material", "") and form.place.member == member(variant)
    return form.place.prefix == prefix and is_of_same


def errors(diagnosis: Diagnosis, setting: Setting, variant: Variant) -> list[float]:
    """Return the held-out errors in sigmas of the calibrated nominal robot, the extended robot, and the truth.

    There are none for a drive, whose speeds and motions are differences of noisy rows.
    """
    evidence, nominal = diagnosis.measured, diagnosis.selection.nominal
    if not evidence.heldout.any() or setting.KIND == "drive_log":
        return []
    robots = [nominal.robot, diagnosis.extended]
    means = [*evidence.predicted(robots).mean, readings(setting, variant)]
    return [trimmed_rms(np.abs((evidence.values - mean) / evidence.sd)[evidence.heldout]) for mean in means]


def readings(setting: Any, variant: Variant) -> Array:  # noqa: ANN401 - each kind predicts in its own way
    """Return the readings without noise of all rows, one quantity after the other."""
    if setting.KIND == "tof_bench":
        return setting.predict(variant)
    if setting.KIND == "motor_step":
        return np.concatenate([channel[0].ravel() for channel in setting.predict([variant], range(setting.trials))])
    return np.concatenate([channel[0] for channel in setting.predict([variant], setting.t_s, setting.u_V)])


def share_of_gain(result: Result) -> float | None:
    """Return the share of the gain of the true law that the extended robot reaches; None where there is no gain."""
    if result.get("skipped") or not result["errors"]:
        return None
    calibrated, extended, true = result["errors"]
    gain = calibrated - true
    return None if gain < MIN_GAIN * calibrated else (calibrated - extended) / gain


def figures(results: Sequence[Result]) -> Iterator[str]:
    """Yield the lines of the figures."""
    results = [result for result in results if not result.get("skipped")]
    for kind in (*EXAMINED, "all"):
        if kind != "all" and all(each["kind"] != kind for each in results):
            continue
        some = [each for each in results if kind in {each["kind"], "all"}]
        outside, nothing = ([e for e in some if bool(e["hidden"]) == hidden] for hidden in (True, False))
        shares = [share for each in outside if (share := share_of_gain(each)) is not None]
        yield kind
        yield _line("same structure", [each["is_same"] for each in outside])
        yield _line("same structure, of effects with a slot", [e["is_same"] for e in outside if e["has_slot"]])
        yield _line(
            "same structure, of those searched", [e["is_same"] for e in outside if e["has_slot"] and e["searched"]]
        )
        yield _line("a law or a curve", [bool(each["law"]) for each in outside])
        yield _line("of which curves", [each["is_curve"] for each in outside if each["law"]])
        yield _line("at least 90 % of the gain of the true law", [share >= 0.9 for share in shares])
        with_slot = [s for e in outside if e["has_slot"] and (s := share_of_gain(e)) is not None]
        yield _line("the same, of effects with a slot", [share >= 0.9 for share in with_slot])
        yield _line("nothing hidden: a law or a curve", [bool(each["law"]) for each in nothing])
        seconds = [each["discover_s"] for each in some if each["searched"]]
        if seconds:
            yield f"  CPU seconds of a search: median {np.median(seconds):.1f}, at most {max(seconds):.1f}"


def _line(text: str, hits: Sequence[bool]) -> str:
    if not hits:
        return f"  {text:48} none"
    low, high = wilson(sum(hits), len(hits))
    return f"  {text:48} {sum(hits):3d} of {len(hits):3d}  {sum(hits) / len(hits):6.1%}  [{low:.1%}, {high:.1%}]"


if __name__ == "__main__":
    main()
