"""The firmware for the board: what it takes of it, when it is compiled, and what is said where it cannot be."""

import re
import shutil
import subprocess

import pytest

from hil.build import (
    BAUDS,
    build_firmware,
    build_native,
    firmware_sources,
    student_tasks,
    student_version,
    write_sketch,
)
from symolo.core.errors import EnvironmentLacking, InputError


@pytest.fixture(scope="module")
def nominal(robot_of):
    return robot_of("nominal")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("avr")


@pytest.fixture(scope="module")
def build(nominal, folder):
    return build_firmware(nominal, "framed", 500_000, folder)


@pytest.mark.avr_compiler
def test_it_fits_the_board_with_room_to_spare(build):
    """Data sheet of the ATmega2560: 256 KB of flash, 8 KB of RAM; the stack has what is left."""
    command = [shutil.which("avr-size"), "-A", build.elf]
    listing = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    sizes = {name: int(size) for name, size in re.findall(r"^(\.\w+)\s+(\d+)", listing, re.MULTILINE)}
    data, text, bss = (sizes.get(name, 0) for name in (".data", ".text", ".bss"))
    assert 3200 * 4 < text + data < 64 * 1024
    assert 256 < data + bss + sizes.get(".noinit", 0) < 4096


@pytest.mark.avr_compiler
def test_the_hex_file_holds_the_program(build):
    """Intel HEX: the last record ends the file, and the bytes of every record add up to a multiple of 256."""
    records = build.hex.read_text().split()
    assert records[-1] == ":00000001FF"
    assert {sum(bytes.fromhex(record[1:])) % 256 for record in records} == {0}


@pytest.mark.avr_compiler
def test_what_is_there_is_not_compiled_again(nominal, folder, build, monkeypatch):
    monkeypatch.setenv("PATH", "")
    assert build_firmware(nominal, "framed", 500_000, folder) == build
    assert [path.name for path in folder.iterdir()] == [build.elf.parent.name]


def test_its_id_distinguishes_robots_framings_and_baud_rates(nominal, robot_of):
    ids = [firmware_sources(nominal, framing, baud)[1] for framing in ("framed", "simtwo") for baud in BAUDS]
    ids += [firmware_sources(robot_of("nominal", "robot.controller.line.k2_rad_s=0.91"), "framed", BAUDS[0])[1]]
    ids += [firmware_sources(nominal, "framed", BAUDS[0], student="")[1]]
    assert len(set(ids)) == len(ids)
    assert all(re.fullmatch(r"[0-9a-f]{16}", identity) for identity in ids)


def test_without_compiler_the_line_that_installs_it_is_reported(nominal, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", "")
    with pytest.raises(EnvironmentLacking, match="no avr-gcc; run `apt-get install -y gcc-avr avr-libc`"):
        build_firmware(nominal, "framed", 500_000, tmp_path)
    with pytest.raises(EnvironmentLacking, match="no gcc; run `apt-get install -y gcc libc6-dev`"):
        build_native(nominal, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_baud_rate_that_no_board_is_built_for_is_refused(nominal, tmp_path):
    with pytest.raises(InputError, match="baud: got 9600, allowed: 115200, 250000, 500000, 1000000"):
        build_firmware(nominal, "framed", 9600, tmp_path)


def test_a_sketch_is_a_folder_with_an_ino_of_its_name_and_all_that_it_includes(nominal, tmp_path):
    write_sketch(nominal, tmp_path / "my_robot")
    names = {path.name for path in (tmp_path / "my_robot").iterdir()}
    assert {name for name in names if name.endswith(".ino")} == {"my_robot.ino"}
    assert "main.c" not in names
    for path in (tmp_path / "my_robot").iterdir():
        assert set(re.findall(r'#include "(.+)"', path.read_text())) <= names


def test_a_sketch_for_students_holds_no_solution(nominal, tmp_path):
    write_sketch(nominal, tmp_path / "todo", exercises=student_tasks())
    names = {path.name for path in (tmp_path / "todo").iterdir()}
    assert "transitions.h" not in names
    assert (tmp_path / "todo" / "student.c").read_text().count("TODO") == len(student_tasks())


def test_a_folder_that_is_there_is_not_written_over(nominal, tmp_path):
    (tmp_path / "theirs.ino").touch()
    with pytest.raises(InputError, match="is there already; name a folder that is new or empty"):
        write_sketch(nominal, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["theirs.ino"]


@pytest.mark.parametrize("name", ["my robot", "ü", "-x"])
def test_a_name_that_the_ide_does_not_take_is_refused(nominal, tmp_path, name):
    with pytest.raises(InputError, match="name of a sketch"):
        write_sketch(nominal, tmp_path / name)


@pytest.mark.avr_compiler
@pytest.mark.firmware
def test_a_slip_in_the_student_s_part_is_reported_with_its_line(nominal, tmp_path):
    text = student_version(["follow"]).replace("sum / (float)active", "sun / (float)active")
    line = 1 + text[: text.index("sun")].count("\n")
    with pytest.raises(InputError, match=rf"does not compile: student.c:{line}:\d+: error: 'sun' undeclared"):
        build_firmware(nominal, "framed", 500_000, tmp_path, student=text)
    assert list(tmp_path.iterdir()) == []


ARDUINO_H = "#include <stdint.h>\nvoid setup();\nvoid loop();\n"
CORE = '#include "Arduino.h"\nint main()\n{\n    setup();\n    for (;;)\n        loop();\n}\n'
"""What of the Arduino core a sketch without Serial, pins and millis() gets: main."""


@pytest.mark.avr_compiler
@pytest.mark.firmware
@pytest.mark.parametrize("todo", [(), student_tasks()])
def test_a_sketch_compiles_as_the_ide_does_it(robot_of, tmp_path, todo):
    """With the flags of the IDE's platform.txt for AVR boards, all warnings on and none let through."""
    sketch = tmp_path / "robot"
    write_sketch(robot_of("classroom"), sketch, exercises=todo)
    (tmp_path / "Arduino.h").write_text(ARDUINO_H)
    (tmp_path / "core.cpp").write_text(CORE)
    (tmp_path / "robot.ino.cpp").write_text("#include <Arduino.h>\n" + (sketch / "robot.ino").read_text())
    mcu = ["-mmcu=atmega2560", "-DF_CPU=16000000L", "-DARDUINO=10819", "-DARDUINO_AVR_MEGA2560"]
    strict = ["-Wall", "-Wextra", "-Werror", "-Os", "-flto", "-ffunction-sections", "-fdata-sections"]
    cpp = ["avr-g++", *mcu, *strict, "-std=gnu++11", "-fno-exceptions", "-fno-threadsafe-statics", "-c"]
    for name in ("core.cpp", "robot.ino.cpp"):
        done(*cpp, f"-I{tmp_path}", f"-I{sketch}", tmp_path / name, "-o", tmp_path / f"{name}.o")
    linked = ["-std=gnu11", "-fuse-linker-plugin", "-Wl,--gc-sections", *tmp_path.glob("*.o"), *sketch.glob("*.c")]
    done("avr-gcc", *mcu, *strict, *linked, "-o", tmp_path / "sketch.elf", "-lm")
    assert (tmp_path / "sketch.elf").stat().st_size > 3200 * 4


def done(program, *arguments):
    ended = subprocess.run([shutil.which(program), *arguments], capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
