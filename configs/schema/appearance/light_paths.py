"""Settings of the paths of light: bounces, caustics, and the limit on the light of one path."""

from typing import Literal

from pydantic import Field

from configs.schema.base import Section

LightPathPreset = Literal["auto", "standard", "complete"]
"""`blender_scenes.render.light_paths` has the numbers of each."""


class LightPaths(Section):
    """How far light is followed from surface to surface. A number below replaces that of the preset."""

    preset: LightPathPreset = "auto"
    """`complete` follows all light. `standard` has fewer bounces, no caustics, and a limit on the light of one path;
    its images have 97 to 102 % of the light. `auto` is `complete` for `quality: reference` and for long runs, which
    choose their samples themselves; otherwise it is `standard`."""
    diffuse_bounces: int | None = Field(default=None, ge=0, le=1024)
    """Maximum number of matt surfaces that a path of light meets after the first surface."""
    glossy_bounces: int | None = Field(default=None, ge=0, le=1024)
    """Maximum number of mirror images within one another."""
    transmission_bounces: int | None = Field(default=None, ge=0, le=1024)
    """Maximum number of glass faces that a path passes; a pane has two."""
    caustics: bool | None = None
    """Whether gloss and glass throw patches of light on matt surfaces. Without caustics, surfaces are matt for light
    that they reflect to a matt surface, but for the hoods of lamps; and light passes glass in a straight line."""
    clamp: float | None = Field(default=None, ge=0, le=1e6)
    """Maximum of the light of one path behind its first surface, in multiples of the light that the exposure renders
    white; it removes single bright pixels. 0 for no limit."""
