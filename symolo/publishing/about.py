"""What only people know of a publication: title, authors, date, publisher. Read strictly from a YAML file."""

from datetime import date
from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, Field

from configs.schema.base import FromList, Section, disagreement
from configs.validation import validated
from symolo.core.yaml_reader import read_yaml

_LINE = r"^\S(?:[^\n\r]*\S)?$"
Line = Annotated[str, Field(pattern=_LINE, max_length=500)]


def _calendar(text: str) -> str:
    try:
        date.fromisoformat(text)
    except ValueError:
        raise disagreement("", text, "a day of the calendar, such as 2026-11-22") from None
    return text


def _checked_orcid(text: str) -> str:
    """The last sign is a check of the others, ISO 7064 mod 11-2."""
    digits = text.replace("-", "")
    total = 0
    for digit in digits[:-1]:
        total = 2 * (total + int(digit))
    expected = "0123456789X"[(12 - total % 11) % 11]
    if digits[-1] != expected:
        raise disagreement("", text, f"an ORCID whose last sign is {expected}, if the others are right")
    return text


class Author(Section):
    family: Line
    """Family name, or the whole name of an organisation."""
    given: Line | None = None
    orcid: Annotated[str, Field(pattern=r"^\d{4}-\d{4}-\d{4}-\d{3}[\dX]$"), AfterValidator(_checked_orcid)] | None = (
        None
    )
    affiliation: Line | None = None

    @property
    def name(self) -> str:
        return f"{self.family}, {self.given}" if self.given else self.family

    @property
    def orcid_url(self) -> str:
        return f"https://orcid.org/{self.orcid}"


class About(Section):
    title: Line
    authors: Annotated[tuple[Author, ...], FromList, Field(min_length=1)]
    published: Annotated[str, Field(pattern=r"^\d{4}-\d{2}-\d{2}$"), AfterValidator(_calendar)]
    """The day on which it is, or will be, public."""
    publisher: Line
    """Who keeps it, for example Zenodo."""
    version: Annotated[str, Field(pattern=r"^\d+\.\d+\.\d+$")] = "1.0.0"
    doi: Annotated[str, Field(pattern=r"^10\.\d{4,9}/\S+$")] | None = None
    """Zenodo tells it before it publishes."""
    url: Annotated[str, Field(pattern=r"^https?://\S+$")] | None = None
    """Page of the dataset; that of the DOI by default."""
    description: Annotated[str, Field(max_length=5000)] | None = None
    """In place of that of the scenario."""
    keywords: Annotated[tuple[Line, ...], FromList, Field(min_length=1)] = (
        "mobile robot",
        "synthetic data",
        "localisation",
        "odometry",
    )

    @property
    def year(self) -> int:
        return int(self.published[:4])

    @property
    def address(self) -> str:
        """Where it is found; "" where nobody told."""
        return self.url or (f"https://doi.org/{self.doi}" if self.doi else "")

    @property
    def citation(self) -> str:
        """In DataCite's order: creators (year): title. Version. Publisher. Address."""
        authors = "; ".join(author.name for author in self.authors)
        parts = (f"{authors} ({self.year}): {self.title}", f"Version {self.version}", self.publisher, self.address)
        return ". ".join(part for part in parts if part)


def read_about(path: Path) -> About:
    """Of a YAML file.

    Raises:
        InputError: It cannot be read, or something in it is missing or wrong.
    """
    return validated(read_yaml(path).root, About, {})
