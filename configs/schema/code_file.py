"""The file of a user's own effect or sensor, as a specification keeps it: enough to make the same data again."""

import hashlib
from typing import Annotated

from pydantic import Field, field_validator
from pydantic_core.core_schema import ValidationInfo

from configs.schema.base import Fixed, Section, Slug, disagreement
from symolo.dataset.documents.code_record import FILE_NAME, MAX_CHARACTERS


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
