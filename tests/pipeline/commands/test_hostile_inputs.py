"""Files from a stranger: each is refused with one line, or does no more than what it says; nothing else is touched.

Every case gets a folder to lay its trap in, beside a file that nobody may read, change or follow a link to.
"""

import io
import json
import os
import signal
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from symolo.dataset.manifest import MANIFEST

SECONDS = 60
"""Within which each case ends, also on a busy machine; most take a tenth of one."""
THEIRS = "the stranger must not read this"
SCENARIO = "extends: smoke\nname: hostile\n"
DATA_HEADER = "t,x,y,theta,img"
ROWS = "".join(f"{50 * k},0.5{k % 10},0.2,1.57,0\n" for k in range(30))
TABLE = "t_ms,x_m,y_m,theta_rad,n\n" + ROWS

Trap = Callable[[Path], list[str]]
"""Lays a case in a folder; the arguments that step into it, where OUT is a folder to be made."""


def scenario(text: str | bytes) -> Trap:
    def lay(here: Path) -> list[str]:
        data = text if isinstance(text, bytes) else text.encode()
        (here / "scenario.yaml").write_bytes(data.replace(b"HERE", bytes(here)))
        return ["simulate", str(here / "scenario.yaml"), "--out", "OUT", "--workers", "1"]

    return lay


def picture(data: bytes, name: str = "photo.png") -> Trap:
    def lay(here: Path) -> list[str]:
        (here / "own").mkdir()
        (here / "own" / name).write_bytes(data)
        return look_with(name)(here)

    return lay


def look_with(name: str) -> Trap:
    def lay(here: Path) -> list[str]:
        (here / "own").mkdir(exist_ok=True)
        look = f"look: {{extends: classroom, assets: {here}/own, floor: {{picture: {{file: {json.dumps(name)}}}}}}}\n"
        return scenario(SCENARIO + look)(here)

    return lay


def linked(target: str) -> Trap:
    def lay(here: Path) -> list[str]:
        (here / "own").mkdir()
        (here / "own" / "photo.png").symlink_to(target.replace("HERE", str(here)))
        return look_with("photo.png")(here)

    return lay


def pipe(here: Path) -> list[str]:
    os.mkfifo(here / "scenario.yaml")
    return ["simulate", str(here / "scenario.yaml"), "--out", "OUT"]


def pipe_of_pictures(here: Path) -> list[str]:
    (here / "own").mkdir()
    os.mkfifo(here / "own" / "photo.png")
    return look_with("photo.png")(here)


def loop_of_links(here: Path) -> list[str]:
    (here / "a.yaml").symlink_to(here / "b.yaml")
    (here / "b.yaml").symlink_to(here / "a.yaml")
    return ["simulate", str(here / "a.yaml"), "--out", "OUT"]


def trajectory(data: str | bytes, *options: str) -> Trap:
    def lay(here: Path) -> list[str]:
        (here / "data.csv").write_bytes(data if isinstance(data, bytes) else data.encode())
        return ["rerender", str(here / "data.csv"), "--look", "classroom", "--out", "OUT", *options]

    return lay


def bench(rows: Callable[[str], str | bytes], nominal: Callable[[str], str] = str) -> Trap:
    """A good bench of measured data, spoilt."""

    def lay(here: Path) -> list[str]:
        text = (here / "good" / "data.csv").read_text()
        nominal_text = (here / "good" / "nominal.yaml").read_text()
        (here / "case").mkdir()
        made = rows(text)
        (here / "case" / "data.csv").write_bytes(made if isinstance(made, bytes) else made.encode())
        (here / "case" / "nominal.yaml").write_text(nominal(nominal_text))
        return ["diagnose", str(here / "case"), "--out", "OUT"]

    return lay


def png_header(width: int, height: int) -> bytes:
    """An image that says it is so large, and holds next to nothing."""

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    rows = zlib.compress(bytes(10_000_000), 9)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")


def zipped() -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("../../escaped.png", bytes(1_000_000))
    return buffer.getvalue()


class _Touches:
    """What a pickle would do to whoever loads it."""

    def __init__(self, path: Path) -> None:
        self.path = str(path)

    def __reduce__(self) -> tuple[object, ...]:
        return (os.mkdir, (self.path,))


BOMB = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{chr(98 + k)}: &{chr(98 + k)} [{', '.join(['*' + chr(97 + k)] * 9)}]\n" for k in range(9)
)

REFUSED: dict[str, Trap] = {
    "aliases that multiply": scenario(BOMB),
    "a tag that runs a command": scenario(SCENARIO + "seed: !!python/object/apply:os.mkdir [HERE/owned]\n"),
    "a tag that makes an object": scenario(SCENARIO + "seed: !!python/object/new:os.system [touch HERE/owned]\n"),
    "100,000 brackets": scenario(SCENARIO + "seed: " + "[" * 100_000),
    "100,000 braces in braces": scenario(SCENARIO + "seed: " + "{a: " * 100_000),
    "three million characters": scenario(SCENARIO + "description: " + "x" * 3_000_000 + "\n"),
    "a million empty lines": scenario(SCENARIO + "\n" * 2_000_000),
    "a key given twice": scenario(SCENARIO + "seed: 1\nseed: 2\n"),
    "a merge key": scenario(SCENARIO + "<<: {seed: 1}\n"),
    "two documents": scenario(SCENARIO + "---\n" + SCENARIO),
    "a null byte": scenario(SCENARIO.encode() + b"seed: 1\x00\n"),
    "UTF-16": scenario((SCENARIO + "seed: 1\n").encode("utf-16")),
    "bytes of no text": scenario(bytes(range(256)) * 10),
    "a number of 5000 digits": scenario(SCENARIO + "seed: " + "9" * 5000 + "\n"),
    "a number in base 60": scenario(SCENARIO + "seed: 190:20:30\n"),
    "escape codes of a terminal": scenario(SCENARIO + '"\\e]0;owned\\a\\e[2J": 1\n'),
    "escape codes in a value": scenario(SCENARIO + 'seed: "\\e]52;c;b3duZWQ=\\a"\n'),
    "a name that leaves the folder": scenario(
        SCENARIO + "routes: [{name: ../../escaped, start: {x_m: 0, y_m: 0, yaw_deg: 90}}]\n"
    ),
    "a name of a hidden folder": scenario(
        SCENARIO + "routes: [{name: .stages, start: {x_m: 0, y_m: 0, yaw_deg: 90}}]\n"
    ),
    "a file of secrets as parent": scenario("extends: HERE/secret\nname: hostile\n"),
    "the system's passwords as parent": scenario("extends: ../../../../../../../../etc/passwd\nname: hostile\n"),
    "its own parent": scenario("extends: HERE/scenario.yaml\nname: hostile\n"),
    "a device that never ends": lambda _: ["simulate", "/dev/zero", "--out", "OUT"],
    "a pipe that nobody writes to": pipe,
    "a folder": lambda here: ["simulate", str(here), "--out", "OUT"],
    "links that go round": loop_of_links,
    "runs without end": scenario(
        SCENARIO + "routes: [{name: CW, start: {x_m: 0.5, y_m: -0.2, yaw_deg: 90}, runs: 99999999999}]\n"
    ),
    "a picture outside its folder": look_with("../secret"),
    "a picture by its full path": look_with("/etc/passwd"),
    "a picture of a null byte": look_with("photo\x00.png"),
    "a link out of the folder": linked("HERE/secret"),
    "a link to a device": linked("/dev/zero"),
    "a pipe in place of a picture": pipe_of_pictures,
    "a picture of 60000 x 60000": picture(png_header(60_000, 60_000)),
    "a picture of 0 x 0": picture(png_header(0, 0)),
    "a picture that is cut": picture(png_header(64, 64)[:200]),
    "an archive as picture": picture(zipped()),
    "a Blender file as picture": picture(b"BLENDER-v405" + bytes(5000), "photo.blend"),
    "a Blender file by another name": picture(b"BLENDER-v405" + bytes(5000)),
    "a drawing that names files": picture(
        b'<?xml version="1.0"?><!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/passwd">]><svg>&x;</svg>', "photo.svg"
    ),
    "a trajectory with nulls": trajectory(f"{DATA_HEADER}\n{ROWS}".replace("0.53", "0.5\x003")),
    "a trajectory without columns": trajectory("a,b\n1,2\n"),
    "a trajectory with a column twice": trajectory(
        f"{DATA_HEADER},x\n" + ROWS.replace("\n", ",1\n"), "--format", "symolo"
    ),
    "times that go back": trajectory(f"{DATA_HEADER}\n{ROWS}".replace("\n500,", "\n100,")),
    "places that are no numbers": trajectory(f"{DATA_HEADER}\n{ROWS}".replace("0.53", "nan", 1)),
    "places without end": trajectory(f"{DATA_HEADER}\n{ROWS}".replace("0.53", "inf", 1)),
    "places beyond the sky": trajectory(f"{DATA_HEADER}\n{ROWS}".replace("0.53", "1e308", 1)),
    "places beyond the sky in a table": trajectory(TABLE.replace("0.53", "1e308", 1)),
    "a formula for a spreadsheet": trajectory(f"{DATA_HEADER}\n{ROWS}".replace("0.53", "=cmd|' /C calc'!A0", 1)),
    "quotes that never close": trajectory(f'{DATA_HEADER}\n"{ROWS}'),
    "a line of ten million characters": trajectory(f"{DATA_HEADER}\n" + "1" * 10_000_000 + "\n"),
    "a picture number of 10^18": trajectory(f"{DATA_HEADER}\n" + ROWS.replace(",0\n", ",1000000000000000000\n")),
    "a bench with nulls": bench(lambda text: text.replace("\n5,1", "\n5\x00,1")),
    "a bench with rows cut off": bench(lambda text: text[: len(text) // 2].rsplit(",", 1)[0]),
    "a bench in UTF-16": bench(lambda text: text.encode("utf-16")),
    "a bench whose noise is a tag": bench(str, lambda text: text.replace("0.04", "!!python/name:os.system")),
    "a bench of a kind that is a path": bench(str, lambda text: text.replace("motor_steady", "../../motor_steady")),
    "a bench without resistance": bench(str, lambda text: text.replace("value: 3.0", "value: .nan")),
}
"""By what is wrong."""


@pytest.fixture
def here(tmp_path: Path, motor_bench_case: Callable[..., Path]) -> Iterator[Path]:
    """A folder with a secret; what hangs is ended."""
    (tmp_path / "secret").write_text(THEIRS)
    motor_bench_case(tmp_path / "good")
    signal.signal(signal.SIGALRM, _too_long)
    signal.alarm(SECONDS)
    yield tmp_path
    signal.alarm(0)


def _too_long(*_: object) -> None:
    raise TimeoutError(f"takes more than {SECONDS} s")


def tree(root: Path) -> dict[str, str]:
    return {str(path): path.read_text("latin-1") if path.is_file() else "" for path in root.rglob("*")}


@pytest.mark.parametrize("case", REFUSED)
def test_a_strangers_file_is_refused_in_one_line_and_has_no_effect(case, symolo, here):
    arguments = REFUSED[case](here)
    before = tree(here)
    ended = symolo(*(a.replace("OUT", str(here / "out")) for a in arguments))
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith("symolo: ")
    assert ended.err.count("\n") == 1
    assert len(ended.err) < 1500
    assert ended.err.rstrip("\n").isprintable()
    assert THEIRS not in ended.err
    assert "root:" not in ended.err
    assert tree(here) == before


@pytest.mark.usefixtures("hands")
def test_html_in_names_is_text_on_the_page(symolo, here):
    evil = "<img src=x onerror=alert(1)>&amp;"
    (here / "good").rename(here / evil)
    ended = symolo("diagnose", here / evil, "--out", here / "out")
    assert ended.code == 0
    page = (here / "out" / "report.html").read_text()
    assert "<img src=x" not in page
    assert "&lt;img src=x onerror=alert(1)&gt;&amp;amp;" in page


class TestDatasets:
    """A release that a stranger has doctored."""

    @pytest.fixture
    def release(self, dataset, copy_of):
        return copy_of(dataset, stages=True)

    @pytest.mark.parametrize("name", ["../secret", "/etc/passwd", "CW/../../secret", "CW/test_1/../../../secret"])
    @pytest.mark.usefixtures("here")
    def test_checksums_of_files_outside_are_faults_and_not_followed(self, name, symolo, release):
        with (release / MANIFEST).open("a") as file:
            file.write(f"{'0' * 64}  {name}\n")
        ended = symolo("verify", release)
        assert ended.code == 4
        assert name in ended.out
        assert THEIRS not in ended.out + ended.err
        assert "Traceback" not in ended.err

    def test_a_run_that_is_a_link_is_a_fault(self, symolo, here, release):
        run = next(path for path in release.glob("*/*") if (path / "data.csv").is_file())
        run.rename(here / "elsewhere")
        run.symlink_to(here / "elsewhere")
        ended = symolo("verify", release)
        assert ended.code == 4
        assert run.relative_to(release).as_posix() in ended.out

    def test_arrays_that_are_pickles_are_refused(self, symolo, here, release):
        (stored,) = list((release / ".stages" / "simulate").rglob("trajectory.npz"))[:1]
        np.savez(stored, allow_pickle=True, pose=np.array([_Touches(here / "owned")], dtype=object))
        ended = symolo("rerender", stored.parent, "--look", "classroom", "--out", here / "out")
        assert ended.code == 2
        assert ended.err.count("\n") == 1
        assert not (here / "owned").exists()

    def test_stages_that_are_a_link_are_not_written_through(self, symolo, here, release, tiny):
        (release / ".stages").rename(here / "theirs")
        (release / ".stages").symlink_to(here / "theirs")
        before = tree(here / "theirs")
        ended = symolo("release", "smoke", "--out", release, *tiny, "--set=seed=5", "--workers", "1")
        assert ended.code == 2
        assert ended.err.count("\n") == 1
        assert tree(here / "theirs") == before

    def test_a_run_that_is_a_link_is_replaced_and_not_followed(self, symolo, here, release, tiny):
        run = next(path for path in release.glob("*/*") if (path / "data.csv").is_file())
        (here / "mine").mkdir()
        (here / "mine" / "precious").write_text(THEIRS)
        run.rename(here / "elsewhere")
        run.symlink_to(here / "mine")
        symolo("release", "smoke", "--out", release, *tiny, "--workers", "1")
        assert (here / "mine" / "precious").read_text() == THEIRS
        assert [path.name for path in (here / "mine").iterdir()] == ["precious"]
