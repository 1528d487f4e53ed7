"""Pages from templates: texts are escaped, missing values are errors, and a page is well-formed XML."""

import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from jinja2 import UndefinedError

from symolo.core.progress import plural
from symolo.pages.html import grouped, render_page

HOSTILE = "<script>alert(1)</script>\"'&"
TEMPLATE = """{% extends "base.html.j2" %}
{% from "macros.html.j2" import figure, fold, note, pairs, table %}
{% block body %}
{{ table([text, "b"], [(text, 1), ("x", 2)], text) }}
{{ pairs([(text, text)]) }}
{{ figure(data, text, text) }}
{{ note(text) }}
{% call fold(text) %}<p>{{ text }}</p>{% endcall %}
{% endblock %}
"""


@pytest.fixture
def package(tmp_path, monkeypatch, request):
    """A package with a template of its own, by a name that no other test has imported."""
    name = f"pages_{request.node.name.partition('[')[0]}"
    (tmp_path / name / "templates").mkdir(parents=True)
    (tmp_path / name / "__init__.py").touch()
    (tmp_path / name / "templates" / "page.html.j2").write_text(TEMPLATE)
    monkeypatch.syspath_prepend(tmp_path)
    yield name
    sys.modules.pop(name, None)


def test_every_macro_escapes_its_texts(package):
    html = render_page(package, title=HOSTILE, text=HOSTILE, data=b"png")
    root = ET.fromstring(html)  # noqa: S314 - our own page
    assert not list(root.iter("script"))
    assert root.findtext("head/title") == HOSTILE
    assert [cell.text for cell in root.iter("th")] == [HOSTILE, "b", HOSTILE]
    (image,) = root.iter("img")
    assert image.attrib == {"src": "data:image/png;base64,cG5n", "alt": HOSTILE}
    assert [element.text for element in root.iter("figcaption")] == [HOSTILE]
    assert root.findtext("body/details/summary") == HOSTILE


def test_a_page_forbids_scripts_and_whatever_is_not_part_of_it(package):
    root = ET.fromstring(render_page(package, title="t", text="x", data=b"png"))  # noqa: S314 - our own page
    (policy,) = (meta for meta in root.iter("meta") if meta.get("http-equiv") == "Content-Security-Policy")
    allowed = dict(part.strip().split(" ", 1) for part in policy.attrib["content"].split(";"))
    assert allowed["default-src"] == "'none'"
    assert (allowed["img-src"], allowed["style-src"]) == ("data:", "'unsafe-inline'")
    assert "script-src" not in allowed


def test_a_value_that_a_template_lacks_is_an_error(package):
    with pytest.raises(UndefinedError, match="'text' is undefined"):
        render_page(package, title="t", data=b"")


def test_the_same_values_give_the_same_page(package):
    pages = {render_page(package, title="t", text="x", data=bytes(range(256))) for _ in range(2)}
    assert len(pages) == 1


def test_every_template_is_package_data():
    """Templates of a folder that pyproject.toml does not list would be missing in an installed package."""
    root = Path(__file__).parents[3]
    pyproject = (root / "pyproject.toml").read_text()
    folders = {path.parent.parent for top in ("symolo", "diagnosis", "pipeline") for path in (root / top).rglob("*.j2")}
    assert len(folders) >= 4
    for folder in folders:
        assert f'"{".".join(folder.relative_to(root).parts)}" = ["templates/*"]' in pyproject


def test_counts_have_a_plural_and_spaces_that_do_not_break():
    assert plural(1, "run") == "1 run"
    assert plural(0, "run") == "0 runs"
    assert plural(1234, "run", grouped) == "1\N{NO-BREAK SPACE}234 runs"
    assert grouped(1234567) == "1\N{NO-BREAK SPACE}234\N{NO-BREAK SPACE}567"
