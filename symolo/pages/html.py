"""HTML pages from Jinja2 templates: every text is escaped, and a page needs no file beside itself."""

import base64
from functools import cache, partial

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

from symolo.core.progress import plural


def render_page(package: str, **context: object) -> str:
    """Return the page that `templates/page.html.j2` of a package makes.

    The template extends `base.html.j2` of this package, which shows `title`. A value that the template uses and
    `context` lacks is an error. The same context gives the same text.

    Args:
        package: Dotted name of the package that has the folder `templates`.
        context: The values that the template shows. Texts are escaped.
    """
    return _environment(package).get_template("page.html.j2").render(context)


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
