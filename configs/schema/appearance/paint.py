"""Colours of painted, printed or dyed surfaces."""

from pydantic import Field

from configs.schema.base import Section


class Paint(Section):
    """A colour given by its reflectance and its tint."""

    reflectance: float = Field(ge=0.01, le=0.95)
    """Luminous reflectance."""
    hue_deg: float = Field(default=40.0, ge=-360, le=360)
    """Hue: 0 red, 60 yellow, 120 green, 240 blue."""
    saturation: float = Field(default=0.0, ge=0, le=1)
    """Saturation of the hue; 0 is grey."""
