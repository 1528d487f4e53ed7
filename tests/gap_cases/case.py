"""What a case is made of: simulated robots with or without effects, the data, and the truth behind them."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from .disturbances import Day

Array = NDArray[np.float64]
Value = float | str
Columns = Mapping[str, NDArray]
"""Of data.csv, by name, each (rows,); words or numbers, NaN where a cell is empty."""


@dataclass(frozen=True)
class Effect:
    """One that has a name in the tables of the format."""

    name: str
    parameters: Mapping[str, Value]

    @property
    def variant(self) -> str:
        """The name with its discrete parameter, as `tof_mount_yaw[left]`."""
        words = [value for value in self.parameters.values() if isinstance(value, str)]
        return f"{self.name}[{words[0]}]" if words else self.name


@dataclass(frozen=True)
class Outside:
    """One that is in no table, and where it may be said to live."""

    name: str
    parameters: Mapping[str, float]
    channels: tuple[str, ...]
    covariates: tuple[str, ...]


@dataclass(frozen=True)
class World:
    """A robot to simulate: its own values of the toleranced parameters, by name, and what the textbook leaves out."""

    own: Mapping[str, float]
    effects: tuple[Effect, ...] = ()
    outsides: tuple[Outside, ...] = ()

    def value(self, effect: str, parameter: str, absent: float, word: str | None = None) -> float:
        """Of an effect, with that discrete parameter if it has one; `absent` where the world lacks it."""
        for each in self.effects:
            if each.name == effect and (word is None or word in each.parameters.values()):
                return float(each.parameters[parameter])
        return absent

    def beyond(self, name: str, parameter: str, absent: float = 0.0) -> float:
        """Of the outside effect of this name."""
        for each in self.outsides:
            if each.name == name:
                return each.parameters[parameter]
        return absent


@dataclass(frozen=True)
class Bench:
    """What is known beforehand: nominal.yaml, and the inputs by column, with those of runs that nobody sees."""

    nominal: Mapping
    inputs: Columns
    blind: Mapping[str, Columns] = field(default_factory=dict)

    @property
    def kind(self) -> str:
        return self.nominal["kind"]

    def spreads(self) -> dict[str, tuple[float, float]]:
        """Value and tolerance of every parameter that has one, by name."""
        found = {}
        for section in self.nominal.values():
            if isinstance(section, Mapping):
                for name, leaf in section.items():
                    if isinstance(leaf, Mapping) and "tolerance" in leaf:
                        found[name] = (float(leaf["value"]), float(leaf["tolerance"]))
        return found

    def textbook(self) -> World:
        """The nominal robot."""
        return World({name: value for name, (value, _) in self.spreads().items()})


@dataclass(frozen=True)
class Frame:
    """Readings of a case in a row, as predictions of them are laid out; each (n,).

    Attributes:
        measured: NaN where there is none.
        sigma: Nominal standard deviation.
        holdout: Whether it must not be fitted.
        stage: Number of its stage, by which errors are pooled.
        run: Number of the run of readings along which noise is correlated.
        correlation: Of neighbours in a run; NaN where it is to be estimated.
        usable: Whether a change of it tells of a parameter: not where a motor is about to break away.
    """

    measured: Array
    sigma: Array
    holdout: NDArray[np.bool_]
    stage: NDArray[np.int64]
    run: NDArray[np.int64]
    correlation: Array
    usable: NDArray[np.bool_]


@dataclass(frozen=True)
class Case:
    """Attributes:

    name: Of its folder.
    bench: What was known before.
    columns: Of data.csv.
    blind: Inputs of the runs that nobody sees, by file name.
    world: The robot the data come from.
    day: What the logger and the day did to them.
    """

    name: str
    bench: Bench
    columns: Columns
    blind: Mapping[str, Columns]
    world: World
    day: Day = field(default_factory=Day)

    @property
    def true_bench(self) -> Bench:
        """The bench with the noise that the data have."""
        return replace(self.bench, nominal=self.day.true(self.bench.nominal))
