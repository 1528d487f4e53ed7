"""Why an arena under way is given up."""

BEYOND_THE_FLOOR = "it reaches beyond the floor"


class Rejected(Exception):  # noqa: N818 - an attempt that is given up is no error; the generator makes another
    """The text says what did not fit, in words that name no single attempt, so that attempts can be counted by it."""
