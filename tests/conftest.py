"""What tests need of the machine, and fixtures that several packages' tests share."""

import os

# There is a process of tests for each core, and threads of a matrix product that wait for each other only get in the
# way of the others. OpenBLAS reads this when it is loaded, and the processes that tests start inherit it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Tests start hundreds of processes. Where this is set, as in many containers, each of them compiles all modules again.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

import gc
import shutil
import signal
import subprocess
from collections.abc import Callable, Generator
from dataclasses import FrozenInstanceError, fields
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from _pytest.mark.expression import Expression
from xdist.workermanage import WorkerController

from hil.tools import (
    AVR_PACKAGES,
    HIL_PACKAGES,
    NATIVE_PACKAGES,
    has_avr_compiler,
    has_board,
    has_compiler,
)

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
"""Names under which systems install Chromium."""


def browser() -> str | None:
    """Return the path of Chromium; None where it is not installed."""
    return next(filter(None, map(shutil.which, BROWSERS)), None)


TOOLS = {
    "compiler": (has_compiler, NATIVE_PACKAGES),
    "avr_compiler": (has_avr_compiler, AVR_PACKAGES),
    "board": (has_board, HIL_PACKAGES),
    "minisign": (lambda: shutil.which("minisign") is not None, "minisign"),
    "browser": (lambda: browser() is not None, "chromium"),
}
"""By marker, the test whether its tools are there and the Debian packages that hold them."""
RECORDINGS = (
    "tests marked `recordings` read recordings of real robots, which are not part of the repository: type"
    " `python -m pytest -m recordings --recordings=DIR`, where DIR is the folder of the sets that"
    " docs/diagnosis_evaluation.md names"
)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--recordings", metavar="DIR", help="folder of the recordings for `-m recordings`")


def pytest_configure(config: pytest.Config) -> None:
    """Refuse a choice of tests that this machine cannot run, before any test is collected.

    Raises:
        pytest.UsageError: `-m` asks for tests whose tools or recordings are missing; the text names what to type.
    """
    folder = config.getoption("--recordings")
    if folder is not None and not (config.invocation_params.dir / folder).is_dir():
        raise pytest.UsageError(f"--recordings={folder}: there is no such folder")
    if folder is None and _asks_for(config, "recordings"):
        raise pytest.UsageError(RECORDINGS)
    for marker, packages in _missing_tools().items():
        if _asks_for(config, marker):
            raise pytest.UsageError(f"tests marked `{marker}` need missing tools: apt-get install -y {packages}")
    if hasattr(config, "workerinput") or config.getoption("dist", "no") == "no":
        # It imports the whole project, which a process that runs no tests itself does not need.
        config.pluginmanager.import_plugin("tests.release_fixtures")


def _missing_tools() -> dict[str, str]:
    """Return the packages that are missing, by the marker of the tests that need them."""
    return {marker: packages for marker, (is_there, packages) in TOOLS.items() if not is_there()}


def _asks_for(config: pytest.Config, marker: str) -> bool:
    """Return whether `-m` selects tests because of this marker, and not merely lets them through."""
    if not config.option.markexpr:
        return False
    try:
        expression = Expression.compile(config.option.markexpr)
    except SyntaxError:
        return False  # pytest itself refuses it, with its own text
    return expression.evaluate(lambda name, **_: name == marker) and not expression.evaluate(lambda *_, **__: False)


def pytest_report_header() -> list[str]:
    """Report which tests are deselected because a tool is missing, and the line that installs it."""
    return [
        f"tests marked `{marker}` are deselected, because their tools are missing: apt-get install -y {packages}"
        for marker, packages in _missing_tools().items()
    ]


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Keep modules and tests, a million objects that stay, from being searched for garbage again and again.

    What tests leave is searched less often than by default: each search also calls functions of Hypothesis.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.set_threshold(20_000, 10, 10)
        gc.enable()


MAKES_THE_RELEASE = "tests/pipeline/rerendering/test_rerender.py"
LONG = (MAKES_THE_RELEASE, "tests/blender_scenes/", "tests/pipeline/", "tests/diagnosis/", "tests/symolo/")
"""Folders whose files take longest. One process makes the release of `release_fixtures` at the start, so that none
waits for it later.
"""


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Deselect tests whose tools are missing, and put those first that take longest."""
    missing = _missing_tools()
    chosen: list[pytest.Item] = []
    deselected: list[pytest.Item] = []
    for item in items:
        lacks_tools = any(item.get_closest_marker(marker) for marker in missing)
        (deselected if lacks_tools else chosen).append(item)
    if deselected:
        config.hook.pytest_deselected(items=deselected)
    # The sort is stable: within a folder and among the others the order of collection stays.
    items[:] = sorted(chosen, key=_turn)


def _turn(item: pytest.Item) -> int:
    """Return the place of the item's folder among `LONG`."""
    places = (place for place, folder in enumerate(LONG) if item.nodeid.startswith(folder))
    return next(places, len(LONG))


def pytest_deselected(items: list[pytest.Item]) -> None:
    """Note what a worker of pytest-xdist deselects, because only the controller writes to the terminal."""
    for item in items:
        if hasattr(item.config, "workeroutput"):
            output = item.config.workeroutput  # pyright: ignore[reportAttributeAccessIssue] - of pytest-xdist
            output.setdefault("deselected", []).append(item.nodeid)


@pytest.hookimpl(optionalhook=True)  # without pytest-xdist (`-p no:xdist`) there is no such hook
def pytest_testnodedown(node: WorkerController) -> None:
    """Report what the workers have deselected, once, since each of them collects all tests."""
    reporter = node.config.pluginmanager.get_plugin("terminalreporter")
    if reporter is not None and not reporter.stats.get("deselected"):
        node_ids = getattr(node, "workeroutput", {}).get("deselected", [])
        reporter.pytest_deselected([SimpleNamespace(nodeid=node_id) for node_id in node_ids])


@pytest.fixture(scope="session")
def recordings(pytestconfig: pytest.Config) -> Path:
    """Return the folder of the recordings that `--recordings` names."""
    folder = pytestconfig.getoption("--recordings")
    if folder is None:
        raise pytest.UsageError(RECORDINGS)
    return pytestconfig.invocation_params.dir / folder


class _Stillborn(subprocess.Popen):
    """A child that is killed before anything can be said to it."""

    def __init__(self, *arguments, **options):
        super().__init__(*arguments, **options)
        os.kill(self.pid, signal.SIGKILL)
        os.waitid(os.P_PID, self.pid, os.WEXITED | os.WNOWAIT)


@pytest.fixture
def stillborn_children(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every child process of the test is dead before it hears a word."""
    monkeypatch.setattr(subprocess, "Popen", _Stillborn)


BENCH_NOMINAL = """\
kind: motor_steady
motor:
  winding_resistance_ohm: {value: 3.0, tolerance: 0.03}
  torque_constant_N_m_A: {value: 0.3, tolerance: 0.002}
  viscous_friction_N_m_s_rad: {value: 0.002, tolerance: 0.0001}
  coulomb_friction_N_m: {value: 0.02, tolerance: 0.0008}
  supply_voltage_V: 7.4
noise: {current_A: 0.001, omega_rad_s: 0.04}
"""


@pytest.fixture(scope="session")
def motor_bench_case() -> Callable[..., Path]:
    """Writes a case of steady states, forward and back, every fourth row held out, from the closed form.

    `strength` is the real torque constant over the nominal one, `bump_A` a bump of the current at 6 rad/s, no effect.
    """

    def write(folder: Path, strength: float = 1.0, bump_A: float = 0.0, sweeps: int = 2) -> Path:
        noise = np.random.Generator(np.random.PCG64(5))
        resistance, constant, viscous, coulomb = 3.0, 0.3 * strength, 0.002, 0.02
        lines = ["row,sweep,split,t_s,u_cmd_V,current_A,omega_rad_s"]
        for row in range(21 * sweeps):
            sweep, step = divmod(row, 21)
            volts = 0.25 * step * (1 if sweep % 2 == 0 else -1)
            pull = constant * abs(volts) / resistance - coulomb
            speed = np.sign(volts) * max(pull, 0.0) / (constant**2 / resistance + viscous)
            current = (volts - constant * speed) / resistance
            current += bump_A * np.exp(-(((abs(speed) - 6.0) / 1.0) ** 2)) + 0.001 * noise.standard_normal()
            speed += 0.04 * noise.standard_normal()
            split = "holdout" if row % 4 == 3 else "fit"
            lines.append(f"{row + 1},{sweep + 1},{split},{3.0 * row},{volts},{current:.6f},{speed:.5f}")
        folder.mkdir(parents=True)
        (folder / "nominal.yaml").write_text(BENCH_NOMINAL)
        (folder / "data.csv").write_text("\n".join(lines) + "\n")
        return folder

    return write


@pytest.fixture(scope="session")
def changeable() -> Callable[[type], list[str]]:
    """Names of the fields of a dataclass to which a value can be assigned: none of a value that modules share."""

    def changeable(kind: type) -> list[str]:
        names, value = [], object.__new__(kind)
        for field in fields(kind):
            try:
                setattr(value, field.name, None)
            except FrozenInstanceError:
                continue
            names.append(field.name)
        return names

    return changeable
