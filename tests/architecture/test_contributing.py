"""The walk-throughs of CONTRIBUTING.md work as they stand there, performed on one copy of the packages."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from configs.effects.registry import EFFECTS
from tests.release_fixtures import ONE_ROUTE

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "CONTRIBUTING.md").read_text()
PACKAGES = ("configs", "logs", "physics", "sensors", "hil", "diagnosis", "blender_scenes", "pipeline", "symolo")
BESIDE = ("benchmarks", "docs", "tests")
BLOCK = re.compile(r"^```(\w+)\n# (\S+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
NEW_FILES = {name: text for kind, name, text in BLOCK.findall(PAGE) if kind == "python"}


@dataclass(frozen=True)
class Walk:
    """What one section of the page says to do."""

    folder: Path
    """The copy, with every block of the page in its place."""
    commands: tuple[str, ...]
    """Words after `symolo`, in the order of the section."""
    scripts: tuple[str, ...]
    """Words after `.venv/bin/python`, in the order of the section; the last runs tests, and the others write files."""

    def symolo(self, *arguments: str) -> str:
        """Return what the command prints; it must end with exit code 0."""
        return self.python("-P", "-c", "import sys; from pipeline.cli import main; sys.exit(main())", *arguments)

    def python(self, *arguments: str) -> str:
        """Return what the interpreter prints; it must end with exit code 0."""
        done = subprocess.run(
            [sys.executable, *arguments],
            cwd=self.folder,
            env={**os.environ, "PYTHONPATH": str(self.folder)},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    def type_commands(self, *more: str) -> str:
        """Return what the section's commands print, with some settings added that make them small."""
        return "".join(self.symolo(*shlex.split(command), *more) for command in self.commands)


def _section(title: str) -> str:
    return PAGE.partition(f"\n## {title}\n")[2].partition("\n## ")[0]


def _in_braces(pattern: str) -> list[str]:
    """Return `a1b` and `a2b` for `a{1,2}b`, as a shell does."""
    before, brace, rest = pattern.partition("{")
    inner, _, after = rest.partition("}")
    return [before + one + after for one in inner.split(",")] if brace else [pattern]


def _apply(folder: Path, kind: str, name: str, text: str) -> None:
    path = folder / name
    if kind != "diff":
        assert not path.exists(), f"{name} is there already"
        path.write_text(text)
        return
    content = path.read_text()
    for hunk in text.split("@@\n"):
        old = "".join(line[1:] for line in hunk.splitlines(keepends=True) if line[0] != "+")
        new = "".join(line[1:] for line in hunk.splitlines(keepends=True) if line[0] != "-")
        assert content.count(old) == 1, f"{name}: these lines are there {content.count(old)} times:\n{old}"
        content = content.replace(old, new)
    path.write_text(content)


SECTIONS = (
    "An effect",
    "A sensor",
    "A shape of an obstacle",
    "A material",
    "An export format",
    "An importer",
    "A section of the diagnosis report",
    "A robot",
)


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """The packages with every block of the page in its place: what one section adds does not disturb the others."""
    folder = tmp_path_factory.mktemp("copy")
    for package in (*PACKAGES, *BESIDE):
        # With the compiled files, which stay valid because a copy keeps the times of the sources, but without those
        # that another process is about to rename.
        shutil.copytree(ROOT / package, folder / package, ignore=shutil.ignore_patterns("*.pyc.*"))
    shutil.copy2(ROOT / "pyproject.toml", folder)
    for title in SECTIONS:
        blocks = BLOCK.findall(_section(title))
        assert blocks, f"CONTRIBUTING.md has no section {title!r} with blocks"
        for kind, name, text in blocks:
            _apply(folder, kind, name, text)
    return folder


@pytest.fixture
def walk(copy):
    def follow(title: str) -> Walk:
        commands, scripts = (
            tuple(re.findall(rf"^    {program} (.+)$", _section(title), re.MULTILINE))
            for program in ("symolo", r"\.venv/bin/python")
        )
        return Walk(copy, commands, scripts)

    return follow


@pytest.mark.documents
def test_an_effect_acts_and_is_looked_for(walk):
    effect = walk("An effect")
    effect.type_commands()
    effect.symolo("simulate", "smoke", "--set", "stop.time_limit_s=5", "--out", "bare")
    ripple, bare = (
        np.load(effect.folder / out / ".stages/simulate/CCW/test_1/trajectory.npz")["series/tof_m/m/values"]
        for out in ("ripple", "bare")
    )
    assert 0.001 < np.nanmax(np.abs(ripple[0] - bare[0])) < 0.022  # the first row: the robot has not moved yet
    assert "tof_ripple" in (effect.folder / "ripple-diagnosis/report.html").read_text()


def test_the_class_of_the_page_is_loaded_from_any_file(tmp_path):
    path = tmp_path / "tof_ripple.py"
    path.write_text(NEW_FILES["sensors/effects/range_sensor/tof_ripple.py"])
    effect = EFFECTS.load(path)
    assert effect.name == "tof_ripple"
    EFFECTS.unload(path)


@pytest.mark.documents
def test_a_sensor_is_recorded_released_and_verified(walk, tiny):
    sensor = walk("A sensor")
    release, verify = sensor.commands
    sensor.symolo(*shlex.split(release), *tiny, f"--set={ONE_ROUTE}", "--workers", "1")
    assert "no fault" in sensor.symolo(*shlex.split(verify))
    run = sensor.folder / "with-compass/CW/test_1"
    heading, theta = (
        np.genfromtxt(run / name, delimiter=",", names=True)[column]
        for name, column in (("side/compass.csv", "heading"), ("data.csv", "theta"))
    )
    error_rad = np.angle(np.exp(1j * (heading - theta)))
    assert 0.0 < np.abs(error_rad).max() < np.radians(5 * 2.0)  # five standard deviations


def test_a_shape_is_simulated(walk):
    shape = walk("A shape of an obstacle")
    shape.type_commands("--set", "stop.time_limit_s=0.5")
    spec = json.loads((shape.folder / "with-ramp/.stages/simulate/CW/test_1/spec.json").read_text())
    assert spec["arena"]["obstacles"][0]["size"] == [0.2, 0.1, 0.05]


@pytest.mark.documents
def test_a_material_is_described_previewed_and_rendered(walk):
    material = walk("A material")
    material.type_commands("--width-px", "32")
    assert (material.folder / "felt.jpg").stat().st_size > 0
    program = (
        "from blender_scenes.materials import FLOORS; from blender_scenes.materials.base import SurfacePatch;"
        "from blender_scenes.scene.typical import typical_color;"
        "from configs.schema.appearance.floors import FloorLook;"
        "print(typical_color(FLOORS['felt'](FloorLook(), SurfacePatch('floor', (1.0, 1.0), 1))))"
    )
    done = subprocess.run(
        [sys.executable, "-P", "-c", program],
        cwd=material.folder,
        env={**os.environ, "PYTHONPATH": str(material.folder)},
        capture_output=True,
        text=True,
        check=True,
    )
    red, green, blue = (float(number) for number in done.stdout.strip("()\n").split(","))
    assert 0.2 < green < 0.4  # the default paint reflects 0.3
    assert blue > red  # and is bluish


def test_an_export_format_is_listed_and_written(walk, dataset):
    exporter = walk("An export format")
    (exporter.folder / "smoke-dataset").symlink_to(dataset)
    exporter.type_commands()
    lines = (exporter.folder / "smoke-jsonl/jsonl/poses.jsonl").read_text().splitlines()
    images = sorted((exporter.folder / "smoke-jsonl/jsonl/images").rglob("*.jpg"))
    assert len(lines) == len(images) == len(list(dataset.glob("*/*/images/*.jpg")))


def test_an_importer_recognises_and_reads_its_log(walk):
    importer = walk("An importer")
    printed = importer.type_commands()
    assert re.search(r"omega_rad_s", printed)
    assert "6 rows" in printed


@pytest.mark.documents
def test_a_section_is_on_the_page_of_a_diagnosis(walk):
    section = walk("A section of the diagnosis report")
    section.type_commands()
    html = (section.folder / "tof-diagnosis/report.html").read_text()
    headings = re.findall("<h2>(.*?)</h2>", html)
    assert headings[headings.index("The misfit") + 1] == "Readings that cannot be used"
    assert "<th>share of its readings</th>" in html


def test_a_robot_is_read_and_drives(walk):
    robot = walk("A robot")
    printed = robot.type_commands()
    assert "2 of 2 runs" in printed
    assert '"track_m": 0.12' in (robot.folder / "small/.stages/simulate/CW/test_1/spec.json").read_text()


CHOSEN = (
    "tof_ripple or ramp or shared_format or row_of_the_documentation or key_of_the_schema or felt or member"
    " or the_tape_is_black or has_its_joints or has_an_image or materials.md or rpm-bench or different_names"
    " or small_robot or every_page_is"
)
"""Of the tests that the page names, those about what it adds; the others run on the project itself."""


@pytest.mark.documents
def test_the_scripts_and_tests_that_the_page_names_end_well(walk):
    walks = [walk(title) for title in SECTIONS]
    anywhere = walks[0]
    shutil.copy2(anywhere.folder / "small_robot.yaml", anywhere.folder / "configs/robots/small_robot.yaml")
    for script in dict.fromkeys(script for one in walks for script in one.scripts[:-1]):
        anywhere.python(*shlex.split(script.replace("FOLDER", "scratch")))
    named = [shlex.split(script)[2:] for one in walks for script in one.scripts[-1:]]
    files = dict.fromkeys(file for patterns in named for pattern in patterns for file in _in_braces(pattern))
    printed = anywhere.python("-m", "pytest", *files, "-n", "0", "-q", "-p", "no:cacheprovider", "-k", CHOSEN)
    assert re.search(r"^\d+ passed", printed, re.MULTILINE), printed


@pytest.mark.parametrize("name", NEW_FILES)
def test_ruff_finds_nothing_in_the_code_of_the_page(name):
    for options in (["check"], ["format", "--check"]):
        call = [sys.executable, "-m", "ruff", *options, "--no-cache", "--stdin-filename", str(ROOT / name), "-"]
        done = subprocess.run(call, input=NEW_FILES[name], capture_output=True, text=True, check=False, cwd=ROOT)
        assert done.returncode == 0, done.stdout + done.stderr
