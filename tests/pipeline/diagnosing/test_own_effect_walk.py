"""The walk of docs/own_effects.md: from a file to its check, a log, a diagnosis that finds it, and a drive with it."""

import json
import re
import shlex
import shutil
from pathlib import Path

import pytest
import yaml

from configs.effects.registry import EFFECTS
from pipeline.cli import main

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs/own_effects.md").read_text()
COMMANDS = [shlex.split(line) for line in re.findall(r"^    symolo (.+)$", PAGE, re.MULTILINE)]
TRUE_AMPLITUDE = 0.05


def forget():
    """Forget the files that were loaded, as a new process would."""
    for file in [*EFFECTS.files.values()]:
        EFFECTS.unload(file.path)


def test_the_file_of_the_page_is_the_example():
    (block,) = re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
    assert block == (ROOT / "examples/oval_wheel.py").read_text()


def test_a_law_that_breaks_a_rule_is_not_fitted(tmp_path, capsys):
    path = tmp_path / "oval_wheel.py"
    path.write_text((ROOT / "examples/oval_wheel.py").read_text().replace("return share +", "return 1.01 * share +"))
    assert main(["diagnose", "table-1", "--effects", str(path), "--out", str(tmp_path / "out")]) == 2
    forget()
    (line,) = capsys.readouterr().err.splitlines()
    assert re.search(r"effect oval_wheel breaks the rule 'null': .*`symolo effect check .*` explains it", line)
    assert not (tmp_path / "out").exists()


@pytest.mark.documents
def test_the_walk_finds_the_law_with_its_size_and_drives_with_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    for name, text in re.findall(r"^```yaml\n# (\S+)\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL):
        (tmp_path / name).write_text(text)
    walk = [words for words in COMMANDS if "measured" in words or "explained" in " ".join(words)]
    assert [words[0] for words in walk] == ["simulate", "diagnose", "simulate"]
    for words in walk:
        assert main(words) == 0, words
        forget()
    (named,) = json.loads((tmp_path / "explained/answer.json").read_text())["effects"]
    value, error = named["parameters"]["amplitude"], named["std"]["amplitude"]
    assert named["name"] == "oval_wheel"
    assert abs(value - TRUE_AMPLITUDE) < 3.0 * error < 0.05
    robot = yaml.safe_load((tmp_path / "explained/extended.yaml").read_text())
    assert robot["effect_files"] == ["oval_wheel.py"]
    spec = json.loads((tmp_path / "again/.stages/simulate/CW/test_1/spec.json").read_text())
    assert spec["robot"]["effects"]["oval_wheel"]["amplitude"] == robot["effects"]["oval_wheel"]["amplitude"]
