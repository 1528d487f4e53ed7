"""The user's knob for samples and denoiser, and what may be said beside it."""

from typing import get_args

import pytest

from blender_scenes.job import FramePose, build_job
from blender_scenes.sampling import QUALITIES, sampling
from configs.schema.look import LookConfig
from configs.schema.scenario import Render, RenderQuality


def test_there_are_samples_and_a_denoiser_for_every_quality_and_a_better_one_takes_more():
    assert tuple(QUALITIES) == get_args(RenderQuality) == ("draft", "standard", "high", "reference")
    samples = [quality.samples for quality in QUALITIES.values()]
    assert samples == sorted(set(samples))
    assert QUALITIES["reference"].samples == 2048


@pytest.mark.parametrize("name", get_args(RenderQuality))
def test_a_quality_reaches_the_tracer_whole(name):
    asked = QUALITIES[name]
    found = sampling(Render(quality=name), seed=7)
    assert (found.samples, found.prefilter, found.denoise_quality) == (
        asked.samples,
        asked.prefilter,
        asked.denoise_quality,
    )
    assert (found.seed, found.denoise, found.device) == (7, True, "CPU")


def test_samples_said_aloud_take_the_place_of_those_of_the_quality_and_nothing_else_of_it():
    whole, fewer = sampling(Render(quality="high"), seed=1), sampling(Render(quality="high", samples=3), seed=1)
    assert fewer.samples == 3
    assert (fewer.prefilter, fewer.denoise_quality) == (whole.prefilter, whole.denoise_quality)
    assert not sampling(Render(quality="high", denoise=False), seed=1).denoise


def test_a_run_is_rendered_at_its_quality_and_on_its_device(arena, robot):
    pose = FramePose(number=1, t_s=0.0, x_m=0.55, y_m=0.0, yaw_rad=0.0)
    render = Render(quality="high", width_px=32, height_px=24)
    job = build_job(arena, robot, LookConfig(name="plain"), render, [pose], seed=5, device="CUDA")
    assert job.sampling == sampling(render, seed=5, device="CUDA")
    assert job.sampling.device == "CUDA"
