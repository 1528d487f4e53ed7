"""The file of a user's own effect or sensor, as a specification keeps it: enough to make the same data again."""

import hashlib
from typing import Annotated

from pydantic import Field, field_validator
from pydantic_core.core_schema import ValidationInfo

from configs.schema.base import Fixed, Section, Slug, disagreement

MAX_CHARACTERS = 200_000
_REFUSED = r"\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069/\\:"
"""Characters that control a terminal, turn the direction of a text, or lead to another folder or drive."""
FILE_NAME = rf"^[^{_REFUSED}.][^{_REFUSED}]{{0,250}}\.py$"
"""A name that leads nowhere else, for `symolo effect extract` and `sensor extract` write files of these names."""


class CodeFile(Section):
    """A Python file with one effect or sensor. A robot file names its path; symolo fills in the rest."""

    name: Slug
    """Name of the effect, or of the kind of sensor."""
    file: Annotated[str, Fixed("it is the name of a file")] = Field(pattern=FILE_NAME)
    """Name of the file, without its folder."""
    sha256: str = Field(pattern=r"^[0-9a-f]{64}$")
    """SHA-256 of the file's bytes."""
    text: str = Field(max_length=MAX_CHARACTERS)
    """Content of the file. It is code: no command executes it, unless the user names a file with this content."""

    @field_validator("text")
    @classmethod
    def _fits_its_hash(cls, text: str, info: ValidationInfo) -> str:
        stated = info.data.get("sha256", "")
        if stated and hashlib.sha256(text.encode()).hexdigest() != stated:
            raise disagreement("", "another text", f"the text whose SHA-256 is {stated}")
        return text
