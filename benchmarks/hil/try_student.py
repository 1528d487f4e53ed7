"""Drive a student.c on the simulated board: the states that it passes through, and how the run ends.

    python benchmarks/hil/try_student.py lesson/student.c [--scenario symolo] [--routes CW,CCW] [--set FIELD=VALUE]

Nothing is drawn or kept; a lap takes some seconds. Exit status 0 where every run closed its lap, 3 where one did not.
"""

import argparse
import itertools
import sys
import tempfile
from pathlib import Path

from configs.draw import draw_run
from configs.loader import load_scenario
from configs.schema.scenario import RunSpec
from hil.board_runner import BoardRunner
from hil.build import build_firmware
from hil.framings import FRAMINGS
from hil.links.lockstep import LockstepLink
from hil.loop import BoardLoop, LoopSettings
from pipeline.stages.simulate import DriveOutcome, simulate
from symolo.core.errors import EnvironmentLacking, InputError, RunFailed

FRAMING = FRAMINGS["framed"]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("student", type=Path)
    parser.add_argument("--scenario", default="symolo")
    parser.add_argument("--routes", default="CW,CCW")
    parser.add_argument("--set", action="append", default=[], metavar="FIELD=VALUE", dest="settings")
    arguments = parser.parse_args()
    try:
        text = arguments.student.read_text(encoding="utf-8")
        loaded = load_scenario(arguments.scenario, arguments.settings)
        specs = [draw_run(loaded, route, 1) for route in arguments.routes.split(",")]
        with tempfile.TemporaryDirectory() as folder:
            outcomes = [driven(spec, text, Path(folder)) for spec in specs]
    except OSError as error:
        print(f"{error.filename or arguments.student}: {error.strerror}", file=sys.stderr)
        return 2
    except (InputError, UnicodeDecodeError) as error:
        print(error, file=sys.stderr)
        return 2
    except RunFailed as error:
        print(error, file=sys.stderr)
        return 3
    except EnvironmentLacking as error:
        print(error, file=sys.stderr)
        return 5
    return 0 if all(outcome.finished for outcome in outcomes) else 3


def driven(spec: RunSpec, student: str, folder: Path) -> DriveOutcome:
    build = build_firmware(spec.robot, "framed", FRAMING.baud, folder, student)
    link = LockstepLink(build.elf, FRAMING.baud)
    loop = BoardLoop.for_robot(link, FRAMING, spec.robot, LoopSettings(1.0 / spec.rates.control_hz))
    try:
        loop.start()
        outcome = simulate(spec, runner=BoardRunner(loop, build.id))
    finally:
        loop.close()
    states = [state for state, _ in itertools.groupby(outcome.recording.trajectory.state.tolist())]
    end = f"lap closed after {outcome.lap_time_s:.2f} s" if outcome.finished else "; ".join(outcome.problems)
    print(f"{spec.route}: states {' '.join(map(str, states))}; {end}")
    return outcome


if __name__ == "__main__":
    sys.exit(main())
