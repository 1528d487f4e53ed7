"""The look of a run: floor, tape, walls, light and exposure as plain numbers."""

from configs.schema.base import Section, Slug


class LookConfig(Section):
    name: Slug
    description: str = ""
