"""Pipes, links, devices, sockets and folders in the place of files of a dataset: refused at once by every command."""

import itertools
import os
import re
import resource
import shutil
import signal
import socket
import tarfile
import tempfile
import time
from pathlib import Path

import pytest

from pipeline.cli import main

RUN = "CW/test_1"
THEIRS = "first-field-of-a-file-of-the-user"
FILES = (
    "metadata.json",
    "manifest-sha256.txt",
    "tagmanifest-sha256.txt",
    "bag-info.txt",
    "README.md",
    f"{RUN}/data.csv",
    f"{RUN}/image_positions.txt",
    f"{RUN}/side/wheels.csv",
    f"{RUN}/side/camera.csv",
    f"{RUN}/side/intrinsics.json",
    f"{RUN}/side/spec.json",
    f"{RUN}/side/scene.json",
    f"{RUN}/images/000001.jpg",
    f".stages/simulate/{RUN}/outcome.json",
    f".stages/simulate/{RUN}/spec.json",
    f".stages/simulate/{RUN}/trajectory.npz",
    f".stages/render/{RUN}/job.json.gz",
    f".stages/render/{RUN}/done.json",
    f".stages/assemble/{RUN}/done.json",
    ".stages/assemble/metadata.json",
    ".stages/kind",
)
READ_BY_MOST = ("metadata.json", f"{RUN}/data.csv", f"{RUN}/side/spec.json", f"{RUN}/images/000001.jpg")
FOLDERS = ("CW", RUN, f"{RUN}/side", f"{RUN}/images", ".stages")
SECONDS = 2.0
"""Of the processor, within which what is refused is refused."""
BYTES = 300 << 20
"""What a command may need more than before."""


def put_socket(path: Path) -> None:
    with tempfile.TemporaryDirectory() as short, socket.socket(socket.AF_UNIX) as server:
        server.bind(f"{short}/s")  # whose name may have 107 characters
        shutil.move(f"{short}/s", path)


STRANGE = {
    "pipe": lambda path, _: os.mkfifo(path),
    "link to a device": lambda path, _: path.symlink_to("/dev/zero"),
    "link to a file of the user": lambda path, theirs: path.symlink_to(theirs),
    "folder": lambda path, _: path.mkdir(),
    "socket": lambda path, _: put_socket(path),
}
"""What is put at a path, in the place of a file."""
COMMANDS = {
    "status": ["status", "DATA"],
    "status --check": ["status", "DATA", "--check"],
    "verify": ["verify", "DATA"],
    "repair": ["repair", "DATA"],
    "report": ["report", "DATA", "--out", "OUT.html"],
    "export": ["export", "DATA", "--format", "tum,coco,kitti", "--out", "OUT"],
    "compare": ["compare", "DATA", "RELEASE"],
    "contact-sheet": ["contact-sheet", "DATA", "--out", "OUT.jpg"],
    "view": ["view", "DATA", "--out", "OUT.html"],
    "video": ["video", "DATA", "--out", "OUT.gif", "--width-px", "320", "--fps", "2", "--runs", RUN],
    "pack": ["pack", "DATA", "--about", "ABOUT", "--out", "OUT"],
    "bag": ["bag", "DATA", "--out", "OUT"],
    "upload": ["upload", "DATA", "file://OUT"],
    "diagnose": ["diagnose", f"DATA/{RUN}", "--out", "OUT"],
    "inspect": ["inspect", f"DATA/{RUN}"],
    "baselines": ["baselines", "DATA", "--out", "OUT"],
    "rerender": ["rerender", f"DATA/{RUN}", "--look", "lab", "--out", "OUT", "--preview"],
}
READS_SOME = ("report", "contact-sheet", "view", "video", "diagnose", "inspect", "rerender", "status", "status --check")
ALLOWED = {command: {0, 2} for command in READS_SOME} | {
    "verify": {4},
    "status --check": {0, 2, 4},
    "compare": {2, 7},
    "repair": {0, 2, 4},
}
"""Exit codes; 2 for those that are not named. A command that does not read a file may succeed without it."""
ABOUT = """
title: A
description: B
authors: [{name: "C, D"}]
published: 2026-01-01
publisher: E
"""


class Hung(BaseException):
    """Not an Exception, so that no command takes it for a fault of a file."""


@pytest.fixture
def trap(release, tmp_path, capsys):
    """A copy of a release of which one file or folder is replaced, and how a command ends there."""
    data = tmp_path / "data"
    shutil.copytree(release, data)
    (tmp_path / "about.yaml").write_text(ABOUT)
    (tmp_path / "secret").write_text(f"{THEIRS},1,2,3\n{THEIRS}\n")
    places = {"DATA": data, "RELEASE": release, "ABOUT": tmp_path / "about.yaml", "OUT": tmp_path / "out"}

    def ends(command, name):
        arguments = [
            re.sub("[A-Z]{3,}", lambda name: str(places[name.group()]), argument) for argument in COMMANDS[command]
        ]
        for old in tmp_path.glob("out*"):
            shutil.rmtree(old) if old.is_dir() else old.unlink()
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        begin = time.process_time()
        signal.signal(signal.SIGALRM, _hung)
        signal.alarm(30)  # of a machine that others use too; what waits for a pipe waits for ever
        try:
            code = main(arguments)
        except Hung:
            code = "hangs"
        finally:
            signal.alarm(0)
        seconds = time.process_time() - begin
        grown = 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
        output = "".join(capsys.readouterr())
        wrong = []
        allowed = ALLOWED.get(command, {2}) if not name.startswith(".stages") else {0, 2, 4}  # which few commands read
        wrong += [f"exit code {code}: {output[-300:]}"] if code not in allowed else []
        wrong += [f"took {seconds:.1f} s"] if code != 0 and seconds > SECONDS else []
        wrong += [f"took {grown >> 20} MiB"] if grown > BYTES else []
        wrong += ["shows what is in a file of the user"] if THEIRS in output or "root:" in output else []
        wrong += ["ends in a traceback"] if "Traceback" in output else []
        return wrong

    return data, ends


def _hung(*_):
    raise Hung


def replaced(path, put, theirs):
    """Put something strange in the place of a file or folder."""
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink()
    put(path, theirs)


def wrong_ends(command, names, put, trap, release):
    """What is wrong with the end of a command, for each of the files that is replaced in turn."""
    data, ends = trap
    wrong = []
    for name in names:
        replaced(data / name, put, data.with_name("secret"))
        wrong += [f"{name}: {what}" for what in ends(command, name)]
        shutil.rmtree(data)
        shutil.copytree(release, data)
    return wrong


@pytest.mark.parametrize(("command", "kind"), list(zip(COMMANDS, itertools.cycle(STRANGE), strict=False)))
def test_each_command_meets_a_strange_file(command, kind, trap, release):
    """A short form of the tests below, which replace each file by each kind for each command."""
    assert wrong_ends(command, READ_BY_MOST[:2], STRANGE[kind], trap, release) == []


@pytest.mark.parametrize("command", ["status", "repair"])
@pytest.mark.parametrize("name", [".stages/simulate/CW", f".stages/render/{RUN}/images", ".stages/assemble"])
def test_a_link_in_the_stages_is_refused(command, name, trap, capsys):
    data, _ = trap
    shutil.move(data / name, data.with_name("moved"))
    (data / name).symlink_to("../" * name.count("/") + "../moved")
    assert main([command, str(data)]) == 2
    assert f"{name}: is a symbolic link, and a dataset holds plain folders" in "".join(capsys.readouterr())
    assert (data / name).is_symlink()


def hostile_archive(path: Path, outside: Path) -> None:
    """Write a tar whose members lead out of its folder, are no files, are huge, or have headers of megabytes."""
    members = {
        "absolute": {"name": str(outside / "absolute")},
        "above": {"name": "../above"},
        "link": {"name": "link", "type": tarfile.SYMTYPE, "linkname": "/etc"},
        "hard link": {"name": "hard", "type": tarfile.LNKTYPE, "linkname": "/etc/passwd"},
        "device": {"name": "zero", "type": tarfile.CHRTYPE, "devmajor": 1, "devminor": 5},
        "pipe": {"name": "pipe", "type": tarfile.FIFOTYPE},
        "sparse": {"name": "sparse", "pax_headers": {"GNU.sparse.major": "1", "GNU.sparse.realsize": str(1 << 40)}},
        "giant header": {"name": "giant", "pax_headers": {"comment": "a" * 3_000_000}},
        "other encoding": {"name": "\udce9\udcff"},
        **{f"tiny {number}": {"name": f"{number}"} for number in range(3000)},
    }
    with tarfile.open(path, "w", format=tarfile.PAX_FORMAT, errors="surrogateescape") as archive:
        for fields in members.values():
            info = tarfile.TarInfo()
            for field, value in fields.items():
                setattr(info, field, value)
            archive.addfile(info)


@pytest.mark.parametrize(
    "command",
    [
        name if name in ("verify", "inspect", "export") else pytest.param(name, marks=pytest.mark.faults)
        for name in COMMANDS
    ],
)
def test_an_archive_is_no_dataset_and_is_never_unpacked(command, trap, tmp_path):
    """In the place of the dataset, and of a file in it."""
    data, ends = trap
    shutil.rmtree(data)
    hostile_archive(data, tmp_path)
    wrong = [what for what in ends(command, "metadata.json") if not what.startswith("exit code 2")]
    assert wrong == []
    assert {path.name for path in tmp_path.iterdir()} == {"data", "about.yaml", "secret"}


@pytest.mark.faults
@pytest.mark.parametrize("kind", STRANGE)
@pytest.mark.parametrize("command", ["status", "verify", "repair"])
def test_no_strange_file_stops_the_commands_that_look_after_a_dataset(command, kind, trap, release):
    assert wrong_ends(command, FILES, STRANGE[kind], trap, release) == []


@pytest.mark.faults
@pytest.mark.parametrize("kind", STRANGE)
@pytest.mark.parametrize("command", [command for command in COMMANDS if command not in {"status", "verify", "repair"}])
def test_no_strange_file_stops_a_command_that_reads_a_dataset(command, kind, trap, release):
    assert wrong_ends(command, READ_BY_MOST, STRANGE[kind], trap, release) == []


@pytest.mark.faults
@pytest.mark.parametrize("command", COMMANDS)
def test_no_folder_that_leads_elsewhere_is_followed(command, trap, release):
    """Of a dataset that is reached through a link itself, which is nothing strange."""
    data, _ = trap
    assert wrong_ends(command, FOLDERS, lambda path, _: path.symlink_to("/etc"), trap, release) == []
    data.rename(data.with_name("real"))
    data.symlink_to("real")
    assert main(["verify", str(data)]) == 0
