"""The files of a user's own effects and sensors, as a dataset keeps them: enough to make the same data again."""

import hashlib

from pydantic import Field, TypeAdapter, model_validator

from symolo.dataset.documents.record import Record

CODE_FILES = ("effect_files", "sensor_files")
"""Keys of a robot with such records."""
MAX_CHARACTERS = 200_000
_REFUSED = r"\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069/\\:"
"""Characters that control a terminal, turn the direction of a text, or lead to another folder or drive."""
FILE_NAME = rf"^[^{_REFUSED}.][^{_REFUSED}]{{0,250}}\.py$"
"""A name that leads nowhere else, for `symolo effect extract` and `sensor extract` write files of these names."""


class CodeRecord(Record):
    """A file as metadata.json has it; nothing executes its text."""

    name: str
    file: str = Field(pattern=FILE_NAME)
    sha256: str
    text: str = Field(max_length=MAX_CHARACTERS)

    @model_validator(mode="after")
    def _fits_its_hash(self) -> "CodeRecord":
        if hashlib.sha256(self.text.encode()).hexdigest() != self.sha256:
            raise ValueError("the text does not have the SHA-256 that is stated")
        return self


RECORDS: TypeAdapter[list[CodeRecord]] = TypeAdapter(list[CodeRecord])
