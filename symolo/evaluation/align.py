"""The choice of an alignment, which the command line loads without NumPy."""

from symolo.core.text_enum import TextEnum


class Align(TextEnum):
    """Alignments of estimates with the true poses."""

    NONE = "none"
    SE2 = "se2"
    START = "start"
