"""Change single places of the core modules and list the changes that no test notices: `python benchmarks/mutations.py`.

    python benchmarks/mutations.py [MODULE ...] [--number 500] [--seed 0] [--table mutations.csv] [--again]

The changes are those of cosmic-ray (`pip install cosmic-ray`), and a number may become half as large again. A place is
drawn, then one of its changes. Annotations of types are left alone, since every change of them is noticed on import.
Each change is judged in a copy of the tree by the tests that `TESTS` names for its module, in one process, until the
first test fails. cosmic-ray's own command would run the same tests for all modules, after a start of Python and of all
libraries for each change; here a process that has loaded them is forked.

The table has one line for each change, written as soon as it is judged; the same command goes on where it stopped.
`--again` judges the survivors once more, for instance after tests were added. A change that no test can notice is
listed with its reason in `mutations_equivalent.yaml`.
"""

import argparse
import csv
import gc
import importlib
import json
import math
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import grimp
import yaml
from cosmic_ray.mutating import mutate_code  # pyright: ignore[reportMissingImports]
from drawn_mutations import Mutation, drawn_mutations, operators_by_name

ROOT = Path(__file__).parents[1]
EQUIVALENT = Path(__file__).with_name("mutations_equivalent.yaml")
PACKAGES = ("symolo", "configs", "logs", "physics", "sensors", "hil", "diagnosis", "blender_scenes", "pipeline")
MOTOR = "tests/physics/drivetrain/test_motor.py"
ARENAS = "tests/configs/test_arena_generation.py"
CHECKS = (
    "tests/configs/test_limits.py",
    "tests/configs/test_motor_strength.py",
    "tests/configs/test_bad_input.py",
    "tests/configs/test_draw.py",
    "tests/configs/test_splits.py",
    f"{ARENAS}::test_a_recipe_and_a_line_of_its_own_do_not_go_together",
)
INFERENCE = "tests/diagnosis/inference"
TESTS = {
    "sensors/ranging/tof.py": (
        "tests/sensors/ranging/test_tof.py",
        "tests/sensors/test_effects.py",
        "tests/sensors/ranging/test_range_over_time.py",
    ),
    "physics/drivetrain/motor.py": (MOTOR, "tests/physics/drivetrain/test_motor_energy.py"),
    "physics/drivetrain/wheel_loop.py": ("tests/physics/drivetrain/test_wheel_loop.py",),
    "physics/control/following.py": ("tests/physics/control/test_following.py",),
    "physics/control/transitions.py": ("tests/physics/control/test_transitions.py",),
    "physics/control/conditions.py": (
        "tests/physics/control/test_conditions.py",
        "tests/physics/control/test_controller.py",
    ),
    "symolo/dataset/tables/rows.py": ("tests/symolo/dataset/test_tables.py",),
    "symolo/core/distributions.py": (
        "tests/symolo/core/test_distributions.py",
        "tests/configs/test_bad_input.py",
        "tests/symolo/report/test_draws.py::test_a_distribution_in_words",
    ),
    "configs/checks/arena.py": CHECKS,
    "configs/checks/look.py": CHECKS,
    "configs/checks/robot.py": CHECKS,
    "configs/checks/motor_strength.py": CHECKS,
    "configs/checks/scenario.py": CHECKS,
    "configs/draw.py": (
        "tests/configs/test_draw.py",
        "tests/configs/test_posterior.py",
        f"{ARENAS}::test_the_line_passes_the_start_that_is_given_and_otherwise_the_origin_along_x",
        f"{ARENAS}::test_the_specification_holds_the_arena_and_no_recipe",
        f"{ARENAS}::test_the_line_lies_where_the_route_starts_whatever_the_scenario",
        f"{ARENAS}::test_the_line_passes_a_start_that_is_one_of_several_places_and_not_between_them",
        f"{ARENAS}::test_ranges_for_which_no_arena_fits_are_refused_with_the_reason",
    ),
    "sensors/camera/metering.py": ("tests/sensors/camera/test_response.py",),
    "sensors/camera/response.py": ("tests/sensors/camera/test_response.py", "tests/sensors/camera/test_mosaic.py"),
    "symolo/core/geometry/pinhole.py": ("tests/sensors/camera/test_pinhole.py", "tests/symolo/core/test_fisheye.py"),
    "diagnosis/inference/gain.py": (f"{INFERENCE}/test_gain.py",),
    "diagnosis/inference/selection/refusal.py": (
        f"{INFERENCE}/selection/test_refusal.py",
        f"{INFERENCE}/selection/test_selection_steps.py",
        f"{INFERENCE}/selection/test_selection_rules.py",
        f"{INFERENCE}/selection/test_at_bound.py",
    ),
    "diagnosis/inference/selection/stepwise.py": (
        f"{INFERENCE}/selection/test_selection_steps.py",
        f"{INFERENCE}/selection/test_selection_rules.py",
        f"{INFERENCE}/selection/test_selection.py",
    ),
}
"""Tests that judge the changes of a module: those of its own package that are about it."""
SPARE_SECONDS = 20.0
"""Of the processor, beyond three times those of the unchanged tests; then a change that makes an endless loop counts as
noticed."""
WAITING = 20
"""Times its limit on the processor that a process may take by the clock, as it does on a machine with other work."""
MEMORY_BYTES = 8 << 30
SURVIVED, CAUGHT, ENDLESS, UNIMPORTABLE = "survived", "caught", "endless", "unimportable"


TYPES = {str: str, int: int, float: float}


@dataclass(frozen=True)
class Row(Mutation):
    """One line of the table."""

    before: str
    """The line."""
    after: str
    outcome: str
    seconds: float

    @property
    def mutation(self) -> Mutation:
        return Mutation(*(getattr(self, field.name) for field in fields(Mutation)))


def main() -> int:
    options = _options()
    drawn = list(drawn_mutations(options.modules or list(TESTS), options.number, options.seed))
    rows = {row.mutation: row for row in _read(options.table)}
    judged = {m for m, row in rows.items() if not (options.again and row.outcome == SURVIVED)}
    failed = 0
    with tempfile.TemporaryDirectory(prefix="symolo-mutations-") as folder:
        tree = _copy(Path(folder))
        sys.path.insert(0, str(tree))
        graph = grimp.build_graph(*PACKAGES, cache_dir=None)
        for module in TESTS:
            left = [mutation for mutation in drawn if mutation.module == module and mutation not in judged]
            if left:
                failed |= _forked(
                    lambda module=module, left=left: _judge_module(tree, graph, module, left, options.table)
                )
    if failed:
        return 1
    rows = {row.mutation: row for row in _read(options.table)}
    _print([rows[mutation] for mutation in drawn])
    return 0


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("modules", nargs="*", metavar="MODULE", help=f"all by default: {', '.join(TESTS)}")
    parser.add_argument("--number", type=int, default=500, help="of changes, over all modules")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--table", type=Path, default=Path("mutations.csv"))
    parser.add_argument("--again", action="store_true", help="judge the survivors in the table once more")
    options = parser.parse_args()
    options.table = options.table.absolute()
    if unknown := set(options.modules) - set(TESTS):
        parser.error(f"no tests are named for {', '.join(sorted(unknown))}; there are {', '.join(TESTS)}")
    return options


def _difference(text: str, changed: str) -> tuple[str, str]:
    """Return the first line that differs, before and after the change."""
    both = ([line.strip() for line in lines.splitlines() if line.strip()] for lines in (text, changed))
    return next((pair for pair in zip(*both, strict=False) if pair[0] != pair[1]), ("", ""))


def _copy(folder: Path) -> Path:
    """Copy the files that git knows or would add, without large ones that no test of `TESTS` reads."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],  # noqa: S607
        cwd=ROOT,
        capture_output=True,
        check=True,
    )
    tree = folder / "tree"
    for name in filter(None, listed.stdout.decode().split("\0")):
        if (ROOT / name).is_file():
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / name, tree / name)
    (folder / "tmp").mkdir()
    return tree


def _judge_module(tree: Path, graph: grimp.ImportGraph, module: str, mutations: list[Mutation], table: Path) -> int:
    """Judge changes of one module, in a process of its own, and append them to the table."""
    os.chdir(tree)
    os.environ |= {"PYTHONPATH": str(tree), "TMPDIR": str(tree.parent / "tmp"), "PYTHONDONTWRITEBYTECODE": "1"}
    name = module.removesuffix(".py").replace("/", ".")
    loaded, durations = tree.parent / "loaded", tree.parent / f"{name}.json"
    collected = not _forked(lambda: _collect(module, loaded), 600.0)
    sys.dont_write_bytecode = True
    for stale in (tree / module).parent.glob(f"__pycache__/{Path(module).stem}.*"):
        stale.unlink()
    if collected:
        _preload(loaded.read_text().split(), {name, *graph.find_downstream_modules(name)})
    begin = _processor_s()
    if not collected or name in sys.modules or _forked(lambda: _tests(module, durations), 600.0):
        print(f"{module}: its tests cannot be collected, or fail before any change", file=sys.stderr)
        return 1
    seconds = _processor_s() - begin
    gc.freeze()  # a collection in a child would copy all of it
    text = (tree / module).read_text()
    operators = operators_by_name()
    for mutation in mutations:
        begin = _processor_s()
        changed = mutate_code(text, operators[mutation.operator], mutation.occurrence) or text
        (tree / module).write_text(changed)
        if _forked(lambda: importlib.import_module(name) is None, SPARE_SECONDS):
            outcome = UNIMPORTABLE
        else:
            code = _forked(lambda: _tests(module, durations), SPARE_SECONDS + 3 * seconds)
            outcome = {0: SURVIVED, -signal.SIGKILL: ENDLESS}.get(code, CAUGHT)
        before, after = _difference(text, changed)
        took = round(_processor_s() - begin, 1)
        _append(table, Row(**asdict(mutation), before=before, after=after, outcome=outcome, seconds=took))
    (tree / module).write_text(text)
    return 0


class QuickestFirst:
    """A plugin of pytest that sorts tests by the time that they took before."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._seconds = defaultdict(float, json.loads(path.read_text()) if path.is_file() else {})

    def pytest_collection_modifyitems(self, items: list) -> None:
        items.sort(key=lambda item: self._seconds[item.nodeid])

    def pytest_runtest_logreport(self, report) -> None:  # noqa: ANN001 - pytest is not needed to draw
        self._seconds[report.nodeid] += report.duration

    def pytest_sessionfinish(self) -> None:
        if not self._path.is_file():
            self._path.write_text(json.dumps(self._seconds))


def _collect(module: str, loaded: Path) -> int:
    """Collect the tests of a module, and write the names of all that was imported."""
    code = _pytest(["--collect-only", *TESTS[module]])
    loaded.write_text("\n".join(sys.modules))
    return code


def _tests(module: str, seconds: Path) -> int:
    return _pytest(["-x", *TESTS[module]], [QuickestFirst(seconds)])


def _pytest(arguments: list[str], plugins: Sequence[object] = ()) -> int:
    import pytest  # noqa: PLC0415 - not needed to draw

    # pytest warns that it can no longer rewrite plugins that are loaded, and a warning is an error here.
    settings = ["-q", "-n", "0", "-p", "no:cacheprovider", "-W", "ignore::pytest.PytestAssertRewriteWarning"]
    settings += ["-p", "no:tests.release_fixtures", f"--basetemp={os.environ['TMPDIR']}/t"]
    return int(pytest.main([*settings, *arguments], plugins=plugins))


def _preload(names: list[str], later: set[str]) -> None:
    """Import what the tests import, except the changed module and all that import it."""
    for name in names:
        is_ours = name.partition(".")[0] in PACKAGES
        if name not in later and (is_ours or not name.startswith(("tests", "conftest", "test_", "__"))):
            try:
                importlib.import_module(name)
            except Exception:  # noqa: BLE001, S112 - some modules can be imported by their library alone
                continue


def _processor_s() -> float:
    """Return the processor time of all children that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _forked(work: Callable[[], int], limit_s: float = float("inf")) -> int:
    """Return the exit code of some work in a child, -SIGKILL after so much time of the processor."""
    sys.stdout.flush()
    child = os.fork()
    if child == 0:
        code = 1
        try:
            if limit_s < float("inf"):
                os.setsid()
                resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
                resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(limit_s), math.ceil(limit_s)))
                sink = os.open(os.devnull, os.O_RDWR)
                for stream in (0, 1, 2):
                    os.dup2(sink, stream)
            code = int(work())
        finally:
            os._exit(code)
    ends = time.monotonic() + WAITING * limit_s
    while time.monotonic() < ends:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.01)
    os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return -signal.SIGKILL


def _read(table: Path) -> Iterator[Row]:
    if table.is_file():
        with table.open(newline="") as file:
            for row in csv.DictReader(file):
                yield Row(*(TYPES[field.type](row[field.name]) for field in fields(Row)))


def _append(table: Path, row: Row) -> None:
    is_new = not table.is_file()
    with table.open("a", newline="") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(Row)])
        if is_new:
            writer.writeheader()
        writer.writerow(asdict(row))


def _print(rows: list[Row]) -> None:
    """Print the survivors, and how many changes of each module were noticed."""
    listed = yaml.safe_load(EQUIVALENT.read_text()) or ()
    table = [["module", "changes", "noticed", "equivalent", "survived"]]
    total = [0, 0, 0, 0]
    for module in TESTS:
        module_rows = [row for row in rows if row.module == module and row.outcome != UNIMPORTABLE]
        survivors = [row for row in module_rows if row.outcome == SURVIVED]
        real = [row for row in survivors if not any(_is_equivalent(row, entry) for entry in listed)]
        for row in real:
            print(f"{row.module}:{row.line}\n    - {row.before}\n    + {row.after}")
        counts = [len(module_rows), len(module_rows) - len(survivors), len(survivors) - len(real), len(real)]
        total = [sum(pair) for pair in zip(total, counts, strict=True)]
        table.append([module, *map(str, counts)])
    for module, *counts in [*table, ["all", *map(str, total)]]:
        print(f"{module:36}" + "".join(f"{count:>12}" for count in counts))
    unimportable = sum(row.outcome == UNIMPORTABLE for row in rows)
    share, without = (100 * total[1] / max(1, count) for count in (total[0], total[1] + total[3]))
    print(f"noticed: {share:.1f} %, without equivalent ones {without:.1f} %; {unimportable} more cannot be imported")


def _is_equivalent(row: Row, entry: dict[str, str]) -> bool:
    return (
        entry.get("module", row.module) == row.module
        and row.before.replace(entry["before"], entry["after"]) == row.after
    )


if __name__ == "__main__":
    sys.exit(main())
