"""What docs/tutorials and docs/baselines.md tell people to type: all of it is there, and what is quick is run."""

import re
import shlex
import shutil
from functools import cache
from pathlib import Path

import pytest
from typer.main import get_command

from configs.loader import load_scenario, load_section
from pipeline.cli import command_line, main

DOCS = Path(__file__).parents[3] / "docs"
PAGES = (DOCS / "baselines.md", *sorted((DOCS / "tutorials").glob("*.md")))
QUICK = {"status", "verify", "repair", "bag", "compare", "contact-sheet", "export", "plan"}
"""Those that are run on a small release of the scenario `smoke`; `baselines` once more, in its own test."""
IS_MADE = "release smoke --out data"
COMMAND = re.compile(r"^ {4,}symolo (.+)$", re.MULTILINE)
BLOCK = re.compile(r"^```(python|yaml)\n(.*?)^```", re.MULTILINE | re.DOTALL)
ALL = [(page, command) for page in PAGES for command in COMMAND.findall(page.read_text())]
EACH_ONCE = sorted({command for _, command in ALL})
scenario = cache(load_scenario)


@pytest.fixture(scope="module")
def at_work(dataset, tmp_path_factory):
    """A folder in which somebody has made `data` and `before`, found the robot in it, and saved the scenarios."""
    folder = tmp_path_factory.mktemp("tutorial")
    for name in ("data", "before", "symolo-dataset"):
        shutil.copytree(dataset, folder / name)
    for page in PAGES:
        for kind, text in BLOCK.findall(page.read_text()):
            if kind == "yaml":
                (folder / re.match(r"# (\S+\.yaml)\n", text).group(1)).write_text(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert main(["baselines", "data", "--out", "found", "--methods", "odometry"]) == 0
    return folder


def test_there_are_five_tutorials_with_commands():
    names = {"teacher", "student", "researcher", "release_engineer", "ci"}
    assert {page.stem for page in PAGES} == names | {"baselines"}
    assert {page.stem for page, _ in ALL} == names | {"baselines"}
    assert sum(command.startswith(IS_MADE) for _, command in ALL) == 3


@pytest.mark.parametrize("command", EACH_ONCE)
def test_a_command_of_a_tutorial_is_one(command, at_work, monkeypatch):
    """It parses, and the scenario, the robot, the looks and the settings that it names are there."""
    monkeypatch.chdir(at_work)
    name, *arguments = shlex.split(command)
    leaf = get_command(command_line()).get_command(None, name)
    assert leaf is not None, f"no command {name}"
    values = leaf.make_context(name, arguments).params
    if values.get("scenario"):
        scenario(values["scenario"], tuple(values["settings"] or ()))
    for look in ",".join(values.get(option) or "" for option in ("look", "looks")).split(","):
        if look:
            load_section("look", look)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_what_is_quick_runs_as_it_stands_there(page, at_work, tmp_path, monkeypatch):
    """In the order of the page; each output goes where the page says, in a folder of this test's own."""
    for entry in at_work.iterdir():
        (tmp_path / entry.name).symlink_to(entry)
    monkeypatch.chdir(tmp_path)
    for command in COMMAND.findall(page.read_text()):
        name, *arguments = shlex.split(command)
        if name in QUICK and "preview.jpg" not in arguments:
            assert main([name, *arguments]) == 0, command
    for kind, text in BLOCK.findall(page.read_text()):
        if kind == "python":
            exec(compile(text, f"{page.name}", "exec"), {"__name__": "tutorial"})  # noqa: S102 - our own pages


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_link_of_a_tutorial_leads_somewhere(page):
    for link in re.findall(r"\]\(([^)]+)\)", page.read_text()):
        name, _, heading = link.partition("#")
        target = (page.parent / name).resolve() if name else page
        assert target.is_file(), link
        headings = re.findall(r"^#+ (.+)$", target.read_text(), re.MULTILINE)
        anchors = {re.sub(r"[^\w\- ]", "", one.lower()).replace(" ", "-") for one in headings}
        assert not heading or heading in anchors, (link, sorted(anchors))
