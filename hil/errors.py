"""How a run with a board ends when the board does not do its part."""

from symolo.core.errors import RunFailed


class BoardLost(RunFailed):
    """The board is gone, silent, re-booted, or not the one that is needed; the text is one line that says which."""
