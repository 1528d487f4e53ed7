"""What a scenario says of itself is plain text on the page README.md, whatever it holds."""

import pytest

from symolo.dataset.documents.description import plain_text


@pytest.mark.parametrize(
    "text",
    ["[a](javascript:alert(1))", "![a](javascript:alert(1))", "[a]: javascript:alert(1)", "[a][b]", "[a](<b c>)"],
)
def test_no_text_becomes_a_link(text):
    """By CommonMark 0.31, 6.3 and 2.4: a link text ends with a bracket, and one behind a backslash is none."""
    shown = plain_text(text)
    assert "](" not in shown.replace("\\](", "")
    assert "][" not in shown.replace("\\][", "")
    assert "]:" not in shown.replace("\\]:", "")


def test_a_link_in_angle_brackets_and_html_are_text():
    assert plain_text("<javascript:alert(1)> <b>") == "&lt;javascript:alert(1)&gt; &lt;b&gt;"


def test_characters_that_turn_the_direction_are_left_out():
    assert plain_text("a\u202egnp.exe") == "a gnp.exe"


def test_usual_text_stays_as_it_is():
    assert plain_text("ranges [m], 3 (of 4)") == "ranges [m], 3 (of 4)"
