"""The base of every configuration section, and the field shorthands that carry unit and bounds."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, GetJsonSchemaHandler, Strict
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError

from symolo.dataset.layout import NAME_PATTERN

FIXED_KEY = "x-fixed"
"""Under this key the JSON Schema of a field says why no distribution may stand there."""


@dataclass(frozen=True)
class Fixed:
    """Marks a field in which no distribution may stand, with the reason that the refusal quotes."""

    reason: str

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {**handler(schema), FIXED_KEY: self.reason}


FILE_KEY = "x-file"
"""Under this key the JSON Schema of a field says what kind of file of the user's own its name may stand for."""


FIELDS_DISAGREE = "fields_disagree"


def disagreement(field: str, got: float | str, allowed: str) -> PydanticCustomError:
    """What a section's validator raises when one of its fields does not go with another.

    Args:
        field: The field at fault; empty where it is what the validator stands at.
        got: Its value.
        allowed: What would go, in words.
    """
    context = {"field": field, "got": got, "allowed": allowed}
    return PydanticCustomError(FIELDS_DISAGREE, "{field}: got {got}, allowed: {allowed}", context)


def absent() -> None:
    """A default that JSON Schema does not show, so that no file is filled up with what it leaves out."""


PLANNED = Fixed("the plan needs it before anything is drawn")

# A list of a file becomes a tuple; its items stay strict.
FromList = Strict(strict=False)

Coordinate = Annotated[float, Field(ge=-50, le=50)]
Length = Annotated[float, Field(gt=0, le=50)]
Point2 = Annotated[tuple[Coordinate, Coordinate], FromList, Field(description="x [m], y [m] in W")]
Size3 = Annotated[tuple[Length, Length, Length], FromList, Field(description="size along x, y, z [m]")]
Slug = Annotated[str, Field(pattern=NAME_PATTERN), Fixed("a name is text")]


class Section(BaseModel):
    """A frozen mapping with known keys only; numbers are finite and never text."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, strict=True, allow_inf_nan=False, use_attribute_docstrings=True
    )
