"""Descriptions of fields: the texts below them, or those of `Field`, also of fields that a model inherits."""

from typing import Annotated

from pydantic import BaseModel, Field

from symolo.core.field_descriptions import DescribedJsonSchema, field_descriptions

Height = Annotated[float, Field(description="height over the floor [m]")]


class Part(BaseModel):
    mass_kg: float = 1.0
    """Mass [kg],
    with its screws."""
    height_m: Height = 0.1
    """What the type describes needs no further text."""
    name: str = ""

    def text(self) -> str:
        """No field."""
        return self.name


class Wheel(Part):
    mass_kg: float = 0.1
    radius_m: float = Field(default=0.02, alias="radius")
    """Radius [m]."""


class Robot(BaseModel):
    left: Wheel = Wheel()
    """Wheel on the left."""


def test_a_field_has_the_text_below_it_or_that_of_its_type():
    assert field_descriptions(Part) == {
        "mass_kg": "Mass [kg],\nwith its screws.",
        "height_m": "height over the floor [m]",
    }


def test_a_model_inherits_texts_but_not_those_of_fields_that_it_defines_itself():
    assert field_descriptions(Wheel) == {"height_m": "height over the floor [m]", "radius_m": "Radius [m]."}


def test_the_schema_has_the_texts_also_beside_a_reference_and_by_the_alias():
    schema = Robot.model_json_schema(schema_generator=DescribedJsonSchema)
    left = {"$ref": "#/$defs/Wheel", "default": {"height_m": 0.1, "mass_kg": 0.1, "name": "", "radius": 0.02}}
    assert schema["properties"]["left"] == left | {"description": "Wheel on the left."}
    wheel = schema["$defs"]["Wheel"]["properties"]
    assert wheel["radius"]["description"] == "Radius [m]."
    assert "description" not in wheel["mass_kg"]


def test_a_model_without_source_has_no_texts():
    made = type("Made", (BaseModel,), {"__annotations__": {"size_m": float}, "__module__": "nowhere"})
    assert field_descriptions(made) == {}
