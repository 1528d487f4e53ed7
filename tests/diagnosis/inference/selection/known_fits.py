"""Fits and effects that are given by their costs and names alone."""

from typing import Any

from configs.effects.base import Slot


class Fake:
    """Fields by their names; as for the fits and effects of a selection, every object equals itself alone."""

    def __init__(self, **fields) -> None:
        vars(self).update(fields)


def fake_effect(name, parameters=1, slot=Slot.RANGE, choices=()) -> Any:
    return Fake(name=name, kind=Fake(name=name, slot=slot), coordinates=range(parameters), choices=choices)


A, B, C, D = (fake_effect(name) for name in "ABCD")
WIDE = fake_effect("WIDE", parameters=2)
NOISE = fake_effect("NOISE", slot=Slot.RANGE_NOISE)


class FakeHypothesis:
    def __init__(self, *effects) -> None:
        self.effects = effects

    def added_to(self, base):
        (effect,) = (effect for effect in self.effects if effect not in base.effects)
        return effect

    def null(self):
        return "null"


def fake_fit(cost, *effects, **fields) -> Any:
    return Fake(cost=cost, hypothesis=FakeHypothesis(*effects), x=f"x of {cost}", **fields)
