"""A mesh file of the user, for an obstacle or for the body of the robot."""

from typing import Annotated, Literal

from pydantic import Field, field_validator

from configs.schema.base import Fixed, Section, disagreement
from symolo.arena.mesh import unpacked


class MeshFile(Section):
    """A shape from a file in the folder that `arena.assets` or `robot.assets` names."""

    file: Annotated[str, Fixed("it is the name of a file")] = Field(pattern=r"^[^\x00-\x1f\x7f]{1,255}$")
    """File in glTF 2.0 (.glb, .gltf), Wavefront OBJ (.obj) or STL (.stl)."""
    scale: Annotated[float, Fixed("sizes follow from it")] = Field(default=1.0, gt=0, le=1e6)
    """Factor from the lengths of the file to metres: 0.001 for a file in millimetres."""
    up: Annotated[Literal["y", "z"] | None, Fixed("it belongs to the file")] = None
    """Axis of the file that points upwards; by default y for glTF and z for the others."""
    sha256: str = Field(default="", pattern=r"^([0-9a-f]{64})?$")
    """SHA-256 of the file, which symolo fills in."""
    packed: str = Field(default="", max_length=2_000_000)
    """Triangles of the file, which symolo fills in, so that a specification needs no other file."""

    @field_validator("packed")
    @classmethod
    def _is_a_mesh(cls, packed: str) -> str:
        if packed:
            try:
                unpacked(packed)
            except ValueError as error:
                raise disagreement("", "another text", f"a packed mesh; it {error}") from None
        return packed
