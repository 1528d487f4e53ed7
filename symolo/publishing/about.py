"""Facts about a publication that only people know: title, authors, date, publisher. Read from a YAML file."""

from collections.abc import Iterator
from datetime import date
from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, Strict, ValidationError
from pydantic_core import PydanticCustomError

from symolo.core.errors import InputError, nearest, together
from symolo.core.yaml.reader import read_yaml
from symolo.core.yaml.tree import Node, dotted

_FROM_LIST = Strict(strict=False)
"""A list of a file becomes a tuple; its items stay strict."""
_NOT_ALLOWED = "not_allowed"
"""Type of an error whose text says what is allowed."""
_ALLOWED = {
    "orcid": "an ORCID such as 0000-0002-1825-0097",
    "published": "a day such as 2026-11-22",
    "version": "a version such as 1.0.0",
    "doi": "a DOI such as 10.5281/zenodo.1234567",
    "url": "an address that begins with https:// or http://",
}
"""Allowed values of fields in words, for fields whose pattern alone would not explain them."""

_ARCHIVES = ("Zenodo", "Hugging Face", "figshare", "Dryad", "Dataverse", "Mendeley Data", "OSF")
"""Names of archives as they write them."""
FAR_DAYS = 366
"""Days until a publication, from which on its date is probably wrong."""
_IN_SCENARIO = "the licence is that of the scenario: write it there, and release again"

Line = Annotated[str, Field(pattern=r"^\S(?:[^\n\r]*\S)?$", max_length=500)]


def _calendar(text: str) -> str:
    try:
        date.fromisoformat(text)
    except ValueError:
        raise PydanticCustomError(_NOT_ALLOWED, "a day of the calendar, such as 2026-11-22") from None
    return text


def _checked_orcid(text: str) -> str:
    """Return an ORCID whose last sign is the checksum of the others, ISO 7064 mod 11-2."""
    digits = text.replace("-", "")
    total = 0
    for digit in digits[:-1]:
        total = 2 * (total + int(digit))
    expected = "0123456789X"[(12 - total % 11) % 11]
    if digits[-1] != expected:
        allowed = "an ORCID whose last sign is {expected}, if the others are right"
        raise PydanticCustomError(_NOT_ALLOWED, allowed, {"expected": expected})
    return text


Orcid = Annotated[str, Field(pattern=r"^\d{4}-\d{4}-\d{4}-\d{3}[\dX]$"), AfterValidator(_checked_orcid)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Author(_Section):
    """A person or an organisation that made the dataset."""

    family: Line
    """Family name, or the whole name of an organisation."""
    given: Line | None = None
    """Given names of a person."""
    orcid: Orcid | None = None
    """ORCID identifier of a person, such as 0000-0002-1825-0097."""
    affiliation: Line | None = None

    @property
    def name(self) -> str:
        return f"{self.family}, {self.given}" if self.given else self.family

    @property
    def orcid_url(self) -> str:
        return f"https://orcid.org/{self.orcid}"


class About(_Section):
    """The facts of one publication, which are the content of the YAML file."""

    title: Line
    authors: Annotated[tuple[Author, ...], _FROM_LIST, Field(min_length=1)]
    published: Annotated[str, Field(pattern=r"^\d{4}-\d{2}-\d{2}$"), AfterValidator(_calendar)]
    """The day on which the dataset is, or will be, public."""
    publisher: Line
    """Who archives the dataset, for example Zenodo."""
    version: Annotated[str, Field(pattern=r"^\d+\.\d+\.\d+$")] = "1.0.0"
    doi: Annotated[str, Field(pattern=r"^10\.\d{4,9}/\S+$")] | None = None
    """The dataset's DOI, which Zenodo reserves before it publishes."""
    url: Annotated[str, Field(pattern=r"^https?://\S+$")] | None = None
    """Page of the dataset; that of the DOI by default."""
    description: Annotated[str, Field(max_length=5000)] | None = None
    """Description that replaces that of the scenario."""
    keywords: Annotated[tuple[Line, ...], _FROM_LIST, Field(min_length=1)] | None = None
    """Keywords that replace those which follow from the contents of the dataset."""

    @property
    def year(self) -> int:
        return int(self.published[:4])

    def doubts(self, today: date) -> Iterator[str]:
        """Yield what is allowed, but probably meant otherwise."""
        if (date.fromisoformat(self.published) - today).days > FAR_DAYS:
            yield f"published: {self.published} is more than a year ahead"
        usual = next((name for name in _ARCHIVES if name.lower() == self.publisher.lower()), self.publisher)
        if usual != self.publisher:
            yield f"publisher: {self.publisher} writes its name {usual}, as citations should"

    @property
    def address(self) -> str:
        """The dataset's page; empty where neither a page nor a DOI is known."""
        return self.url or (f"https://doi.org/{self.doi}" if self.doi else "")

    @property
    def citation(self) -> str:
        """The citation in DataCite's order: creators (year): title. Version. Publisher. Address."""
        authors = "; ".join(author.name for author in self.authors)
        parts = (f"{authors} ({self.year}): {self.title}", f"Version {self.version}", self.publisher, self.address)
        return ". ".join(part for part in parts if part)


def read_about(path: Path) -> About:
    """Return the content of a YAML file.

    Raises:
        InputError: The file cannot be read, or something in it is missing or wrong; all faults are reported together.
    """
    root = read_yaml(path).root
    try:
        return About.model_validate(root.plain())
    except ValidationError as error:
        raise together([*_faults(error, root)]) from None


def _faults(error: ValidationError, root: Node) -> Iterator[InputError]:
    """Yield each fault with its line, without those that follow from another one."""
    faults = error.errors(include_url=False)
    unknown = {fault["loc"]: _nearest_key(fault["loc"]) for fault in faults if fault["type"] == "extra_forbidden"}
    misspelt = {(*path[:-1], key) for path, key in unknown.items()}
    with_faults_inside = {fault["loc"][:depth] for fault in faults for depth in range(len(fault["loc"]))}
    for fault in faults:
        path = fault["loc"]
        if path not in with_faults_inside and not (fault["type"] == "missing" and path in misspelt):
            yield _fault(fault["type"], path, fault["msg"], fault["input"], root)


def _fault(kind: str, path: tuple[int | str, ...], message: str, value: object, root: Node) -> InputError:
    """Return a fault of a field with its line."""
    where, field = root.place_of(path), str(path[-1]) if path else ""
    if kind == "extra_forbidden":
        what = f"{dotted(path)}: unknown key"
        cure = _IN_SCENARIO if field in {"licence", "license"} else ""
        return InputError(what, where=where, allowed=", ".join(_keys(path)), nearest=_nearest_key(path), cure=cure)
    if kind == "missing":
        return InputError(f"{dotted(path)}: missing", where=where)
    if kind == "tuple_type" and isinstance(value, str):
        item = f"{{family: {value}}}" if field == "authors" else value
        return InputError(dotted(path), where=where, got=value, allowed="a list", cure=f"write [{item}]")
    if kind == "string_type" and isinstance(value, int | float) and not isinstance(value, bool):
        number = ".".join([*f"{value}".split("."), "0", "0"][:3]) if field == "version" else value
        cure = f'write it as text: {field}: "{number}"'
        return InputError(dotted(path), where=where, got=value, allowed=_ALLOWED.get(field, "text"), cure=cure)
    if kind == "string_pattern_mismatch":
        message = _ALLOWED.get(field, "one line of text that neither begins nor ends with a space")
    return InputError(dotted(path) or "top level", where=where, got=value, allowed=message)


def _keys(path: tuple[int | str, ...]) -> list[str]:
    """Return the keys that are allowed beside that of a path."""
    return [*(Author if path[0] == "authors" else About).model_fields]


def _nearest_key(path: tuple[int | str, ...]) -> str:
    return nearest(path[-1], _keys(path))
