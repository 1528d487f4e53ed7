"""The error that ends a run when the board fails."""

from symolo.core.errors import RunFailed


class BoardLost(RunFailed):
    """The board is unplugged, silent, re-booted, or has the wrong firmware; the text is one line that says which."""
