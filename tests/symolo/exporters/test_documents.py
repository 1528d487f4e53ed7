"""The programs of the pages on reader and exports run as they stand there."""

import gc
import re
from pathlib import Path

import datasets
import pytest

from symolo.exporters import EXPORTERS

ROOT = Path(__file__).parents[3]
DOCS = ROOT / "docs"
RELEASE, EXPORTED = "symolo-dataset", "exported"


def programs(page: str) -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", (DOCS / page).read_text(), re.MULTILINE | re.DOTALL)


@pytest.fixture
def here(random_release, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(datasets.config, "HF_HUB_OFFLINE", True)
    monkeypatch.setattr(datasets.config, "HF_DATASETS_CACHE", tmp_path / "cache")
    Path(RELEASE).symlink_to(random_release(1, annotated=True).root)


def test_help_and_pages_name_every_format(symolo):
    names = ", ".join(exporter.name for exporter in EXPORTERS)
    assert names in " ".join(re.sub(r"[^a-z0-9, ]", " ", symolo("export", "--help").out).split())
    assert names in (DOCS / "commands.md").read_text()
    page = (DOCS / "exports.md").read_text()
    assert re.findall(r"^## (\w+)$", page, re.MULTILINE) == names.split(", ")
    overview = page.partition("\n## ")[0]
    assert re.findall(r"^\| (\w+) \|", overview, re.MULTILINE) == ["format", *names.split(", ")]


@pytest.mark.usefixtures("here")
def test_the_program_of_the_page_on_the_reader(capsys):
    (program,) = programs("reader.md")
    names = {}
    exec(program, names)  # noqa: S102 - our own page
    assert names["line"].shape == names["ids"].shape == names["pixels"].shape[:2]
    assert "CW/test_1" in capsys.readouterr().out


# webdataset leaves the file that it read to the garbage collector.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning", "ignore::ResourceWarning")
@pytest.mark.usefixtures("here")
def test_the_commands_and_programs_of_the_page_on_exports(symolo):
    commands = re.findall(r"^    symolo (.+)$", (DOCS / "exports.md").read_text(), re.MULTILINE)
    assert [symolo(*command.replace('"', "").split()).code for command in commands[:2]] == [0, 0]
    names = {}
    for program in programs("exports.md"):
        exec(program, names)  # noqa: S102 - as above
    assert (names["p_WC"].shape[1], names["unit"], names["mask"].ndim) == (3, b"rad/s", 2)
    assert (names["pixels"].shape[2], names["row"]["run"]) == (3, "CW/test_1")
    assert len(names["rows_20_Hz"]) == len(names["rows"])
    assert names["place"].x == names["rows"].query("run == 'CW/test_1'")["x"].iloc[-1]
    gc.collect()
    assert names["row"]["run"] in set(names["rows"]["run"])
