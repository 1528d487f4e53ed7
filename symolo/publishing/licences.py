"""Licences by their SPDX identifier: name and address, and what the Hugging Face Hub calls them."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Licence:
    """A licence by its SPDX identifier."""

    spdx: str
    name: str
    url: str
    hub: str
    """Identifier in the front matter of a dataset card; `other` where the Hub has none."""
    known: bool = True
    """Whether the identifier is one of the SPDX identifiers that are listed here."""


_CC = "https://creativecommons.org"
_KNOWN = (
    Licence("CC-BY-4.0", "Creative Commons Attribution 4.0 International", f"{_CC}/licenses/by/4.0/", "cc-by-4.0"),
    Licence(
        "CC-BY-SA-4.0",
        "Creative Commons Attribution Share Alike 4.0 International",
        f"{_CC}/licenses/by-sa/4.0/",
        "cc-by-sa-4.0",
    ),
    Licence(
        "CC-BY-NC-4.0",
        "Creative Commons Attribution Non Commercial 4.0 International",
        f"{_CC}/licenses/by-nc/4.0/",
        "cc-by-nc-4.0",
    ),
    Licence("CC0-1.0", "Creative Commons Zero v1.0 Universal", f"{_CC}/publicdomain/zero/1.0/", "cc0-1.0"),
    Licence(
        "ODbL-1.0",
        "Open Data Commons Open Database License v1.0",
        "https://opendatacommons.org/licenses/odbl/1-0/",
        "odbl",
    ),
    Licence("MIT", "MIT License", "https://opensource.org/license/mit", "mit"),
)


def licence_of(text: str) -> Licence:
    """Return the licence that a scenario names; a text that is no known identifier is taken as the licence's name."""
    known = next((licence for licence in _KNOWN if licence.spdx.lower() == text.lower()), None)
    return known or Licence(text, text, "", "other", known=False)
