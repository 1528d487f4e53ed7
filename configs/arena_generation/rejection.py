"""Why an attempt at an arena is rejected."""

BEYOND_THE_FLOOR = "it reaches beyond the floor"


class Rejected(Exception):  # noqa: N818 - a rejected attempt is not an error; the generator makes another
    """The text is the reason; it is the same for all attempts with that reason, so that they can be counted."""
