"""Commands of docs/tutorials and of the pages on baselines: what is quick is run as it stands there."""

import re
import shlex
import shutil
from pathlib import Path

import pytest

from pipeline.cli import main

DOCS = Path(__file__).parents[3] / "docs"
PAGES = (DOCS / "baselines.md", DOCS / "own_estimates.md", *sorted((DOCS / "tutorials").glob("*.md")))
QUICK = {"status", "verify", "repair", "bag", "compare", "contact-sheet", "view", "export", "plan"}
"""Those that are run on a small release of the scenario `smoke`; `baselines` once more, in its own test."""
IS_MADE = "release smoke --out data"
COMMAND = re.compile(r"^ {4,}symolo (.+)$", re.MULTILINE)
BLOCK = re.compile(r"^```(python|yaml)\n(.*?)^```", re.MULTILINE | re.DOTALL)
ALL = [(page, command) for page in PAGES for command in COMMAND.findall(page.read_text())]


@pytest.fixture(scope="module")
def at_work(dataset, tmp_path_factory):
    """A folder with the datasets of the pages, the places of the robot in `data`, and the scenarios of the pages."""
    folder = tmp_path_factory.mktemp("tutorial")
    for name in ("data", "study", "before", "fast", "symolo-dataset", "worn"):
        shutil.copytree(dataset, folder / name)
    shutil.copytree(dataset / "CW/test_1", folder / "mystery/clockwise")
    (folder / "mystery/clockwise/side/spec.json").unlink()
    for page in PAGES:
        for kind, text in BLOCK.findall(page.read_text()):
            # Scenarios begin with the name of their file; workflows do not.
            if kind == "yaml" and (named := re.match(r"# (\S+\.yaml)\n", text)):
                (folder / named[1]).write_text(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert main(["baselines", "data", "--out", "errors", "--methods", "odometry"]) == 0
    return folder


def test_there_are_five_tutorials_with_commands():
    names = {"teacher", "student", "researcher", "release_engineer", "ci"}
    assert {page.stem for page in PAGES} == names | {"baselines", "own_estimates"}
    assert {page.stem for page, _ in ALL} == names | {"baselines", "own_estimates"}
    assert sum(command.startswith(IS_MADE) for _, command in ALL) == 3


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_what_is_quick_runs_as_it_stands_there(page, at_work, tmp_path, monkeypatch):
    """In the order of the page; each output goes where the page says, in a folder of this test's own."""
    for entry in at_work.iterdir():
        (tmp_path / entry.name).symlink_to(entry)
    monkeypatch.chdir(tmp_path)
    for command in COMMAND.findall(page.read_text()):
        # What a shell does after another exit code is not run: the command ends with 0.
        name, *arguments = shlex.split(command.partition(" || ")[0])
        if name in QUICK and "preview.jpg" not in arguments:
            assert main([name, *arguments]) == 0, command
    for kind, text in BLOCK.findall(page.read_text()):
        if kind == "python":
            exec(compile(text, f"{page.name}", "exec"), {"__name__": "tutorial"})  # noqa: S102 - our own pages
