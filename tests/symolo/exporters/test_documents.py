"""The programs of the pages on reader and exports run as they stand there."""

import gc
import re
import shlex
from pathlib import Path

import datasets
import pytest

from symolo.exporters import FORMATS

ROOT = Path(__file__).parents[3]
DOCS = ROOT / "docs"
RELEASE = "symolo-dataset"


def programs(page: str) -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", (DOCS / page).read_text(), re.MULTILINE | re.DOTALL)


def kinds_of(command: str) -> tuple[str, ...]:
    """Annotations that a command of a page asks for."""
    return tuple(re.search(r"render\.annotations=\[([\w,]+)]", command)[1].split(","))


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(datasets.config, "HF_HUB_OFFLINE", True)
    monkeypatch.setattr(datasets.config, "HF_DATASETS_CACHE", tmp_path / "cache")
    return tmp_path


def test_help_and_the_overview_name_every_format(symolo):
    names = ", ".join(FORMATS)
    assert names in " ".join(re.sub(r"[^a-z0-9, ]", " ", symolo("export", "--help").out).split())
    overview = (DOCS / "exports.md").read_text()
    assert re.findall(r"^\| \[(\w+)\]\(exports/\w+\.md#\1\) \|", overview, re.MULTILINE) == names.split(", ")


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("kinds", [(), ("depth", "semantic"), ("depth", "instance")])
def test_the_program_of_the_page_on_the_reader(kinds, random_release, capsys):
    """With whatever annotations the release was made."""
    Path(RELEASE).symlink_to(random_release(1, kinds=kinds).root)
    (program,) = programs("reader.md")
    names = {}
    exec(program, names)  # noqa: S102 - our own page
    masks = [names[name].shape for name in ("line", "ids") if name in names]
    assert masks == [names["pixels"].shape[:2]] * (2 if "instance" in kinds else 0)
    assert "CW/test_1" in capsys.readouterr().out


# webdataset leaves the file that it read to the garbage collector.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning", "ignore::ResourceWarning")
def test_the_commands_and_programs_of_the_pages_on_exports(symolo, random_release, here, monkeypatch):
    """The release has the annotations that a page asks for in a command, which `pytest -m documents` runs itself."""
    (release,) = re.findall(r"^    symolo (release .+)$", (DOCS / "exports/labels.md").read_text(), re.MULTILINE)
    assert release.endswith(f"--out {RELEASE}")
    written, names = set(), {}
    for page in ("exports.md", *(f"exports/{path.name}" for path in sorted(DOCS.glob("exports/*.md")))):
        desk, of_page = here / Path(page).stem, names.setdefault(Path(page).stem, {})
        desk.mkdir()
        monkeypatch.chdir(desk)
        Path(RELEASE).symlink_to(random_release(1, kinds=kinds_of(release)).root)
        for command in re.findall(r"^    symolo (?!release)(.+)$", (DOCS / page).read_text(), re.MULTILINE):
            ended = symolo(*shlex.split(command))
            assert ended.code == 0, f"{command}: {ended.err}"
        written |= {path.name for path in Path("exported").iterdir() if path.is_dir()}
        for program in programs(page):
            exec(program, of_page)  # noqa: S102 - as above
    assert written == set(FORMATS)
    learning = names["learning"]
    assert (names["trajectories"]["p_WC"].shape[1], learning["unit"], names["labels"]["mask"].ndim) == (3, b"rad/s", 2)
    assert (learning["pixels"].shape[2], learning["row"]["run"]) == (3, "CW/test_1")
    assert len(learning["rows_20_Hz"]) == len(learning["rows"])
    assert names["ros"]["place"].x == learning["rows"].query("run == 'CW/test_1'")["x"].iloc[-1]
    gc.collect()
    assert learning["row"]["run"] in set(learning["rows"]["run"])
