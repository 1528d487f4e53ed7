"""Structure of a surface: what is left of it without its numbers."""

from dataclasses import fields, is_dataclass, replace

from blender_scenes.scene.shading import Expression, Surface


def structure_of(surface: Surface) -> object:
    """Return a value that is equal for surfaces that differ only in their name and in numbers.

    A number counts as zero or not, because a texture that is not turned needs no rotation. Expressions that occur
    several times in a surface count as such, because their shader nodes are shared.
    """
    return _structure(replace(surface, name=""), {})


def _structure(value: object, known: dict[Expression, int]) -> object:
    if isinstance(value, Expression):
        if value in known:
            return "again", known[value]
        known[value] = len(known)
    if is_dataclass(value):
        return type(value), *(_structure(getattr(value, field.name), known) for field in fields(value))
    if isinstance(value, tuple):
        return tuple(_structure(each, known) for each in value)
    return bool(value) if isinstance(value, int | float) else value
