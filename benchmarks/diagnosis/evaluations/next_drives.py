"""How often a designed drive leaves one right name, beside squares, random arcs and shuttles of the same and more time.

    python -m benchmarks.diagnosis.evaluations.next_drives --cases 200 --seed 711 --seconds 6 --out result.json

The robots come from `independent_cases`, whose simulator shares no code with symolo. Each has one listed effect and
first drives laps of one circle for OLD_S seconds, in one direction and at one speed. Where the diagnosis of this drive
leaves two or more names, the same robot drives again, once for each method to choose the path: as designed, and along
the squares, random arcs and shuttles (straight on, half a turn, straight back) of the generator, for as long and for
three times as long. Each new drive is diagnosed together with the old one. The result is right if the named effects are
the hidden ones, and no name is ambiguous. Errors of markers and clocks belong to a session when two drives are
diagnosed together, so that such effects are counted apart.

    python -m benchmarks.diagnosis.evaluations.next_drives --seed 711 --cases 200 --number 5 --first CASE
    python -m benchmarks.diagnosis.evaluations.next_drives --seed 711 --cases 200 --number 5 --fill next/trial_1

The first of these commands writes the first drive of one robot as a case; the second one drives the commands of a trial
that `symolo next` has designed, and fills its data.csv.
"""

import argparse
import json
import sys
import tempfile
from collections.abc import Iterator, Sequence
from copy import copy
from pathlib import Path

import numpy as np

from benchmarks.diagnosis.evaluations.next_trials import fill, lines_of_groups, read, state
from benchmarks.diagnosis.independent_cases.case import deal_cases, draw_case
from benchmarks.diagnosis.independent_cases.drives.drive_log import DriveSetting
from benchmarks.diagnosis.independent_cases.drives.paths import commands
from benchmarks.diagnosis.independent_cases.drives.wheels import ROW_S
from benchmarks.diagnosis.independent_cases.files import write_case
from benchmarks.diagnosis.independent_cases.recipes import Variant, variant_of
from diagnosis.diagnose import diagnose
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.importers.drive_log import fastest
from diagnosis.inference.evidence.sessions import SESSION_ERRORS
from diagnosis.measured.measurement import Measurement
from diagnosis.next_trial.design import design_trial
from diagnosis.next_trial.limits import Limits, limits_of
from diagnosis.together import together
from symolo.core.errors import InputError
from symolo.core.random_streams import stream

KIND = "drive_log"
OLD_S, SECONDS = 15.0, 15.0
MANOEUVRES = 3
STYLES = {"square": "square", "random arcs": "random", "shuttle": "shuttle"}
METHODS = ("designed", *STYLES, *(f"{style}, 3 times" for style in STYLES))
LISTED = sorted(set(DriveSetting.PLACE) - {"range_wander"})  # its slow error is not looked for in several cases
OF_SESSION = {error.effect.name for error in SESSION_ERRORS}


def driven(setting: DriveSetting, script: np.ndarray, start: np.ndarray, seed: int) -> DriveSetting:
    """Return a setting of the same robot that drives one trial along a script (rows, 2), all for the fit."""
    other = copy(setting)
    other.trials = other.fit_trials = 1  # the generator adds an unseen one
    other.script = np.stack([script, script])
    other.styles = ["", ""]
    other.session_s = np.tile(np.arange(len(script)) * ROW_S, (2, 1))
    other.start = np.stack([start, start])
    other.second_session, other.loop_seed, other.runs = None, seed, []
    return other


def first_drive(setting: DriveSetting, rng: np.random.Generator) -> DriveSetting:
    """Return the setting in which the robot drives laps of one circle, in one direction and at one speed."""
    robot = setting.robot
    speed_m_s = robot.top_speed_m_s * rng.uniform(0.5, 1.0)
    # The circle begins in the middle of the room.
    radius_m = max(0.2 * min(robot.room), speed_m_s / (1.2 * robot.turn_rate_rad_s))
    turn_rad_s = rng.choice([-1.0, 1.0]) * speed_m_s / radius_m
    script = np.tile([speed_m_s, turn_rad_s], (int(OLD_S / ROW_S) + 1, 1))
    return driven(setting, script, setting.start[0], setting.loop_seed)


def limits_in_room(setting: DriveSetting, old: Measurement, seconds: float) -> Limits:
    """Return limits at which the generator's robot does not turn back before a wall."""
    robot = setting.robot
    ahead_m = max(0.0, 0.45 * fastest(old)[0] + 0.02 - 0.2 * robot.track_m)
    size_x, size_y = (max(length_m - 2.0 * ahead_m, 2.5 * robot.track_m) for length_m in robot.room)
    return limits_of(old, seconds=seconds, row_s=seconds / MANOEUVRES, floor_m=(size_x, size_y))


def script_of(trial: Measurement) -> tuple[np.ndarray, np.ndarray]:
    """Return the commands (rows, 2) and the first pose (3,) of a designed drive."""
    (only,) = trial.trials
    script = np.stack([only[name].values for name in ("v_cmd_m_s", "w_cmd_rad_s")], axis=1)
    return script, np.array([only[name].values[0] for name in ("x_m", "y_m", "theta_rad")])


def evaluation(cases: int, seed: int, seconds: float, among: Sequence[str]) -> Iterator[dict]:
    """Yield the result of each case with one of some effects whose first diagnosis leaves two or more names."""
    for number, (category, names, rng) in enumerate(deal_cases(KIND, cases, seed), 1):
        if category != "one" or names[0] not in among:
            continue
        setting, variant = drawn_robot(category, names, rng)
        with tempfile.TemporaryDirectory() as folder:
            old = read(first_drive(setting, rng).produce(variant, rng), "old", Path(folder))
            first = diagnose(old)
            before = state(first, set(names))
            if not before["others"]:
                print(f"{number}: {before['names']} for {names}", file=sys.stderr, flush=True)
                continue
            result = {"case": f"{seed} {number}", "truth": names, "before": before}
            try:
                design = design_trial(first, limits_in_room(setting, old, seconds))
            except InputError as error:
                yield {**result, "refused": str(error)}
                continue
            smallest = design.expected.smallest
            result["models"] = [model.name for model in design.models]
            result["titles"] = design.titles
            result["expected"] = design.expected.one_right
            result["separation"] = None if smallest is None else smallest.separation
            for method in METHODS:
                draws = stream(seed, number, method)
                script, start = script_of(design.trial)
                if method != "designed":
                    rows = int(seconds * (3 if "3 times" in method else 1) / ROW_S) + 1
                    script = commands(draws, rows, STYLES[method.removesuffix(", 3 times")], setting.robot)
                    start = np.array([*start[:2], draws.uniform(-np.pi, np.pi)])
                files = driven(setting, script, start, int(draws.integers(2**31))).produce(variant, draws)
                new = read(files, method.replace(",", "").replace(" ", "_"), Path(folder))
                result[method] = state(diagnose(together([old, new])), set(names))
            yield result


def drawn_robot(category: str, names: list[str], rng: np.random.Generator) -> tuple[DriveSetting, Variant]:
    """Draw the setting and the effects of a case."""
    drawn, _ = draw_case(DriveSetting, category, names, rng)
    if not isinstance(drawn.setting, DriveSetting):
        raise TypeError("a drive has the setting of a drive")
    return drawn.setting, variant_of(drawn.sized)


def drawn_case(cases: int, seed: int, number: int) -> tuple[DriveSetting, Variant, np.random.Generator]:
    """Return the setting, the effects and the random stream of a case; `number` counts from 1."""
    category, names, rng = list(deal_cases(KIND, cases, seed))[number - 1]
    return *drawn_robot(category, names, rng), rng


def write_first(folder: Path, cases: int, seed: int, number: int) -> None:
    """Write the first drive of a robot as a case."""
    setting, variant, rng = drawn_case(cases, seed, number)
    write_case(folder, first_drive(setting, rng).produce(variant, rng))


def drive_files(trial: Path, cases: int, seed: int, number: int) -> object:
    """Return the files of a designed drive with the robot of a case, from the first pose of its path.csv."""
    setting, variant, _ = drawn_case(cases, seed, number)
    (only,) = read_measurement(trial, IMPORTERS).trials
    script = np.stack([only[name].values for name in ("v_cmd_m_s", "w_cmd_rad_s")], axis=1)
    path = np.genfromtxt(trial.parent / "path.csv", delimiter=",", names=True)
    start = np.array([path[name][0] for name in ("x_m", "y_m", "theta_rad")])
    return driven(setting, script, start, number).produce(variant, stream(seed, number, "fill"))


def table(results: list[dict]) -> Iterator[str]:
    """Yield the lines of the table of all cases, and of those with an effect of the robot or of a session."""
    designed = [each for each in results if "refused" not in each]
    yield f"{len(results)} cases with two or more names, {len(designed)} with a trial"
    groups = {
        "effects of the robot": [e for e in designed if not OF_SESSION & set(e["truth"])],
        "of these, separation of at least 3": [
            e for e in designed if not OF_SESSION & set(e["truth"]) and (e["separation"] or 0.0) >= 3.0
        ],
        "effects of a session": [e for e in designed if OF_SESSION & set(e["truth"])],
    }
    yield from lines_of_groups(groups, METHODS)


def main() -> None:
    """Run the evaluation and print its table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=SECONDS, help="time of the new drives, in three manoeuvres")
    parser.add_argument("--effects", nargs="+", choices=LISTED, default=LISTED, help="hidden effects; all by default")
    parser.add_argument("--out", type=Path, help="file for the result of each case")
    parser.add_argument("--number", type=int, default=1, help="case of --first and --fill, from 1")
    parser.add_argument("--first", type=Path, metavar="CASE", help="folder for the first drive of a robot")
    parser.add_argument("--fill", type=Path, metavar="TRIAL", help="trial of symolo next to drive")
    args = parser.parse_args()
    if args.first or args.fill:
        if args.first:
            write_first(args.first, args.cases, args.seed, args.number)
        if args.fill:
            fill(args.fill, drive_files(args.fill, args.cases, args.seed, args.number))
        return
    results = []
    for result in evaluation(args.cases, args.seed, args.seconds, args.effects):
        results.append(result)
        print(json.dumps(result), flush=True)
        if args.out:
            args.out.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    print(*table(results), sep="\n")


if __name__ == "__main__":
    main()
