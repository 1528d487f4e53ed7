"""What several packages' tests need of the machine."""

import os
import signal
import subprocess

import pytest


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
