"""Why an attempt at an arena is rejected."""

BEYOND_THE_FLOOR = "the line or a wall reaches beyond the floor"


class Rejected(Exception):  # noqa: N818 - a rejected attempt is not an error; the generator makes a new one
    """The text is the reason. All attempts with the same reason have the same text, so that they can be counted."""
