"""HTML as nested calls; every text is escaped, and every element closed, so that the page is XML as well."""

import base64
from collections.abc import Iterable, Sequence
from html import escape

VOID = frozenset({"img", "meta", "br"})


class Html(str):
    """Text that is markup already."""

    __slots__ = ()


def tag(element: str, /, *content: str | Iterable[str], **attributes: str) -> Html:
    """An element; `class_` stands for `class`.

    Args:
        element: Its name.
        content: Texts, which are escaped, elements, which are not, or several of them.
        attributes: Their values are escaped.
    """
    given = "".join(f' {key.rstrip("_")}="{escape(value)}"' for key, value in attributes.items())
    if element in VOID:
        return Html(f"<{element}{given}/>")
    return Html(f"<{element}{given}>{''.join(map(_markup, _flat(content)))}</{element}>")


def joined(*content: str | Iterable[str]) -> Html:
    """Elements and texts one after the other."""
    return Html("".join(map(_markup, _flat(content))))


def table(head: Sequence[str], rows: Iterable[Sequence[str]], **attributes: str) -> Html:
    """Cells are texts or elements; one that is a `td` already stays as it is."""
    top = tag("tr", [tag("th", cell) for cell in head])
    body = [
        tag("tr", [cell if cell.startswith("<td") and isinstance(cell, Html) else tag("td", cell) for cell in row])
        for row in rows
    ]
    return tag("div", tag("table", tag("thead", top), tag("tbody", body), **attributes), class_="wide")


def picture(data: bytes, alternative: str, kind: str = "image/png") -> Html:
    """Within the page itself; `kind` is the media type of the data."""
    return tag("img", src=f"data:{kind};base64,{base64.b64encode(data).decode()}", alt=alternative)


def _flat(content: Iterable[str | Iterable[str]]) -> Iterable[str]:
    for part in content:
        if isinstance(part, str):
            yield part
        else:
            yield from part


def _markup(text: str) -> str:
    return text if isinstance(text, Html) else escape(text)
