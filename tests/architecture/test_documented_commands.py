"""Every command of README.md and docs is one; and each runs, made small, in the order of its page (`-m documents`)."""

import itertools
import math
import re
import shlex
import shutil
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import pytest

from configs.effects.registry import EFFECTS
from configs.loader import load_scenario, load_section
from physics.control.program import PROGRAM
from physics.control.registry import CONTROLLERS
from pipeline.cli import command_line, main
from pipeline.commands.options import ALL_LOOKS

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "diagnosis/examples"
PAGES = [
    ROOT / "README.md",
    *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "docs/exports").glob("*.md")),
    *sorted((ROOT / "docs/tutorials").glob("*.md")),
]
CODE = re.compile(r"^    ([^\n]+)$|^```\w*\n(.*?)^```", re.MULTILINE | re.DOTALL)
REFUSED = re.compile(r"^    symolo (.+)\n+    symolo: ", re.MULTILINE)
"""Commands below which the page quotes the message by which they are refused."""

ELSEWHERE = {
    "--port": "needs a board; tests/hil drives one at a pseudo-terminal",
    "--executor ray": "needs a cluster; tests/pipeline/executors/test_ray.py makes one",
    "--device gpu": "needs a card; tests/pipeline/executors/test_cards.py sees to who gets which",
    "file://": "leads out of the desk; tests/pipeline/storage goes there and back",
    "s3://": "needs a server; tests/symolo/storage/test_s3.py starts one",
    "gs://": "needs an account",
    "$SLURM": "the same with numbers stands on the page too",
    "measured/run_1": "needs pictures that show the line; tests/pipeline/diagnosing/test_identify_camera.py has some",
    "camera/robot.yaml": "likewise; the robot file of that command",
    "photos/*.jpg": "needs photographs; tests/pipeline/look_from_photographs/test_look_from.py draws some",
    "DIR/img.png": "likewise",
    "my_look/": "likewise; the look of that command",
    "hidden": "as it stands there, in tests/pipeline/diagnosing/test_round_trip.py",
    "explained": "as it stands there, in tests/pipeline/diagnosing/test_own_effect_walk.py",
    "extracted": "needs a release with an effect of its own; tests/contracts/test_effect_files.py makes one",
    "mine=estimates": "needs the files of a program; tests/pipeline/baselines/test_own_estimates.py writes some",
    "model.npz": "needs PyTorch; tests/pipeline/baselines/learned/test_training.py trains one",
    "--together": "needs cases of one robot; tests/pipeline/diagnosing/test_diagnose.py makes some",
    "--like diagnosis --out data": "likewise; the diagnosis of that command",
    "compass.py": "the sensor of CONTRIBUTING.md; tests/contracts/test_own_sensor.py loads such a file",
    "my_bench": "a bench of the reader; test_quoted_outputs.py runs the one of the page",
    "cases/*/": "needs cases that the command of `benchmarks` above it makes",
    "next/next_drive.py": "needs a designed drive; tests/diagnosis/next_trial/test_drives.py designs some",
    "cases/tof_bench": "needs a case that test_quoted_outputs.py makes",
    "law/": "likewise; the law of that command",
    "optiodom_diff": "a minute or more; benchmarks/diagnosis/recordings/real_sets.py runs them",
}
"""Words of commands that are not run here, and where they are."""
SCAN = "x,y,lidar\n" + "".join(
    f"{x},{y},{950 - 800 * math.exp(-((math.hypot(x - 70, y - 70) / 45) ** 4)):.0f}\n"
    for x in range(0, 141, 5)
    for y in range(0, 141, 5)
    for _ in range(3)
)
"""Something round in front of a board, three readings at each point."""
MOCAP = "time_ms,pos_x,pos_y,heading\n" + "".join(
    f"{50 * i},{0.5 * math.cos(0.01 * i):.6f},{0.5 * math.sin(0.01 * i):.6f},{90 + math.degrees(0.01 * i):.5f}\n"
    for i in range(100)
)
"""A robot on a circle, as a camera above it sees it."""
TUM = "".join(
    f"{0.05 * i:.2f} {0.5 * math.cos(0.01 * i):.6f} {0.5 * math.sin(0.01 * i):.6f} 0"
    f" 0 0 {math.sin(math.pi / 4 + 0.005 * i):.6f} {math.cos(math.pi / 4 + 0.005 * i):.6f}\n"
    for i in range(50)
)
"""The same in the format of TUM."""
STATIC_RECORD = "Fs,50.00\nLogging time,20\nd\n" + "100.0\n101.0\n99.0\n103.0\n" * 250
RELEASES = ("data", "symolo-dataset", "my_release", "A", "B")
"""Releases that pages use without making them; a tutorial makes its own."""
SMALL_IMAGES = ("render.width_px=32", "render.height_px=24", "render.samples=1")
SMALL = (*SMALL_IMAGES, "stop.lap=false", "stop.time_limit_s=1.0")


def _commands(page):
    lines = [line for block in CODE.findall(page.read_text()) for part in block for line in part.splitlines()]
    joined = re.sub(r" *\\\n *", " ", "\n".join(lines))
    matches = re.findall(r"^ *(?:.*&& )?(?:\.venv/bin/)?symolo ((?:[^#|>&\n]|(?<=')[^'\n]*')+)", joined, re.MULTILINE)
    return [re.split(r" {3,}", command.strip())[0] for command in matches]


scenario_of = cache(load_scenario)
WITH_COMMANDS = [page for page in PAGES if _commands(page)]
of_pages = pytest.mark.parametrize("page", WITH_COMMANDS, ids=[str(page.relative_to(ROOT)) for page in WITH_COMMANDS])


def test_max_pages_have_commands():
    assert len(WITH_COMMANDS) > 10


@of_pages
def test_its_commands_parse(page, tmp_path, monkeypatch):
    """And the scenarios, looks and settings that they name are there."""
    monkeypatch.chdir(tmp_path)
    _save_files_of(page, tmp_path)
    group, made = command_line(), set()
    for command in _commands(page):
        name, *arguments = shlex.split(command)
        if name.startswith("--"):
            continue
        leaf = group.get_command(None, name)
        assert leaf is not None, command
        if name == "bench":
            leaf, arguments = leaf.get_command(None, arguments[0]), arguments[1:]
        values = leaf.make_context(name, arguments).params
        made.update(after for before, after in itertools.pairwise(arguments) if before == "--out")
        # A scenario that an earlier command of the page makes is not there; nor is a robot that one finds.
        if (scenario := values.get("scenario")) and str(Path(scenario).parent) not in made:
            scenario_of(scenario, tuple(one for one in values["settings"] or () if not one.endswith(".yaml")))
        for look in ",".join(values.get(option) or "" for option in ("look", "looks")).split(","):
            if look not in ("", ALL_LOOKS) and not look.endswith(".yaml"):
                load_section("look", look)
    _forget_files()


def _save_files_of(page, folder):
    """Files that a page says to write: blocks whose first line is a comment with the name of the file."""
    shutil.copytree(ROOT / "examples", folder / "examples", dirs_exist_ok=True)
    text = page.read_text()
    for block in (*re.findall(r"^```(?:yaml|python)\n(.*?)^```", text, re.MULTILINE | re.DOTALL), *_indented(text)):
        if named := re.match(r"# ([\w.-]+\.(?:yaml|py))\b", block):
            (folder / named.group(1)).write_text(block)


def _indented(text):
    return [
        re.sub(r"^    ", "", block, flags=re.MULTILINE) for block in re.findall(r"(?:^    .*\n)+", text, re.MULTILINE)
    ]


@pytest.fixture(scope="session")
def release(tmp_path_factory):
    """What pages call `data` or `symolo-dataset`, the bag of a run of it, and the dataset of README.md."""
    folder = tmp_path_factory.mktemp("documents") / "data"
    kinds = "render.annotations=[depth,instance,semantic,boxes_2d,key_points]"
    assert main(["release", "symolo", "--out", str(folder), *_settings(SMALL), "--set", kinds]) == 0
    bag = ["--format", "mcap", "--runs", "CW/test_1", "--out", str(folder.with_name("bag"))]
    assert main(["export", str(folder), *bag]) == 0
    smoke = ["--out", str(folder.with_name("smoke-dataset")), "--set", "rates.camera_hz=0"]
    assert main(["release", "smoke", *smoke, *_settings(SMALL)]) == 0
    return folder


@pytest.fixture
def desk(tmp_path, release, monkeypatch):
    """Where a reader of a page would be: a release, a robot's logs, a run of a camera, recordings of a range sensor."""
    for name in ("before", *RELEASES):
        shutil.copytree(release, tmp_path / name)
    for name, case in (("bench_1", "motor_steady_002"), ("drive_1", "drive_log_001")):
        shutil.copytree(EXAMPLES / case, tmp_path / "my_robot" / name)
    shutil.copy(EXAMPLES / "drive_log_002/data.csv", tmp_path / "run.csv")
    shutil.copytree(release / "CW/test_1", tmp_path / "measured/run_1")
    for name, text in (("tof_vl53l0x_scan", SCAN), ("tof_vl53l0x_static", STATIC_RECORD)):
        (tmp_path / "measured" / name).mkdir()
        (tmp_path / "measured" / name / "recording.csv").write_text(text)
    (tmp_path / "mocap.csv").write_text(MOCAP)
    (tmp_path / "groundtruth.txt").write_text(TUM)
    shutil.copy(release.with_name("bag") / "mcap/CW/test_1.mcap", tmp_path / "drive.mcap")
    shutil.copytree(release.with_name("smoke-dataset"), tmp_path / "smoke-dataset")
    (tmp_path / "elsewhere").mkdir()
    shutil.copy(release / "CW/test_1/data.csv", tmp_path / "elsewhere/data.csv")
    shutil.copytree(release / "CW/test_1", tmp_path / "mystery/clockwise")
    (tmp_path / "mystery/clockwise/side/spec.json").unlink()
    about = (ROOT / "docs/publishing.md").read_text().partition("```yaml\n")[2].partition("```")[0]
    (tmp_path / "about.yaml").write_text(about)
    plan = np.full((60, 80), 255, np.uint8)
    plan[5:55, 5:75] = 0
    plan[10:50, 10:70] = 255
    cv2.imwrite(str(tmp_path / "plan.png"), plan)
    monkeypatch.setenv("SYMOLO_PASSPHRASE", "correct horse")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.documents
@of_pages
def test_its_commands_run(page, desk):
    """One after another as a reader types them: none finds its output folder taken by an earlier one."""
    _save_files_of(page, desk)
    if page.parent.name == "tutorials":
        for name in RELEASES:
            shutil.rmtree(desk / name)
    made, refused = set(), REFUSED.findall(page.read_text())
    for command in _commands(page):
        if any(word in command for word in ELSEWHERE):
            continue
        words = shlex.split(command)
        out = words[words.index("--out") + 1] if "--out" in words else ""
        if out and out not in made and "--dry-run" not in words and command not in refused:
            _removed(desk / out)  # is there for other pages
            made.add(out)
        _forget_files()
        # What is compared here need not be the same.
        allowed = {2} if command in refused else {0, 7} if words[0] == "compare" else {0}
        assert main(_made_small(words)) in allowed, command
    if page.parent.name == "tutorials":
        for program in re.findall(r"^```python\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL):
            exec(program, {})  # noqa: S102 - our own page


def _forget_files():
    """As a new process would, into which a reader types the next command."""
    PROGRAM.command = ()
    for family in (CONTROLLERS, EFFECTS):
        for file in [*family.files.values()]:
            family.unload(file.path)


def _removed(path):
    if path.is_dir():
        shutil.rmtree(path)
    path.unlink(missing_ok=True)


def _made_small(arguments):
    name = arguments[0]
    if name in {"release", "simulate", "render", "assemble", "hil", "plan"}:
        return [*arguments, *_settings(SMALL)]
    if name == "preview":
        return [*arguments, "--width-px", "32"]
    if name == "import":
        return [*arguments, "--yes"]  # as the reader answers
    if name == "rerender":
        draws = ["--draws", "2"] if "--draws" in arguments else []
        return [*arguments, *_settings(SMALL_IMAGES), *draws, "--yes"]
    return arguments


def _settings(texts):
    return [word for text in texts for word in ("--set", text)]
