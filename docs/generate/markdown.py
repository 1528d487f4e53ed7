"""Markdown from plain values."""

import inspect
import re
from collections.abc import Iterable, Sequence

_FOR_PROGRAMMERS = re.compile(r"^(?:Args|Attributes|Raises|Returns|Yields):$", re.MULTILINE)
"""The first of the parts of a docstring that say how a function is called."""


def text(value: str) -> str:
    """Running text in one line, with what Markdown would take for its own kept as it is."""
    joined = " ".join(value.split())
    parts = joined.split("`")
    # Every second part stands between back-ticks, where nothing is special but the bar of a table.
    parts[::2] = [part.replace("*", r"\*").replace("<", r"\<") for part in parts[::2]]
    return "`".join(parts).replace("|", r"\|")


def about(documented: object) -> str:
    """Return the part of a docstring that is not only for programmers."""
    return _FOR_PROGRAMMERS.split(inspect.getdoc(documented) or "")[0].strip()


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def page(title: str, about: str, parts: Iterable[str]) -> str:
    note = "<!-- Written by `python docs/generate`; change the code, not this page. -->"
    return "\n\n".join([f"# {title}", note, about, *parts]) + "\n"


def anchor(heading: str) -> str:
    """How a link names a heading."""
    kept = (letter for letter in heading.lower() if letter.isalnum() or letter in " -_")
    return "#" + "".join(kept).replace(" ", "-")
