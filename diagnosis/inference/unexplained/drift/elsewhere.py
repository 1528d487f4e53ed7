"""What is known about the coordinates of a fit beside the rows in which a drift is looked for."""

from dataclasses import dataclass

from symolo.core.arrays import Array


@dataclass(frozen=True)
class Elsewhere:
    """What tolerances, and samples of other quantities, say about a change of the coordinates of a fit."""

    information: Array
    """(P, P)"""
    pull: Array
    """(P,), product of the information with the change that is most probable."""
    squares: float
    """Their sum of squares without a change."""

    def squares_after(self, change: Array) -> float:
        return float(self.squares - 2.0 * change @ self.pull + change @ self.information @ change)
