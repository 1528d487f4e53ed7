"""The pages that are written from the code say what it says, and lead to something."""

import operator
import re
from pathlib import Path

import pytest
import yaml

from blender_scenes.materials import FLOORS, SURFACES
from configs.loader import load_section
from configs.schema.appearance.look import LookConfig
from configs.schema.robot import RobotConfig
from pipeline.cli import command_line
from symolo.exporters import FORMATS

DOCS = Path(__file__).parents[2] / "docs"
PAGES = sorted((DOCS / "reference").glob("*.md"))


@pytest.fixture
def drifted(monkeypatch):
    monkeypatch.syspath_prepend(str(DOCS / "generate"))
    from pages import drifted  # noqa: PLC0415 - a script of docs

    return drifted


def _page(name):
    return (DOCS / "reference" / name).read_text()


def test_every_page_is_what_the_code_says(drifted):
    assert drifted() == ()


def test_every_command_has_a_section():
    for name, command in command_line().commands.items():
        inner = [f"{name} {one}" for one in command.commands] if hasattr(command, "commands") else [name]
        for one in inner:
            assert f"\n## {one}\n" in _page("commands.md")


def test_every_field_of_robot_and_look_is_a_key():
    keys = set(re.findall(r"^\| `(\w+)` \|", _page("configuration.md"), re.MULTILINE))
    for section in (RobotConfig, LookConfig):
        assert set(section.model_fields) - keys == set()


@pytest.mark.parametrize(
    ("path", "key"), [("floor.ceramic_tile", "joint"), ("floor.carpet", "paint"), ("brick", "joint")]
)
def test_a_colour_shows_the_default_that_it_has_in_its_section(path, key):
    section = _page("configuration.md").partition(f"\n## look.{path}\n")[2].partition("\n## ")[0]
    (row,) = (line for line in section.splitlines() if line.startswith(f"| `{key}` |"))
    paint = getattr(operator.attrgetter(path)(LookConfig(name="plain")), key)
    assert yaml.safe_load(row.rsplit("|", 2)[1].strip(" `")) == paint.model_dump()


def test_every_part_of_a_look_that_a_page_names_is_there():
    """`look.a.b` in running text, and each setting of an example as a look takes it."""
    path = r"\blook\.(?!json|yaml)([a-z_0-9.]*[a-z_0-9])"
    named = {name for page in PAGES for name in re.findall(path, page.read_text())}
    assert {"floor.material", "line", "assets"} <= named
    assert [name for name in sorted(named) if not _is_field(name.split("."))] == []
    settings = set(re.findall(r"(?:--set |`)(look\.[^\s`=]+=(?:\{[^}]*\}|[^\s`{]+))", _page("materials.md")))
    assert "look.line=paint" in settings
    for setting in sorted(settings):
        load_section("look", "classroom", [setting])


def _is_field(path):
    section = LookConfig(name="plain")
    for name in path:
        if name not in type(section).model_fields:
            return False
        section = getattr(section, name)
    return True


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.name)
def test_no_page_has_what_a_docstring_says_to_programmers(page):
    assert re.findall(r"^.*\b(?:Args|Attributes|Raises|Returns|Yields):.*$", page.read_text(), re.MULTILINE) == []


def test_every_material_has_an_image():
    pictures = re.findall(r"!\[[^]]*]\(([^)]+)\)", _page("materials.md"))
    assert len(pictures) >= len(FLOORS) - 1 + len(SURFACES)
    assert [name for name in pictures if not (DOCS / "reference" / name).is_file()] == []


def test_every_format_is_explained_once():
    sections = re.findall(r"^## (\w+)$", "\n".join(map(Path.read_text, DOCS.glob("exports/*.md"))), re.MULTILINE)
    assert sorted(sections) == sorted(FORMATS)


@pytest.mark.parametrize("page", sorted(DOCS.rglob("*.md")), ids=lambda path: path.name)
def test_every_link_leads_to_a_file_and_a_heading(page):
    for link in re.findall(r"]\(([^)\s]+)\)", re.sub(r"^(    |```).*?$", "", page.read_text(), flags=re.MULTILINE)):
        if "://" in link:
            continue
        file, _, heading = link.partition("#")
        target = page.parent / file if file else page
        assert target.exists(), link
        if heading:
            headings = re.findall(r"^#+ (.*)$", target.read_text(), re.MULTILINE)
            assert heading in {_slug(one) for one in headings}, link


def _slug(heading):
    """As GitHub makes it of a heading: lower case, without punctuation, hyphens for spaces."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
