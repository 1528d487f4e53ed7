"""What all kinds of cases have in common."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, NamedTuple

import numpy as np

from benchmarks.diagnosis.independent_cases.disturbances import Plan
from benchmarks.diagnosis.independent_cases.recipes import Array, Effect, Recipe, Variant

Column = tuple[Any, str]  # the values of one column and their %-format
Table = dict[str, Column]


class CaseFiles(NamedTuple):
    """Content of nominal.yaml and of the CSV files of one case."""

    nominal: dict[str, Any]
    tables: dict[str, Table]


class Setting(ABC):
    """Everything of one case but its effects: hardware, inputs, noise and disturbances."""

    KIND: ClassVar[str]
    PLACE: ClassVar[Mapping[str, str]]
    """Place of every listed effect that this kind draws; effects of one place are not drawn together."""
    OUTSIDE: ClassVar[Sequence[str]]
    """Names of the effects that the format does not list."""
    FURTHER: ClassVar[Sequence[str]] = ()
    """Names of such effects that only the evaluation of discovery draws."""
    IN_NOISE: ClassVar[tuple[str, ...]] = ()
    """Listed effects that change the noise and not the mean of the readings."""

    individual: dict[str, float]
    tolerance_factor: float
    plan: Plan

    @abstractmethod
    def __init__(self, rng: np.random.Generator) -> None:
        """Draw a setting."""

    def prepare(self, names: Sequence[str], rng: np.random.Generator) -> bool:
        """Adapt the setting to the effects that it is to show; return False where it cannot show them."""
        del names, rng
        return True

    def plausible(self, variant: Variant) -> bool:
        """Return whether data of the true robot make sense."""
        del variant
        return True

    @property
    @abstractmethod
    def tolerance_names(self) -> list[str]:
        """Names of the nominal parameters whose tolerance can show in the data."""

    @property
    def rival_names(self) -> list[str]:
        """Listed names that an effect is compared with."""
        return [name for name in self.PLACE if name not in self.IN_NOISE]

    @abstractmethod
    def recipe(self, name: str, rng: np.random.Generator) -> Recipe:
        """Draw the recipe of a listed or outside effect."""

    def noise_ratio(self, effect: Effect, others: Sequence[Effect]) -> float:
        """Return the likelihood ratio of an effect of the noise beside other effects of the noise.

        It is twice the Kullback-Leibler divergence between the Gaussian models with and without the effect.
        """
        raise NotImplementedError

    @abstractmethod
    def signatures(self, variants: Sequence[Variant], noise_effects: Sequence[Effect]) -> Array:
        """Return white predictions of the fit rows in true standard deviations, (variants, values)."""

    @abstractmethod
    def produce(self, variant: Variant, rng: np.random.Generator) -> CaseFiles:
        """Draw the data of the case."""

    @abstractmethod
    def describe(self) -> dict[str, Any]:
        """Return what truth.json reports about the setting."""
