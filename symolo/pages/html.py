"""HTML pages from Jinja2 templates: every text is escaped, and a page needs no file beside itself."""

import base64
import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, partial

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from jinja2.utils import htmlsafe_json_dumps
from markupsafe import Markup

from symolo.core.progress import plural


@dataclass(frozen=True)
class PageScript:
    """The script of a page, and the hash by which the page's policy allows it and no other."""

    text: Markup
    sha256: str
    """SHA-256 in base64, as a Content Security Policy writes it."""

    @classmethod
    def from_parts(cls, parts: Sequence[str]) -> "PageScript":
        """Return the script with these parts, one after the other."""
        # A strict reader of XML takes what is in between as it is, and a browser takes the marks as comments.
        text = "//<![CDATA[\n" + "\n".join(parts) + "\n//]]>"
        return cls(Markup(text), base64.b64encode(hashlib.sha256(text.encode()).digest()).decode())  # noqa: S704 - ours


def page_data(value: object) -> Markup:
    """Return a value as JSON for an element `<script type="application/json">`; nothing in it can end the element."""
    return htmlsafe_json_dumps(value, partial(json.dumps, allow_nan=False, separators=(",", ":"), sort_keys=True))


def render_page(package: str, *, scripts: Sequence[str] = (), **context: object) -> str:
    """Return the page that `templates/page.html.j2` of a package makes.

    The template extends `base.html.j2` of this package, which shows `title`. A value that the template uses and
    `context` lacks is an error. The same context gives the same text.

    Args:
        package: Dotted name of the package that has the folder `templates`.
        scripts: Names of files in this folder that together are the script of the page; by default it has none, and
            the page allows none.
        context: The values that the template shows. Texts are escaped.
    """
    environment = _environment(package)
    script = PageScript.from_parts([_source(environment, name) for name in scripts]) if scripts else None
    return environment.get_template("page.html.j2").render(context, script=script)


def render_part(package: str, template: str, **context: object) -> Markup:
    """Return what a template of a package makes, as a part of a page that another template of the package shows.

    A value that the template uses and `context` lacks is an error.
    """
    return Markup(_environment(package).get_template(template).render(context))  # noqa: S704 - our own template escapes


def _source(environment: Environment, name: str) -> str:
    """Return the text of a file in the folder `templates`; unlike a template, it is taken as it is."""
    if environment.loader is None:
        raise ValueError("the template environment has no loader")
    return environment.loader.get_source(environment, name)[0]


@cache
def _environment(package: str) -> Environment:
    environment = Environment(
        loader=ChoiceLoader([PackageLoader(package), PackageLoader("symolo.pages")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"data_url": _data_url, "grouped": grouped, "plural": partial(plural, digits=grouped)}
    return environment


def grouped(number: int) -> str:
    """Return `12 345`, with spaces at which no line breaks."""
    return f"{number:,}".replace(",", "\N{NO-BREAK SPACE}")


def _data_url(data: bytes, media_type: str) -> str:
    """Return an address that holds the data itself, so that an image is part of the page."""
    return f"data:{media_type};base64,{base64.b64encode(data).decode()}"
