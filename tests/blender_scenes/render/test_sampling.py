"""The user's knob for samples and denoiser, and what may be said beside it."""

from dataclasses import astuple, replace
from typing import get_args

import pytest
from pydantic import ValidationError

from blender_scenes.render.job import FramePose, RenderJob, build_job
from blender_scenes.render.sampling import (
    MIN_HYBRID_IMAGES,
    MIN_PROBED_IMAGES,
    QUALITIES,
    hybrid_samples,
    tracing_settings,
)
from configs.schema.appearance.look import LookConfig
from configs.schema.scenario import Render, RenderQuality


def test_there_are_samples_and_a_denoiser_for_every_quality_and_a_better_one_takes_more():
    assert tuple(QUALITIES) == get_args(RenderQuality) == ("draft", "standard", "high", "reference")
    samples = [quality.samples for quality in QUALITIES.values()]
    assert samples == sorted(set(samples))


@pytest.mark.parametrize(
    ("width_px", "height_px", "times"), [(640, 480, 1), (1280, 960, 1), (320, 240, 2), (80, 60, 2)]
)
def test_an_image_of_a_quarter_of_the_pixels_takes_twice_the_samples(width_px, height_px, times):
    """What four times the pixels are worth: docs/rendering.md. No conclusion is drawn beyond the two sizes."""
    for name in ("draft", "standard", "high"):
        settings = tracing_settings(Render(quality=name, width_px=width_px, height_px=height_px), seed=1)
        assert settings.samples == times * QUALITIES[name].samples


def test_a_reference_has_2048_samples_whatever_its_size():
    for width_px in (64, 640, 2000):
        assert tracing_settings(Render(quality="reference", width_px=width_px), seed=1).samples == 2048


def test_in_between_samples_are_rounded_up():
    """Half the pixels: the root of two times as many."""
    settings = tracing_settings(Render(quality="high", width_px=640, height_px=240), seed=1)
    assert QUALITIES["high"].samples * 2**0.5 <= settings.samples < QUALITIES["high"].samples * 2**0.5 + 1


@pytest.mark.parametrize("name", get_args(RenderQuality))
def test_every_setting_of_a_quality_reaches_the_tracer(name):
    asked = QUALITIES[name]
    settings = tracing_settings(Render(quality=name, width_px=640, height_px=480), seed=7)
    assert (settings.samples, settings.prefilter, settings.denoise_quality) == (
        asked.samples,
        asked.prefilter,
        asked.denoise_quality,
    )
    assert (settings.seed, settings.denoise, settings.device) == (7, True, "CPU")


def test_samples_said_aloud_take_the_place_of_those_of_the_quality_and_nothing_else_of_it():
    whole, fewer = (
        tracing_settings(Render(quality="high"), seed=1),
        tracing_settings(Render(quality="high", samples=3), seed=1),
    )
    assert fewer.samples == 3
    assert (fewer.prefilter, fewer.denoise_quality) == (whole.prefilter, whole.denoise_quality)
    assert not tracing_settings(Render(quality="high", denoise=False), seed=1).denoise


@pytest.mark.parametrize(
    ("chosen", "is_candidate"),
    [
        ({}, True),
        ({"width_px": 320, "height_px": 240}, True),
        ({"width_px": 319}, False),
        ({"quality": "draft"}, False),
        ({"quality": "high"}, False),
        ({"samples": 4}, False),
        ({"denoise": False}, False),
        ({"method": "full"}, False),
    ],
)
def test_hybrid_rendering_is_a_candidate_for_long_runs_of_standard_images(chosen, is_candidate):
    long, short = (
        tracing_settings(Render(**chosen), seed=1, images=count) for count in (MIN_HYBRID_IMAGES, MIN_HYBRID_IMAGES - 1)
    )
    assert (long.hybrid is not None) == is_candidate
    assert long.probe >= is_candidate
    assert short.hybrid is None


def test_a_run_measures_its_errors_only_if_it_is_long_enough_and_leaves_its_samples_open():
    def is_probed(images, **chosen):
        return tracing_settings(Render(**chosen), seed=1, images=images).probe

    assert is_probed(MIN_PROBED_IMAGES)
    assert not is_probed(MIN_PROBED_IMAGES - 1)
    assert not is_probed(199, width_px=160, height_px=120)
    assert is_probed(200, width_px=160, height_px=120)  # as many pixels as 50 images of 320 x 240
    assert not is_probed(1000, quality="high")
    assert not is_probed(1000, samples=4)
    assert not is_probed(1000, method="full")
    assert not is_probed(1000, method="hybrid")


@pytest.mark.parametrize("quality", ["draft", "standard"])
def test_hybrid_rendering_by_name_is_used_for_every_run(quality):
    settings = tracing_settings(Render(method="hybrid", quality=quality, width_px=64), seed=1)
    assert settings.hybrid is not None
    assert not settings.probe


def test_a_card_renders_in_full_unless_hybrid_is_set():
    assert tracing_settings(Render(), 1, "OPTIX", 1000).hybrid is None
    assert tracing_settings(Render(), 1, "OPTIX", 1000).probe
    assert tracing_settings(Render(method="hybrid"), 1, "OPTIX").hybrid


def test_a_draft_takes_fewer_samples_for_each_part():
    rough, fine = (
        tracing_settings(Render(method="hybrid", quality=name), seed=1).hybrid for name in ("draft", "standard")
    )
    assert all(few < more for few, more in zip(astuple(rough), astuple(fine), strict=True))


def test_of_hybrid_rendering_only_the_surfaces_take_more_samples_in_small_images():
    """Twice as many for a quarter of the pixels, as full images do, and no more for fewer still."""
    large, small, tiny = (
        hybrid_samples(Render(method="hybrid", width_px=width, height_px=width * 3 // 4)) for width in (640, 320, 96)
    )
    assert small == replace(large, surfaces=2 * large.surfaces)
    assert tiny == small


def test_a_job_of_full_images_is_the_same_text_as_one_without_the_field_hybrid(arena, robot):
    pose = FramePose(number=1, t_s=0.0, x_m=0.55, y_m=0.0, yaw_rad=0.0)
    whole, parts = (
        build_job(arena, robot, LookConfig(name="plain"), Render(method=method), [pose], seed=5)
        for method in ("full", "hybrid")
    )
    assert '"hybrid"' not in whole.to_json()
    assert RenderJob.from_json(parts.to_json()) == parts


@pytest.mark.parametrize("said", [{"quality": "high"}, {"quality": "reference"}, {"samples": 9}, {"denoise": False}])
def test_what_maps_cannot_give_is_refused_beside_parts(said):
    with pytest.raises(ValidationError, match=next(iter(said))):
        Render(method="hybrid", **said)
    Render(**said)


def test_a_run_is_rendered_at_its_quality_and_on_its_device(arena, robot):
    pose = FramePose(number=1, t_s=0.0, x_m=0.55, y_m=0.0, yaw_rad=0.0)
    render = Render(quality="high", width_px=32, height_px=24)
    job = build_job(arena, robot, LookConfig(name="plain"), render, [pose], seed=5, device="CUDA")
    assert job.sampling == tracing_settings(render, seed=5, device="CUDA")
    assert job.sampling.device == "CUDA"
