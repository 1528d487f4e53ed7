"""No test is left out without a report, and what tests need of the machine is asked for by name."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SILENT = re.compile(
    r"\b(collect_ignore\w*|pytest_ignore_collect|importorskip|skipif|skipUnless|xfail)\b|pytest\.skip|mark\.skip"
)


def run_pytest(*arguments, **variables):
    """Run pytest in this tree as a user would type it, and not as a part of this test run."""
    inherited = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *arguments],
        cwd=ROOT,
        env=inherited | variables,
        capture_output=True,
        text=True,
        check=False,
    )


def test_no_test_file_can_leave_out_tests_silently():
    files = set((ROOT / "tests").rglob("*.py")) - {Path(__file__)}
    places = [f"{path.name}: {word.group()}" for path in files for word in SILENT.finditer(path.read_text())]
    assert places == []


def test_recordings_are_asked_for_by_the_option_that_names_them():
    ended = run_pytest("-m", "recordings")
    assert ended.returncode == pytest.ExitCode.USAGE_ERROR
    assert "type `python -m pytest -m recordings --recordings=DIR`" in ended.stderr


def test_a_folder_of_recordings_that_is_not_there_is_refused(tmp_path):
    ended = run_pytest("-m", "recordings", f"--recordings={tmp_path / 'nowhere'}")
    assert ended.returncode == pytest.ExitCode.USAGE_ERROR
    assert "nowhere: there is no such folder" in ended.stderr


def test_a_choice_of_tests_whose_tools_are_missing_is_refused():
    ended = run_pytest("-m", "board", PATH="")
    assert ended.returncode == pytest.ExitCode.USAGE_ERROR
    assert "tests marked `board` need missing tools: apt-get install -y gcc" in ended.stderr


@pytest.mark.parametrize("processes", ["-n0", pytest.param("-n1", marks=pytest.mark.long)])
def test_tests_without_their_tools_are_deselected_reported_and_counted(processes):
    """All tests of test_messages.py compile the firmware for this machine, and have no other marker."""
    ended = run_pytest(processes, "tests/hil/firmware/test_messages.py", PATH="")
    assert ended.returncode == pytest.ExitCode.NO_TESTS_COLLECTED
    assert "tests marked `compiler` are deselected, because their tools are missing: apt-get install" in ended.stdout
    count = re.search(r"^=+ (\d+) deselected in", ended.stdout, re.MULTILINE)
    assert int(count.group(1)) > 10
