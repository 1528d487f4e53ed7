"""A quota that is used up at any write of a command: one line, exit code 5, and the same command again completes it."""

import errno
import shutil
from pathlib import Path

import pytest

OPERATIONS = {"write", "create", "mkdir", "rename", "replace", "fsync"}
RELEASE, OUT = "RELEASE", "OUT"
COMMANDS = {
    "bag": ["bag", RELEASE, "--out", OUT],
    "download": ["download", f"file://{RELEASE}", "--out", OUT],
    "upload": ["upload", RELEASE, f"file://{OUT}"],
    "export": ["export", RELEASE, "--format", "tum,webdataset", "--out", OUT],
    "report": ["report", RELEASE, "--out", f"{OUT}.html"],
    "contact-sheet": ["contact-sheet", RELEASE, "--out", f"{OUT}.jpg"],
    "firmware": ["firmware", "--out", OUT],
}
WHOLE_OR_NOT_THERE = {"bag", "download", "export", "report", "contact-sheet", "firmware"}
SHORT = ("bag", "contact-sheet")


@pytest.mark.parametrize(
    "name", [name if name in SHORT else pytest.param(name, marks=pytest.mark.faults) for name in COMMANDS]
)
def test_it_says_so_and_the_same_command_again_completes_it(name, server, tree, tmp_path):
    """In the middle of the writing."""
    under_faults(name, lambda steps: steps[len(steps) // 2 : len(steps) // 2 + 1], server, tree, tmp_path)


@pytest.mark.faults
@pytest.mark.parametrize("name", COMMANDS)
def test_at_every_operation_it_says_so_and_the_same_command_again_completes_it(name, server, tree, tmp_path):
    under_faults(name, lambda steps: steps, server, tree, tmp_path)


def under_faults(name, chosen, server, tree, tmp_path: Path) -> None:
    release, work = tmp_path / "release", tmp_path / "work"
    assert server.release(release).status == 0
    places = {RELEASE: str(release), OUT: str(work / "out")}
    arguments = [argument.replace(RELEASE, places[RELEASE]).replace(OUT, places[OUT]) for argument in COMMANDS[name]]

    def run(**fault):
        work.mkdir(exist_ok=True)
        return server.release(work, arguments=arguments, **fault)

    undisturbed = run(root=str(work))
    assert undisturbed.status == 0, undisturbed.err
    whole = tree(work)
    steps = [at for at, (kind, _) in enumerate(undisturbed.operations, 1) if kind in OPERATIONS]
    for at in chosen(steps):
        shutil.rmtree(work)
        ended = run(root=str(work), at=at, error=errno.EDQUOT)
        what = f"{name}, {undisturbed.operations[at - 1]}: {ended.err}"
        if ended.status == 0:  # of a folder that is there already
            continue
        messages = [line for line in ended.err.splitlines() if line.startswith("symolo: ")]
        assert (ended.status, len(messages), "Traceback" in ended.err) == (5, 1, False), what
        assert "quota" in messages[0], what
        there = {path: digest for path, digest in tree(work).items() if not path.startswith(".") and "/." not in path}
        assert there.items() <= whole.items(), what
        assert name not in WHOLE_OR_NOT_THERE or there in ({}, whole), what
        again = run()
        assert again.status == 0 or (there == whole and "is there already" in again.err), again.err
        assert tree(work) == whole, what
