"""Markdown from plain values."""

import inspect
import re
from collections.abc import Iterable, Sequence

_FOR_PROGRAMMERS = re.compile(r"^(?:Args|Attributes|Raises|Returns|Yields):$", re.MULTILINE)
"""Headings in a docstring from which on the text is only for programmers."""


def text(value: str) -> str:
    """Return running text as one line in which the special characters of Markdown are escaped."""
    joined = " ".join(value.split())
    parts = joined.split("`")
    # Every second part is between back-ticks, where only the bar of a table is special.
    parts[::2] = [part.replace("*", r"\*").replace("<", r"\<") for part in parts[::2]]
    return "`".join(parts).replace("|", r"\|")


def about(documented: object) -> str:
    """Return the part of the docstring of a module, class or function that is for all readers.

    The docstring of a function begins with "Return", which a reader of the page does not need.
    """
    described = _FOR_PROGRAMMERS.split(inspect.getdoc(documented) or "")[0].strip()
    returned = described.removeprefix("Return ")
    return described if returned == described else returned[:1].upper() + returned[1:]


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def page(title: str, about: str, parts: Iterable[str]) -> str:
    note = "<!-- Written by `python docs/generate`; change the code, not this page. -->"
    return "\n\n".join([f"# {title}", note, about, *parts]) + "\n"


def anchor(heading: str) -> str:
    """Return the part of a link that names a heading."""
    letters = (letter for letter in heading.lower() if letter.isalnum() or letter in " -_")
    return "#" + "".join(letters).replace(" ", "-")
