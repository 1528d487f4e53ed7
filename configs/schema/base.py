"""The base of every configuration section, and the field shorthands that carry unit and bounds."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, Strict

Point2 = Annotated[tuple[float, float], Strict(False), Field(description="x [m], y [m] in W")]
Size3 = Annotated[tuple[float, float, float], Strict(False), Field(description="size along x, y, z [m]")]
Slug = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$")]


class Section(BaseModel):
    """A frozen mapping with known keys only; numbers are finite and never text."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False, use_attribute_docstrings=True)
