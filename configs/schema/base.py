"""Base of all configuration sections, and types of fields with unit and bounds."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, GetJsonSchemaHandler, Strict
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError

from symolo.dataset.layout import NAME_PATTERN

FIXED_KEY = "x-fixed"
"""Key of a field's JSON Schema with the reason why it takes no distribution."""


@dataclass(frozen=True)
class Fixed:
    """Marks a field that takes no distribution, with the reason that the error message quotes."""

    reason: str

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {**handler(schema), FIXED_KEY: self.reason}


FILE_KEY = "x-file"
"""Key of a field's JSON Schema with the kind of user file that the field may name."""


FIELDS_DISAGREE = "fields_disagree"


def disagreement(field: str, got: float | str, allowed: str, cure: str = "") -> PydanticCustomError:
    """Return the error that a section's validator raises when one of its fields contradicts another.

    Args:
        field: The field at fault; empty for the validated field itself.
        got: Its value.
        allowed: Allowed values, in words.
        cure: What to do about it, if it is known.
    """
    context = {"field": field, "got": got, "allowed": allowed, "cure": cure}
    return PydanticCustomError(FIELDS_DISAGREE, "{field}: got {got}, allowed: {allowed}", context)


def absent() -> None:
    """Return a default that JSON Schema does not show, so that files are not completed with it."""


PLANNED = Fixed("the plan needs it before anything is drawn")

# A list of a file becomes a tuple; its items stay strict.
FromList = Strict(strict=False)

Coordinate = Annotated[float, Field(ge=-50, le=50)]
Length = Annotated[float, Field(gt=0, le=50)]
Point2 = Annotated[tuple[Coordinate, Coordinate], FromList, Field(description="x [m], y [m] in W")]
Size3 = Annotated[tuple[Length, Length, Length], FromList, Field(description="size along x, y, z [m]")]
Slug = Annotated[str, Field(pattern=NAME_PATTERN), Fixed("a name is text")]


class Section(BaseModel):
    """A frozen mapping with known keys only; numbers are finite and cannot be written as text."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)
