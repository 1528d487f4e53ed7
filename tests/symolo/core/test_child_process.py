"""The channel between an owner and its child, with small children that misbehave in one way each."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated

import pytest
from pydantic import Field, TypeAdapter

from symolo.core.child_process import SCRATCH, Alive, ChildProcess, Failed, Finished, Message


class Work(Message):
    pass


Messages = TypeAdapter(Annotated[Alive | Finished | Failed, Field(discriminator="kind")])

CHILD = """
from symolo.core.child_process import Finished, Owner
import os, subprocess, sys, time
owner = Owner()
owner.next_request()
{work}
owner.send(Finished())
owner.next_request()
"""


@pytest.fixture
def started() -> Iterator[Callable[[str], ChildProcess]]:
    children = []

    def start(work: str, *, own_group: bool = False) -> ChildProcess:
        command = sys.executable, "-c", CHILD.format(work=work)
        children.append(ChildProcess("the child", command, Messages, os.environ, own_group=own_group))
        return children[-1]

    yield start
    for child in children:
        child.close()


def _runs(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def _wait_until_gone(process: int) -> None:
    for _ in range(200):
        if not _runs(process):
            return
        time.sleep(0.05)
    raise AssertionError("the process did not end within 10 s")


def test_what_an_engine_prints_is_a_log_and_no_message(started):
    child = started("print('chatter'); subprocess.run(['echo', 'more chatter'])")
    assert list(child.ask(Work())) == [Finished()]
    assert "more chatter" in child.last_lines(5)


@pytest.mark.parametrize(
    ("work", "limits", "reason"),
    [
        (
            "os.kill(os.getpid(), 9)",
            {},
            "was ended by signal SIGKILL (too little memory? Take fewer --workers or smaller",
        ),
        ("os._exit(3)", {}, "the child was ended by exit code 3"),
        ("os.kill(os.getpid(), 19)", {"silence_s": 0.5}, "it did not respond for 0.5 s"),
        ("time.sleep(60)", {"patience_s": 0.5}, "it made no progress in 0.5 s"),
        ("time.sleep(60)", {"patience_s": 0.1, "start_s": 0.5}, "it made no progress in 0.5 s"),
        ("x = b'x' * 300_000_000; time.sleep(60)", {"memory_bytes": 200_000_000}, "0.20 GB are allowed"),
    ],
)
def test_a_child_that_dies_hangs_or_takes_too_much_ends_in_one_failure_that_says_why(started, work, limits, reason):
    child = started(work)
    (failed,) = child.ask(Work(), **limits)
    assert failed.error == "killed"
    assert reason in failed.text
    assert not child.alive


def test_a_child_of_a_child_ends_with_its_group(started, tmp_path):
    note = tmp_path / "process"
    child = started(f"open({str(note)!r}, 'w').write(str(subprocess.Popen(['sleep', '60']).pid))", own_group=True)
    assert list(child.ask(Work())) == [Finished()]
    grandchild = int(note.read_text())
    assert _runs(grandchild)
    child.close()
    _wait_until_gone(grandchild)


def test_a_child_whose_owner_is_killed_removes_its_scratch_folder_and_ends(tmp_path):
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    program = (
        "import os, subprocess, sys\n"
        f"child = subprocess.Popen([sys.executable, '-c', {CHILD.format(work='time.sleep(60)')!r}],"
        " stdin=subprocess.PIPE)\n"
        "print(child.pid, flush=True)\n"
        "os.kill(os.getpid(), 9)"
    )
    environment = {**os.environ, SCRATCH: str(scratch)}
    owner = subprocess.run([sys.executable, "-c", program], env=environment, stdout=subprocess.PIPE, check=False)
    _wait_until_gone(int(owner.stdout.split()[0]))
    assert not scratch.exists()


def test_a_child_is_ended_where_no_thread_can_read_its_messages(monkeypatch):
    started = []

    class NotedPopen(subprocess.Popen):
        def __init__(self, *arguments, **options):
            super().__init__(*arguments, **options)
            started.append(self)

    def refuse(_thread):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(subprocess, "Popen", NotedPopen)
    monkeypatch.setattr("threading.Thread.start", refuse)
    open_before = len(list(Path("/proc/self/fd").iterdir()))
    with pytest.raises(RuntimeError, match="new thread"):
        ChildProcess("the child", (sys.executable, "-c", "input()"), Messages, os.environ)
    (child,) = started
    assert child.returncode is not None, "the child still runs, or nobody has waited for it"
    assert len(list(Path("/proc/self/fd").iterdir())) == open_before
