"""The settings of light paths, their presets, and what a run states about them."""

import pytest
from pydantic import ValidationError

from blender_scenes.render.light_paths import LIGHT_PATHS, LightPathLimits, light_path_limits
from blender_scenes.render.sampling import MIN_PROBED_IMAGES, tracing_settings
from configs.schema.appearance.light_paths import LightPaths
from configs.schema.scenario import Render


def test_the_complete_preset_has_no_limit_but_bounces_that_carry_no_light():
    """A white room, which reflects 0.9 everywhere, has lost all but a thousandth after 64 bounces."""
    complete = LIGHT_PATHS["complete"]
    assert complete.caustics
    assert complete.clamp == 0
    assert 0.9 ** min(complete.diffuse_bounces, complete.glossy_bounces, complete.transmission_bounces) < 0.002


@pytest.mark.parametrize("quality", ["draft", "standard", "high", "reference"])
def test_only_a_reference_is_complete_by_itself(quality):
    expected = LIGHT_PATHS["complete" if quality == "reference" else "standard"]
    assert tracing_settings(Render(quality=quality), seed=1).paths == expected


def test_a_run_that_chooses_its_samples_follows_all_light_unless_it_is_set_otherwise():
    chosen, asked = (
        tracing_settings(Render(light_paths=LightPaths(preset=preset)), seed=1, images=MIN_PROBED_IMAGES)
        for preset in ("auto", "standard")
    )
    assert chosen.probe
    assert asked.probe
    assert chosen.paths == LIGHT_PATHS["complete"]
    assert asked.paths == LIGHT_PATHS["standard"]


def test_each_number_replaces_that_of_the_preset():
    paths = LightPaths(preset="complete", diffuse_bounces=2, caustics=False, clamp=8.0)
    complete = LIGHT_PATHS["complete"]
    expected = LightPathLimits(2, complete.glossy_bounces, complete.transmission_bounces, caustics=False, clamp=8.0)
    assert light_path_limits(paths, "standard") == expected


def test_the_number_of_bounces_of_a_path_is_the_largest_of_all_kinds():
    assert LightPathLimits(1, 2, 7, caustics=False, clamp=0.0).max_bounces == 7


def test_a_specification_states_light_paths_that_are_not_the_default_ones():
    assert "light_paths" not in Render().model_dump()
    assert Render(light_paths=LightPaths(preset="complete")).model_dump()["light_paths"]["preset"] == "complete"


@pytest.mark.parametrize("wrong", [{"diffuse_bounces": -1}, {"clamp": -0.5}, {"preset": "half"}])
def test_impossible_light_paths_are_refused(wrong):
    with pytest.raises(ValidationError):
        LightPaths(**wrong)
