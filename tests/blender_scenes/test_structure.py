"""Surfaces that differ only in numbers have one structure, so that Blender's material of one is copied for another."""

from dataclasses import replace

import pytest

from blender_scenes.scene.shading import Color, Constant, Mix, NoiseTexture, Step, Surface
from blender_scenes.scene.structure import structure_of

GRAIN = NoiseTexture((30.0, 3.0), (0.2, 0.7))
SURFACE = Surface("plank", Mix(Step(GRAIN, 0.2, 0.6), Color((0.5, 0.4, 0.3)), Color((0.3, 0.2, 0.1))), roughness=0.4)


def test_other_numbers_and_another_name_leave_the_structure():
    other = Mix(Step(NoiseTexture((9.0, 8.0), (0.1, 0.3)), 0.1, 0.9), Color((0.9, 0.8, 0.7)), Color((0.6, 0.4, 0.1)))
    assert structure_of(Surface("board", other, roughness=0.7)) == structure_of(SURFACE)


@pytest.mark.parametrize(
    "other",
    [
        replace(SURFACE, transmission=1.0),
        replace(SURFACE, encloses_lamp=True),
        replace(SURFACE, height_m=GRAIN * 0.001),
        replace(SURFACE, roughness=Constant(0.4)),
        replace(SURFACE, base_color=Color((0.5, 0.4, 0.3))),
        replace(SURFACE, base_color=replace(SURFACE.base_color, by=Step(replace(GRAIN, turn_rad=0.1), 0.2, 0.6))),
        replace(SURFACE, base_color=replace(SURFACE.base_color, by=Step(replace(GRAIN, shift=GRAIN), 0.2, 0.6))),
    ],
)
def test_other_nodes_make_another_structure(other):
    assert structure_of(other) != structure_of(SURFACE)


def test_an_expression_that_occurs_again_makes_another_structure_than_two_of_them():
    """Its nodes are shared, so the material of the one has fewer nodes than that of the other."""
    again = replace(SURFACE, roughness=GRAIN * 0.5)
    two = replace(SURFACE, roughness=replace(GRAIN, offset=(0.3, 0.7)) * 0.5)
    assert structure_of(again) != structure_of(two)


def test_a_number_and_an_expression_that_occurs_again_are_not_confused():
    once = Mix(Constant(0.5), Constant(0.2), Constant(0.3))
    again = Mix(Constant(0.5), Constant(0.5), Constant(0.3))
    assert structure_of(Surface("a", once)) != structure_of(Surface("a", again))
