"""Files of the user: images for surfaces and panoramas for the sky, from the folder that `look.assets` names.

A YAML file refers to them by name; the specification of a run refers to each by its content.
"""

from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import Field, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from configs.schema.base import FILE_KEY, FromList, Section, absent

AssetKind = Literal["image", "panorama"]

_Component = Annotated[float, Field(ge=0, le=1e12)]


class Asset(Section):
    """A file and its mean light, so that a scene can be described without opening it."""

    name: str = Field(pattern=r"^[^\x00-\x1f\x7f]{1,255}$")
    """Path relative to the folder."""
    sha256: str = Field(pattern=r"^[0-9a-f]{64}$")
    """SHA-256 of the file's bytes."""
    width_px: int = Field(ge=1, le=1_000_000)
    """Width of the image [px]."""
    height_px: int = Field(ge=1, le=1_000_000)
    """Height of the image [px]."""
    mean_rgb: Annotated[tuple[_Component, _Component, _Component], FromList]
    """Mean linear Rec. 709 colour: of an image (white is 1), or of a panorama's sky by solid angle, without suns."""


@dataclass(frozen=True)
class NamedFile:
    """Marks a field that takes the name of such a file, or one of the shipped names."""

    kind: AssetKind
    known: tuple[str, ...] = ()

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        handler(schema)
        return {"type": "string", FILE_KEY: self.kind, **({"enum": list(self.known)} if self.known else {})}


class ImageLook(Section):
    """An image of the user on a surface, repeated along both axes; seams follow from the image's edges.

    On a floor without rotation the image's right is +x and its top +y.
    """

    file: Annotated[Asset | None, NamedFile("image")] = Field(default_factory=absent)
    """PNG or JPEG file in the folder that `look.assets` names; without it the surface has its usual material."""
    width_m: float = Field(default=1.0, ge=0.01, le=50)
    """Width of one repetition; the height follows from the aspect ratio."""
    right_m: float = Field(default=0.0, ge=-50, le=50)
    """Offset of the lower left corner of one repetition: on a floor from the origin of W, on a face of a wall or
    obstacle from its lower left corner."""
    up_m: float = Field(default=0.0, ge=-50, le=50)
    """Offset of the same corner upwards: towards +y of W on a floor, towards the top of a face [m]."""
    roughness: float = Field(default=0.5, ge=0.05, le=1)
    """Roughness of the surface; 0 is a mirror, 1 is matt."""
    white_reflectance: float = Field(default=0.85, ge=0.05, le=0.95)
    """Reflectance of white in the image; other colours are scaled with it."""


class SurfaceImages(Section):
    """Images on walls and obstacles by surface; range sensors still see the surface."""

    white_board: ImageLook = ImageLook()
    light_grey_board: ImageLook = ImageLook()
    dark_grey_board: ImageLook = ImageLook()
    black_board: ImageLook = ImageLook()
    wood: ImageLook = ImageLook()
    plywood: ImageLook = ImageLook()
    paper: ImageLook = ImageLook()
    cardboard: ImageLook = ImageLook()
    plastic: ImageLook = ImageLook()
    brick: ImageLook = ImageLook()
