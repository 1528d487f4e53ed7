"""Parameters of the effects of one variant of a drive."""

from benchmarks.diagnosis.other_robots.draws import Array
from benchmarks.diagnosis.other_robots.drives.robot import NOMINAL
from benchmarks.diagnosis.other_robots.effects import Key, Table, columns


class Values:
    """Parameters by effect, and by its discrete parameter."""

    def __init__(self, table: Table, keys: list[Key], theta: Array) -> None:
        split = columns(table, keys, theta[None], NOMINAL)
        self.parameters = {key: [float(column[0]) for column in values] for key, values in split}

    def one(self, name: str, absent: float = 0.0) -> float:
        """Return the first parameter of an effect, or its value in the absence of the effect."""
        return self.parameters[name, None][0] if (name, None) in self.parameters else absent

    def all(self, name: str, discrete: str | None = None) -> list[float] | None:
        """Return all parameters of an effect, or None in its absence."""
        return self.parameters.get((name, discrete))

    def at(self, name: str, discrete: str) -> float:
        """Return the size of an effect at a side or a sensor, or zero."""
        return self.parameters.get((name, discrete), [0.0])[0]
