"""What pages quote of the output of their commands is what the commands print today (`-m documents`)."""

import re
import shlex
import subprocess
import sys
from itertools import takewhile
from pathlib import Path

import pytest

from configs.effects.registry import EFFECTS
from pipeline.cli import main

ROOT = Path(__file__).parents[2]
QUOTING = {
    "diagnosis.md": ("## A first diagnosis",),
    "discovery.md": ("## From a case to a law", "## From the law to a simulation", "## Test the law on another"),
    "calibrated.md": ("## From a log to a release", "## What leaves the measured range"),
    "next_trial.md": ("# The next experiment",),
}
"""Sections by page whose commands, in this order, make all that their quotes show."""
NOT_RUN = ("release ", "simulate ")
"""Commands whose output is not quoted, and that would take long."""
NOT_QUOTED = ("the robot was measured for current_A",)
"""Beginnings of blocks that quote something else than the output of these commands."""


@pytest.mark.documents
@pytest.mark.parametrize("page", QUOTING)
def test_a_page_quotes_what_its_commands_print(page, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs" / page).read_text()
    parts = [_blocks(_section(text, heading)) for heading in QUOTING[page]]
    printed: list[str] = []
    for block in (block for part in parts for block in part):
        if _is_command(block[0]):
            for command in filter(_is_command, block):
                printed += _printed_by(command, capsys)
    for block in (block for part in parts for block in part):
        if not _is_command(block[0]) and not block[0].startswith(NOT_QUOTED):
            missing = _first_missing(" ".join(block), printed)
            assert not missing, f"{page}: {missing}"


def test_the_sections_that_quote_are_there():
    for page, headings in QUOTING.items():
        text = (ROOT / "docs" / page).read_text()
        blocks = [block for heading in headings for block in _blocks(_section(text, heading))]
        assert not all(_is_command(block[0]) for block in blocks), page


def test_a_quote_that_differs_in_one_number_is_noticed():
    printed = ["confidence", "84.6", "%;", "no", "other", "effect", "comes", "close"]
    assert _first_missing("confidence 84.6 %; ... comes close", printed) == ""
    assert _first_missing("confidence 83.6 %; no other", printed) == "confidence 83.6"


def test_a_quote_leaves_out_words_only_where_it_says_so():
    printed = ["peak", "1.5", "m", "peak", "2.5", "m"]
    assert _first_missing("peak ... 2.5 m", printed) == ""
    assert _first_missing("peak 2.5 m", printed) == ""
    assert _first_missing("peak 1.5 2.5", printed) == "peak 1.5 2.5"
    assert _first_missing("2.5 m ... peak", printed) == "peak"


def _section(text, heading):
    """Return the text under a heading, up to the next one."""
    return re.split(r"^#+ ", text[text.index(heading) + len(heading) :], maxsplit=1, flags=re.MULTILINE)[0]


def _blocks(text):
    """Return the indented blocks as lists of lines; a line that ends in a backslash goes on in the next one."""
    joined = re.sub(r" *\\\n *", " ", text)
    return [
        [line.strip() for line in block.splitlines()]
        for block in re.findall(r"(?:^    .*\n)+(?:^\n(?:^    .*\n)+)*", joined, re.MULTILINE)
    ]


def _is_command(line):
    return line.startswith(("symolo ", "python -m "))


def _printed_by(command, capsys):
    """Return the words that a command prints."""
    program, *words = shlex.split(command)
    if program == "python":
        subprocess.run([sys.executable, *words], check=True, env={"PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"})
        return []
    if command.partition(" ")[2].startswith(NOT_RUN) or "my_" in command:
        return []
    assert main(words) == 0, command
    for file in [*EFFECTS.files.values()]:
        EFFECTS.unload(file.path)  # as a new process would
    return capsys.readouterr().out.split()


def _first_missing(quote, printed):
    """Return the end of the first words of a quote that do not follow in the output; empty if all do.

    A quote may leave out words at `...` only.
    """
    place = 0
    for words in (part.split() for part in quote.split("...")):
        places = range(place, len(printed) + 1)
        equal, back = max((_equal(words, printed[k:]), -k) for k in places)
        if equal < len(words):
            return " ".join(words[max(0, equal - 5) : equal + 1])
        place = len(words) - back
    return ""


def _equal(words, others):
    """Return how many words at the beginning are equal."""
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(words, others, strict=False)))
