"""Enumerations whose members are texts, as `enum.StrEnum` of Python 3.11 and later."""

import enum


class TextEnum(str, enum.Enum):
    """Members compare, print and format as their values."""

    __str__ = str.__str__
    __format__ = str.__format__
