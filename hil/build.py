"""Builds the firmware: for the board with avr-gcc, for this machine with gcc, and as a sketch for the Arduino IDE."""

import contextlib
import hashlib
import os
import re
import shutil
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from configs.schema.board import FramingName
from configs.schema.robot import RobotConfig
from hil import firmware
from hil.generate import generate
from hil.tools import AVR_PACKAGES, NATIVE_PACKAGES
from symolo.core.errors import EnvironmentLacking, InputError
from symolo.core.files.atomic_files import make_folder, move, write_file
from symolo.core.files.new_folder import check_new, new_folder
from symolo.core.files.scratch_folders import scratch_folder

BAUDS = (115_200, 250_000, 500_000, 1_000_000)
"""Baud rates. A board's hello holds the index of its baud rate in this table."""

_SOURCES = Path(firmware.__file__).parent
_SKETCH_MAIN = "symolo.ino"
_WARNINGS = ("-Wall", "-Wextra", "-Wundef")
_AVR = ("-mmcu=atmega2560", "-DF_CPU=16000000UL")
_AVR_FLAGS = (*_AVR, "-std=gnu11", "-Os", "-flto", "-ffunction-sections", "-Wl,--gc-sections", *_WARNINGS)
_NATIVE_FLAGS = ("-std=gnu11", "-O1", "-fPIC", "-shared", "-ffp-contract=off", *_WARNINGS)
_TASK = re.compile(r"#ifdef TODO_(\w+)")


@dataclass(frozen=True)
class FirmwareBuild:
    """A firmware that is ready for a board."""

    elf: Path
    hex: Path
    """Firmware in the format that avrdude flashes."""
    id: str
    """First eight bytes of the SHA-256 of sources and settings, as 16 hexadecimal digits; a hello holds it."""


def student_tasks() -> tuple[str, ...]:
    """Return the functions of student.c that students can write themselves, in the order of the file."""
    return tuple(name.lower() for name in _TASK.findall(_hand_written()["student.c"]))


def firmware_sources(
    robot: RobotConfig, framing: FramingName, baud: int, student: str | None = None
) -> tuple[dict[str, str], str]:
    """Return all source files of the firmware, text by name, and its id.

    Args:
        robot: Robot whose numbers and paths it gets.
        framing: Framing of the messages.
        baud: One of `BAUDS`.
        student: Text of a student.c in place of the reference solution.

    Raises:
        InputError: The robot's numbers do not fit the board, or there is no such baud rate.
    """
    if baud not in BAUDS:
        raise InputError("baud", got=baud, allowed=", ".join(map(str, BAUDS)))
    files = _hand_written() | generate(robot)
    if student is not None:
        files["student.c"] = student
    digest = hashlib.sha256()
    for name in sorted(files):
        digest.update(f"{name}\0{files[name]}\0".encode())
    digest.update(f"{framing}\0{baud}".encode())
    id_bytes = digest.digest()[:8]
    return files | {"build_settings.h": _build_settings(framing, baud, id_bytes)}, id_bytes.hex()


def build_firmware(
    robot: RobotConfig, framing: FramingName, baud: int, out_dir: Path, student: str | None = None
) -> FirmwareBuild:
    """Return the firmware for the board, in a folder within `out_dir`; compile it if it is missing.

    Args:
        robot: Robot whose controller it is.
        framing: Framing of the messages.
        baud: One of `BAUDS`.
        out_dir: Folder that holds every firmware by its id.
        student: Text of a student.c in place of the reference solution.

    Raises:
        InputError: The robot's numbers do not fit the board, or the student's code does not compile.
        EnvironmentLacking: There is no avr-gcc; names the line that installs it.
    """
    files, identity = firmware_sources(robot, framing, baud, student)
    place = out_dir / f"firmware-{identity}-{_short_hash(_AVR_FLAGS)}"
    build = FirmwareBuild(place / "firmware.elf", place / "firmware.hex", identity)
    if build.elf.is_file() and build.hex.is_file():
        return build
    with _scratch(files, out_dir) as scratch:
        elf, hex_file = (scratch / path.name for path in (build.elf, build.hex))
        _compile(["avr-gcc", *_AVR_FLAGS, "-o", str(elf)], files, scratch, AVR_PACKAGES)
        _run(["avr-objcopy", "-O", "ihex", "-R", ".eeprom", str(elf), str(hex_file)], AVR_PACKAGES)
        make_folder(place)
        move(elf, build.elf)  # it may replace that of another process, which is the same
        move(hex_file, build.hex)
    return build


def build_native(
    robot: RobotConfig, out_dir: Path, framing: FramingName = "framed", student: str | None = None
) -> Path:
    """Return the same firmware as a shared library for this machine in `out_dir`; native.c names its functions.

    Raises:
        InputError: As `build_firmware`.
        EnvironmentLacking: There is no C compiler; names the line that installs it.
    """
    files, identity = firmware_sources(robot, framing, BAUDS[0], student)
    place = out_dir / f"firmware-{identity}-{_short_hash(_NATIVE_FLAGS)}.so"
    if not place.is_file():
        with _scratch(files, out_dir) as scratch:
            library = scratch / place.name
            _compile(["gcc", *_NATIVE_FLAGS, "-o", str(library)], files, scratch, NATIVE_PACKAGES)
            move(library, place)
    return place


def write_sketch(
    robot: RobotConfig,
    folder: Path,
    framing: FramingName = "framed",
    baud: int = 500_000,
    exercises: Sequence[str] = (),
) -> str:
    """Write a complete sketch for the Arduino IDE into a new folder, and return the firmware's id.

    Args:
        robot: Robot whose controller it is.
        folder: New or empty folder; its name becomes that of the sketch.
        framing: Framing of the messages.
        baud: One of `BAUDS`.
        exercises: Functions of `student_tasks()` that students write themselves.

    Raises:
        InputError: The folder is not empty, its name is not allowed for a sketch, or there is no such function.
    """
    check_new(folder)
    if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,62}", folder.name):
        raise InputError("name of a sketch", got=folder.name, allowed="letters, digits, '_', '.' and '-'")
    student = student_version(exercises) if exercises else None
    files, identity = firmware_sources(robot, framing, baud, student)
    if "next_state" in exercises:
        del files["transitions.h"]  # it is the solution
    sketch = {name: text for name, text in files.items() if name not in {"main.c", "native.c", _SKETCH_MAIN}}
    sketch[f"{folder.name}.ino"] = files[_SKETCH_MAIN]
    with new_folder(folder) as partial:
        for name, text in sorted(sketch.items()):
            write_file(partial / name, text.encode())
    return identity


def student_version(exercises: Sequence[str]) -> str:
    """Return student.c with a TODO in place of the solution of each of these functions.

    Raises:
        InputError: There is no such function.
    """
    tasks = student_tasks()
    for name in exercises:
        if name not in tasks:
            raise InputError("exercise", got=name, allowed=f"one of {', '.join(tasks)}")
    lines: list[str] = []
    conditions = [True]
    for line in _hand_written()["student.c"].splitlines():
        if match := re.fullmatch(r"#if(n?)def TODO_(\w+)", line):
            conditions.append((match[2].lower() in exercises) is not bool(match[1]))
        elif line == "#else":
            conditions[-1] = not conditions[-1]
        elif line == "#endif":
            conditions.pop()
        elif all(conditions):
            lines.append(line)
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines) + "\n")


def _hand_written() -> dict[str, str]:
    paths = (path for path in _SOURCES.iterdir() if path.suffix in {".c", ".h", ".ino"})
    return {path.name: path.read_text(encoding="utf-8") for path in sorted(paths)}


def _build_settings(framing: FramingName, baud: int, id_bytes: bytes) -> str:
    lines = [
        "/* Made: what this firmware is built for. */",
        "#ifndef BUILD_SETTINGS_H",
        "#define BUILD_SETTINGS_H",
        "",
        *(["#define FRAMING_SIMTWO"] if framing == "simtwo" else []),
        f"#define BAUD {baud}UL",
        f"#define BAUD_INDEX {BAUDS.index(baud)}",
        f"#define FIRMWARE_ID {{{', '.join(f'0x{byte:02X}' for byte in id_bytes)}}}",
        "",
        "#endif",
        "",
    ]
    return "\n".join(lines)


def _short_hash(flags: Sequence[str]) -> str:
    return hashlib.sha256(" ".join(flags).encode()).hexdigest()[:8]


@contextlib.contextmanager
def _scratch(files: Mapping[str, str], out_dir: Path) -> Iterator[Path]:
    """Yield a temporary folder within `out_dir` that holds the sources."""
    make_folder(out_dir)
    with scratch_folder(out_dir) as scratch:
        for name, text in files.items():
            (scratch / name).write_text(text, encoding="utf-8")
        yield scratch


def _compile(command: Sequence[str], files: Mapping[str, str], folder: Path, packages: str) -> None:
    sources = [str(folder / name) for name in sorted(files) if name.endswith(".c")]
    _run([*command, *sources, "-lm"], packages)


def _run(command: Sequence[str], packages: str) -> None:
    """Run a tool of the compiler.

    Raises:
        EnvironmentLacking: The tool or its library is missing.
        InputError: The sources do not compile; the text ends with the first error.
    """
    program = shutil.which(command[0])
    if program is None:
        raise EnvironmentLacking(f"there is no {command[0]}; run `apt-get install -y {packages}`")
    plain = {**os.environ, "LC_ALL": "C"}  # messages in English, with plain quotes
    done = subprocess.run(
        [program, *command[1:]], env=plain, capture_output=True, text=True, errors="replace", check=False
    )
    if done.returncode == 0:
        return
    errors = [line for line in done.stderr.splitlines() if "error:" in line] or done.stderr.splitlines()[-1:] or ["?"]
    if any(f"{name}: No such file" in line for line in errors for name in ("avr/io.h", "stdint.h", "math.h")):
        raise EnvironmentLacking(f"{command[0]} lacks its C library; run `apt-get install -y {packages}`")
    raise InputError(f"the firmware does not compile: {errors[0].rsplit('/', 1)[-1]}")
