"""The user's own files: pictures for surfaces and panoramas for the sky, from the folder that `look.assets` names.

A file of YAML names them; what comes of it, a run's specification, knows each by its content.
"""

from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import Field, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from configs.schema.base import FILE_KEY, FromList, Section, absent

AssetKind = Literal["picture", "panorama"]

_Component = Annotated[float, Field(ge=0, le=1e12)]


class Asset(Section):
    """A file and what its light amounts to, so that a scene can be described without opening it."""

    name: str = Field(pattern=r"^[^\x00-\x1f\x7f]{1,255}$")
    """Path within the folder."""
    sha256: str = Field(pattern=r"^[0-9a-f]{64}$")
    """Of the file's bytes."""
    width_px: int = Field(ge=1, le=1_000_000)
    height_px: int = Field(ge=1, le=1_000_000)
    mean_rgb: Annotated[tuple[_Component, _Component, _Component], FromList]
    """Linear Rec. 709: of a picture all over, white 1; of a panorama above the horizon by solid angle, without suns."""


@dataclass(frozen=True)
class Named:
    """Marks a field that takes the name of such a file, or one of the names that are known without a folder."""

    kind: AssetKind
    known: tuple[str, ...] = ()

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        handler(schema)
        return {"type": "string", FILE_KEY: self.kind, **({"enum": list(self.known)} if self.known else {})}


class ImageLook(Section):
    """A picture of the user's own on a surface, repeated along both of its axes; seams are as the picture's edges are.

    On a floor that is not turned the picture's right is +x and its top +y.
    """

    file: Annotated[Asset | None, Named("picture")] = Field(default_factory=absent)
    """A PNG or JPEG picture in the folder that `look.assets` names; none is the surface's own material."""
    width_m: float = Field(default=1.0, ge=0.01, le=50)
    """Of one repeat; the height follows from the picture's shape."""
    right_m: float = Field(default=0.0, ge=-50, le=50)
    """Where the lower left corner of one repeat lies: from the origin of W on a floor, from the lower left corner on
    a wall's or obstacle's face."""
    up_m: float = Field(default=0.0, ge=-50, le=50)
    roughness: float = Field(default=0.5, ge=0.05, le=1)
    white_reflectance: float = Field(default=0.85, ge=0.05, le=0.95)
    """What the picture's white returns; everything else in proportion."""


class SurfaceImages(Section):
    """Pictures on walls and obstacles of a surface; the surface stays what the range sensors see."""

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
