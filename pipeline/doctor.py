"""`symolo doctor`: whether this machine has what symolo needs, and how to install what is missing."""

import importlib.util
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from blender_scenes.render.surroundings import SYSTEM_PACKAGES
from hil.tools import HIL_PACKAGES, has_board
from symolo.core.versions import installed_version

PACKAGES = (
    "bpy",
    "numpy",
    "opencv-python-headless",
    "pandas",
    "pybullet",
    "pydantic",
    "pyserial",
    "PyYAML",
    "rich",
    "scipy",
    "typer",
)
LOCK = Path(__file__).resolve().parents[1] / "requirements.lock"
INSTALL = "run ./setup in the repository"
APT_LINE = f"run apt-get install -y {SYSTEM_PACKAGES}"
MIN_DISK_MB = 1000
MIN_MEMORY_MB = 2000
CHILD_TIMEOUT_S = 120

ASK_BLENDER = """
import bpy
from blender_scenes.blender_side.gpus import listed
print("version " + bpy.app.version_string)
print("devices " + ", ".join(f"{name} ({kind})" for kind, names in listed().items() for name in names))
"""


@dataclass(frozen=True)
class MachineCheck:
    """One line of the doctor's report."""

    name: str
    ok: bool
    result: str
    cure: str = ""

    def __str__(self) -> str:
        line = f"{'ok     ' if self.ok else 'MISSING'} {self.name}: {self.result}"
        return line if self.ok or not self.cure else f"{line}; {self.cure}"


def examine(folder: Path) -> Iterator[MachineCheck]:
    """Yield all checks; `folder` is on the disk whose free space is checked."""
    yield _python()
    locked = locked_versions()
    for package in PACKAGES:
        yield _package(package, locked)
    libraries = _system_libraries()
    yield libraries
    if libraries.ok:
        yield from _blender()
    yield _pybullet()
    yield _board()
    yield from _machine(folder)


def locked_versions() -> dict[str, str]:
    """Return the locked versions by package name in lower case; empty for an installation without the repository."""
    if not LOCK.is_file():
        return {}
    return {
        name.lower(): version for name, version in re.findall(r"^([\w.-]+)==([^\s\\]+)", LOCK.read_text(), re.MULTILINE)
    }


def _python() -> MachineCheck:
    version = ".".join(map(str, sys.version_info[:3]))
    return MachineCheck(
        "Python", sys.version_info[:2] == (3, 11), version, "install Python 3.11: apt-get install -y python3.11-venv"
    )


def _package(package: str, locked: dict[str, str]) -> MachineCheck:
    version = installed_version(package)
    pinned = locked.get(package.lower())
    if version is None:
        return MachineCheck(package, ok=False, result="not installed", cure=INSTALL)
    if pinned and version != pinned:
        return MachineCheck(package, ok=False, result=f"{version}, but the lock file has {pinned}", cure=INSTALL)
    return MachineCheck(package, ok=True, result=version)


def _system_libraries() -> MachineCheck:
    """Check that the dynamic loader finds all shared libraries of bpy."""
    name = "system libraries"
    spec = importlib.util.find_spec("bpy")
    if spec is None or spec.origin is None:
        return MachineCheck(name, ok=False, result="cannot be checked while bpy is missing", cure=INSTALL)
    ldd = shutil.which("ldd")
    if ldd is None:
        return MachineCheck(name, ok=True, result="not checked: there is no ldd")
    binary = Path(spec.origin)
    binary = binary if binary.suffix == ".so" else binary.with_name("__init__.so")
    listing = subprocess.run([ldd, str(binary)], capture_output=True, text=True, check=False).stdout
    missing = sorted(set(re.findall(r"^\s*(\S+) => not found", listing, re.MULTILINE)))
    return MachineCheck(name, not missing, ", ".join(missing) or "all that bpy loads", APT_LINE)


def _blender() -> Iterator[MachineCheck]:
    code, out, error = _child(ASK_BLENDER)
    facts = dict(line.split(" ", 1) for line in out.splitlines() if line.startswith(("version ", "devices ")))
    if code or "version" not in facts:
        yield MachineCheck("Blender", ok=False, result=error or "does not start", cure=APT_LINE)
        return
    yield MachineCheck("Blender", ok=True, result=f"{facts['version']} starts")
    result = facts.get("devices", "") or "none"
    how = "used with --device auto or gpu; the CPU is the default" if facts.get("devices") else "the CPU renders"
    yield MachineCheck("graphics card", ok=True, result=f"{result}; {how}")


def _pybullet() -> MachineCheck:
    code, _, error = _child("import pybullet; pybullet.disconnect(pybullet.connect(pybullet.DIRECT))")
    return MachineCheck("PyBullet", code == 0, "starts" if code == 0 else error or "does not start", INSTALL)


def _board() -> MachineCheck:
    """Check hardware in the loop, which is never missing: only `hil --simulated` and firmware builds need it."""
    ready, cure = (
        "simulated board and firmware can be built",
        f"for `hil --simulated`, run apt-get install -y {HIL_PACKAGES}",
    )
    return MachineCheck("hardware in the loop", ok=True, result=ready if has_board() else f"not set up; {cure}")


def _child(program: str) -> tuple[int, str, str]:
    """Run a Python child that may crash; return exit code, output and last line of the error output."""
    try:
        child = subprocess.run(
            [sys.executable, "-P", "-c", program], capture_output=True, text=True, check=False, timeout=CHILD_TIMEOUT_S
        )
    except subprocess.TimeoutExpired:
        return 1, "", f"no answer within {CHILD_TIMEOUT_S} s"
    lines = child.stderr.strip().splitlines()
    return child.returncode, child.stdout, lines[-1] if lines else ""


def _machine(folder: Path) -> Iterator[MachineCheck]:
    from pipeline.work.supervisor import cores  # noqa: PLC0415 - needs pydantic, which is looked at above

    free_mb = shutil.disk_usage(folder).free // 10**6
    yield MachineCheck(
        "disk", free_mb >= MIN_DISK_MB, f"{free_mb} MB free in {folder}", "free some space, or work on a different disk"
    )
    yield MachineCheck("cores", ok=True, result=str(cores()))
    memory_mb = _memory_available_mb()
    if memory_mb is not None:
        cure = "close other programs, or give --workers 1"
        yield MachineCheck("memory", memory_mb >= MIN_MEMORY_MB, f"{memory_mb} MB available", cure)


def _memory_available_mb() -> int | None:
    try:
        result = re.search(r"^MemAvailable:\s+(\d+) kB", Path("/proc/meminfo").read_text(), re.MULTILINE)
    except OSError:
        return None
    return int(result.group(1)) // 1000 if result else None
