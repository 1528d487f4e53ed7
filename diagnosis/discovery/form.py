"""One form of a law: a slot, an expression of one or two covariates with a few numbers, and where its fit starts.

A form is written as the text of an effect file, and what is fitted is the class of that text. So the file that a user
gets is what was fitted, to the last digit of its numbers.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from configs.effects.base import Effect
from configs.effects.registry import EFFECTS
from diagnosis.discovery.place import LawPlace
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from symolo.core.arrays import Array

FILE = Path("law.py")
"""Path in messages about a text that is not written yet."""
DIGITS = 6
"""Digits of a number in the file."""
MANY = 300
"""Number of different values beyond which the place of a jump is searched between the edges too."""
MIN_FACTOR = 0.05
"""Smallest factor on a quantity, whatever a law adds to it."""
REACH = 50.0
"""Bound of a number of either sign, relative to its start."""


@dataclass(frozen=True)
class LawNumber:
    """One number of a form."""

    name: str
    unit: str
    meaning: str
    start: float
    low: float
    high: float
    null: float | None = None
    """Value without effect; None for a number of shape."""
    is_angle: bool = False
    std: float | None = None
    """Standard error of the start; None if it was not fitted, or if the data do not determine it."""

    @classmethod
    def amplitude(cls, name: str, unit: str, start: float, meaning: str) -> "LawNumber":
        """Return a number of either sign that is 0 without the effect."""
        reach = REACH * abs(start)
        return cls(name, unit, meaning, start, -reach, reach, 0.0)

    def starting_at(self, value: float) -> "LawNumber":
        """Return the number with another start, within its bounds."""
        value = rounded(value)
        if self.null is not None and value == self.null:
            value = self.start
        return replace(self, start=value, low=min(self.low, 2.0 * value), high=max(self.high, 2.0 * value))

    @property
    def declaration(self) -> str:
        null = "None" if self.null is None else _text(self.null)
        numbers = f"null={null}, start={_text(self.start)}, low={_text(self.low)}, high={_text(self.high)}"
        angle = ", is_angle=True" if self.is_angle else ""
        std = "" if self.std is None else f", std={self.std:.2g}"
        return f'{self.name}: Annotated[float, Parameter("{self.unit}", {numbers}{angle}{std})]'


@dataclass(frozen=True)
class LawForm:
    """One form of a law, with the values at which it is tried."""

    place: LawPlace
    shape: str
    """Kind of its dependence, such as `bump`."""
    covariates: tuple[str, ...]
    """Names of the covariates that it depends on."""
    words: str
    """What it is, in words."""
    change: str
    """Expression of what the law adds, or of its result if `is_result`."""
    numbers: tuple[LawNumber, ...]
    tries: tuple[tuple[float, ...], ...]
    """Values of all numbers at which the form is tried."""
    is_result: bool = False
    """Whether `change` is the reading itself, as of a limit, and not what is added."""
    shorthand: str = ""
    """Assignment of a part of the expression to a name."""
    constants: tuple[str, ...] = ()
    """Assignments of constants of the module."""
    material: str = ""
    """The only material with the error; empty for all."""
    jump: int | None = None
    """Index of the number at which the law jumps, so that slopes do not lead to its best value or its error."""
    ending: str = ""
    """End of the name, if another effect has it without one."""

    @property
    def name(self) -> str:
        """Name of the effect."""
        along = "_and_".join(self.place.covariates[name].word for name in self.covariates)
        over, material_suffix = f"_over_{along}" if along else "", "_of_material" if self.material else ""
        return f"{self.place.name}_{self.shape}{over}{material_suffix}{self.ending}"

    @property
    def label(self) -> str:
        """Name with the material, as of other effects."""
        return f"{self.name}[{self.material}]" if self.material else self.name

    @property
    def size(self) -> int:
        return len(self.numbers)

    @cached_property
    def candidate(self) -> CandidateEffect:
        """The form as a hypothesis, like any registered effect."""
        choices = (("material", self.material),) if self.material else ()
        return CandidateEffect(self.kind, choices)

    @cached_property
    def kind(self) -> type[Effect]:
        """The class that its text defines."""
        return EFFECTS.executed(FILE, self.text().encode())

    def starting_at(self, values: Mapping[str, float]) -> "LawForm":
        """Return the form whose numbers start at other values, such as the fitted ones."""
        return replace(self, numbers=tuple(number.starting_at(values[number.name]) for number in self.numbers))

    def with_errors(self, std: Mapping[str, float]) -> "LawForm":
        """Return the form whose starts have standard errors, where these are known."""
        errors = {name: value for name, value in std.items() if np.isfinite(value) and value > 0.0}
        return replace(self, numbers=tuple(replace(number, std=errors.get(number.name)) for number in self.numbers))

    @property
    def is_worth_finer_tries(self) -> bool:
        """Whether it jumps, and more places of the jump are worth a try than the edges."""
        return self.jump is not None and len(np.unique(self._jump_values)) > MANY

    @property
    def _jump_values(self) -> Array:
        return self.place.covariates[self.covariates[0]].values

    def with_width_of_jump(self, values: Mapping[str, float], std: Mapping[str, float]) -> Mapping[str, float]:
        """Return standard errors with at least that of a jump: it may be anywhere between two rows, evenly."""
        if self.jump is None:
            return std
        name, places = self.numbers[self.jump].name, np.unique(self._jump_values)
        after = int(np.searchsorted(places, values[name]))
        if not 0 < after < len(places):
            return std
        between = float(places[after] - places[after - 1]) / np.sqrt(12.0)
        return {**std, name: max(between, std[name]) if np.isfinite(std[name]) else between}

    def finer(self, start: tuple[float, ...], steps: int) -> "LawForm":
        """Return a form that jumps, tried at several values between the neighbours of one of its tries; others as they
        are.
        """
        k = self.jump
        if k is None:
            return self
        tried = sorted({each[k] for each in self.tries})
        at = tried.index(start[k])
        between = np.linspace(tried[max(at - 1, 0)], tried[min(at + 1, len(tried) - 1)], steps)
        return replace(self, tries=tuple((*start[:k], value, *start[k + 1 :]) for value in between.tolist()))

    def named_beside(self, taken: Collection[str]) -> "LawForm":
        """Return the form with a name that no other effect has."""
        endings = ("", *(f"_{k}" for k in range(2, len(taken) + 3)))
        return next(form for end in endings if (form := replace(self, ending=end)).name not in taken)

    def text(self, notes: Sequence[str] = ()) -> str:
        """Return the text of the effect file, with lines about its evidence."""
        place, (result, shorthand) = self.place, self._expressions()
        lines = [
            f'"""{self.words[0].upper()}{self.words[1:]}.',
            *(["", *notes] if notes else []),
            '"""',
            "",
            *self._imports("".join((result, shorthand, *self.constants))),
            "",
            *([*self.constants, ""] if self.constants else []),
            "",
            f"class {_class_name(self.name)}({'OfMaterial' if self.material else 'Effect'}):",
            f"    slot = Slot.{place.slot.name}",
            f'    cause = "not known: {self.words}"',
            f'    excitation = "{self._excitation()}"',
            f"    setups = ({', '.join(place.setups)}{',' if len(place.setups) == 1 else ''})",
            "",
        ]
        for number in self.numbers:
            lines += [f"    {number.declaration}", f'    """{number.meaning}."""']
        lines += ["", f"    def apply(self, {place.arguments}) -> Array:"]
        lines += [f"        {shorthand}"] if shorthand else []
        lines.append(f"        return {result}")
        return "\n".join(lines) + "\n"

    def _expressions(self) -> tuple[str, str]:
        """Return the expression of the result of `apply`, and the assignment before it; empty without one."""
        place, expression, shorthand = self.place, self.change, self.shorthand
        for covariate in (place.covariates[name] for name in self.covariates):
            key = "{" + covariate.name + "}"
            expression = expression.replace(key, covariate.expression)
            shorthand = shorthand.replace(key, covariate.expression)
        if self.material:
            expression = f"self.share(view) * {expression}"
        if place.share:
            expression = f"{place.share} * ({expression})"
        result = expression if self.is_result else f"{place.first} + {expression}"
        if place.is_factor:
            result = f"{place.first} * np.maximum(1.0 + {expression}, {MIN_FACTOR})"
        if place.is_odd:
            size = expression if self.is_result else f"np.maximum(np.abs({place.first}) + {expression}, 0.0)"
            result = f"np.copysign({size}, {place.first})"
        return result, shorthand

    def _imports(self, code: str) -> list[str]:
        """Return the lines of the imports that the code of the file needs."""
        numeric = ["import numpy as np"] if "np." in code else []
        numeric += ["from scipy.interpolate import CubicSpline"] if "CubicSpline(" in "".join(self.constants) else []
        further = [*self.place.imports]
        if self.material:
            further.append("from sensors.ranging.of_material import OfMaterial")
        return [
            "from typing import Annotated",
            "",
            *([*numeric, ""] if numeric else []),
            f"from configs.effects.base import {'' if self.material else 'Effect, '}Setup, Slot",
            "from configs.effects.parameter import Parameter",
            *sorted(further),
            "from symolo.core.arrays import Array",
        ]

    def _excitation(self) -> str:
        """Return the ranges of the covariates in which the data show the law."""
        along = [self.place.covariates[name] for name in self.covariates]
        ranges = ", ".join(f"{covariate.words} from {covariate.low:.3g} to {covariate.high:.3g}" for covariate in along)
        return ranges or f"rows in which {self.place.noun} is read, and others"


def _class_name(name: str) -> str:
    return "".join(word.capitalize() for word in name.split("_"))


def rounded(value: float) -> float:
    """Return a number with as many digits as the file has."""
    return float(f"{value:.{DIGITS}g}")


def _text(value: float) -> str:
    value = rounded(value)
    return repr(float(value)) if np.isfinite(value) else "0.0"


def sized(place: LawPlace, word: str, meaning: str) -> LawNumber:
    """Return a number of either sign in the unit of the slot."""
    return LawNumber.amplitude(with_unit(word, place.unit), place.unit, place.size, meaning)


def with_unit(word: str, unit: str) -> str:
    """Return the name of a number, which ends in its unit."""
    if unit == "1":
        return word
    unit = unit.replace(" ", "_").replace("rad/s", "rad_s").replace("1/", "per_")
    return f"{word}_{unit.replace('/', '_per_')}"


def unit_per(unit: str, other: str) -> str:
    """Return the unit of a slope."""
    if unit == other:
        return "1"
    return f"{unit} s/rad" if other == "rad/s" else f"{unit}/{other}"
