"""What `./setup` installs on Debian, with stand-ins for Debian's tools, and what `.ci/run` copies."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from blender_scenes.render.surroundings import SYSTEM_PACKAGES
from hil.tools import HIL_PACKAGES

ROOT = Path(__file__).parents[2]
APT = "-q -o DPkg::Lock::Timeout=300"


@pytest.fixture
def setup(tmp_path):
    """Run ./setup on a Debian with the packages `installed` and no Python; return how it ends and the calls of apt."""
    tools, calls = tmp_path / "tools", tmp_path / "calls"
    tools.mkdir()
    for name in ("dirname", "env", "grep", "head", "sed", "true"):
        (tools / name).symlink_to(shutil.which(name))

    def stand_in(name, text):
        (tools / name).write_text(f"#!/bin/sh\n{text}\n")
        (tools / name).chmod(0o755)

    def run(*, user=0, sudo="exit 1", apt="exit 0", installed="", **variables):
        stand_in("id", f"echo {user}")
        stand_in("sudo", sudo)
        stand_in("dpkg-query", f'case " {installed} " in *" $4 "*) echo install ok installed ;; *) exit 1 ;; esac')
        stand_in("apt-get", f'echo "$DEBIAN_FRONTEND: $*" >>{calls}; {apt}')
        ended = subprocess.run(
            ["/bin/sh", ROOT / "setup"],
            env={"PATH": str(tools), **variables},
            capture_output=True,
            text=True,
            check=False,
            stdin=subprocess.DEVNULL,
        )
        return ended, calls.read_text().splitlines() if calls.exists() else []

    return run


def apt_calls(packages):
    return [f"noninteractive: {APT} update", f"noninteractive: {APT} install -y --no-install-recommends {packages}"]


def test_root_gets_python_and_the_libraries_of_blender(setup):
    ended, calls = setup()
    assert calls == apt_calls(f"python3.11-venv {SYSTEM_PACKAGES}")
    assert ended.returncode == 5  # the stand-in for apt-get has installed no Python
    assert "setup: python3.11 is missing" in ended.stderr


def test_who_may_use_sudo_without_a_password_gets_the_same(setup):
    _, calls = setup(user=1000, sudo='[ "$1" = -n ] && shift && exec "$@"')
    assert calls == apt_calls(f"python3.11-venv {SYSTEM_PACKAGES}")


def test_who_may_not_install_gets_the_line_to_type(setup):
    ended, calls = setup(user=1000)
    assert (ended.returncode, calls) == (5, [])
    line = f"apt-get update && apt-get install -y --no-install-recommends python3.11-venv {SYSTEM_PACKAGES}"
    assert ended.stderr == f"setup: system packages are missing; type as root: {line}\n"


def test_tools_for_hardware_in_the_loop_are_installed_on_request(setup):
    _, calls = setup(SYSTEM="hil")
    assert calls == apt_calls(f"python3.11-venv {SYSTEM_PACKAGES} {HIL_PACKAGES}")


def test_only_what_is_missing_is_installed(setup):
    _, calls = setup(installed=" ".join(SYSTEM_PACKAGES.split()[1:]))
    assert calls == apt_calls(f"python3.11-venv {SYSTEM_PACKAGES.split()[0]}")
    _, again = setup(installed=f"python3.11-venv {SYSTEM_PACKAGES}")
    assert again == calls


def test_a_named_python_is_not_installed(setup):
    ended, calls = setup(PYTHON="/elsewhere/python")
    assert calls == apt_calls(SYSTEM_PACKAGES)
    assert "/elsewhere/python is missing" in ended.stderr


def test_packages_that_apt_cannot_install_end_it(setup):
    ended, calls = setup(apt="exit 100")
    assert (ended.returncode, len(calls)) == (5, 1)
    assert f"setup: apt-get could not install python3.11-venv {SYSTEM_PACKAGES}" in ended.stderr


def test_another_value_of_system_is_refused(setup):
    ended, calls = setup(SYSTEM="hill")
    assert (ended.returncode, calls) == (5, [])
    assert ended.stderr == "setup: SYSTEM=hill is not known; the only value is hil\n"


GIT = """\
case $1 in
rev-parse) pwd -P ;;
ls-files) printf '%s\\0' .ci/run .gitignore deleted.txt setup 'with blank.txt' ;;
esac
"""
"""A stand-in, since a machine that runs the tests need not have git; deleted.txt is not in the folder any more."""
FILES = {
    "clone": [".ci", ".gitignore", "setup", "with blank.txt"],
    "folder": [".ci", ".gitignore", "out", "setup", "with blank.txt"],
}


@pytest.mark.parametrize("tree_is", FILES)
def test_ci_runs_in_a_copy_with_nothing_beside_it(tmp_path, tree_is):
    """The ./setup of this tree reports what lies in its folder and beside it, and ends there."""
    tree, tools = tmp_path / "place" / "tree", tmp_path / "tools"
    for folder in (tree / ".ci", tree / ".venv", tree / "out", tree / "../neighbour", tools):
        folder.mkdir(parents=True)
    shutil.copy(ROOT / ".ci/run", tree / ".ci/run")
    (tree / "setup").write_text("#!/bin/sh\necho $SYSTEM; ls -A1 . ..; exit 5\n")
    (tree / ".gitignore").write_text("/.venv/\n/out/\n")
    (tree / "with blank.txt").touch()
    (tools / "git").write_text("#!/bin/sh\n" + (GIT if tree_is == "clone" else "exit 128\n"))
    for program in (tree / "setup", tools / "git"):
        program.chmod(0o755)
    ended = subprocess.run(
        [shutil.which("bash"), tree / ".ci/run"],
        env=os.environ | {"CI": "true", "PATH": f"{tools}:{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        check=False,
        stdin=subprocess.DEVNULL,
    )
    assert ended.returncode == 5
    assert ended.stdout.splitlines() == ["hil", ".:", *FILES[tree_is], "", "..:", "symolo"]
