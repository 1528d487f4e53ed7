"""The cost of the measurement from which a run chooses its rendering, as the plan assumes it."""

import pytest

from blender_scenes.render.image_errors import ImageError
from blender_scenes.render.probe import LADDER, REFERENCES, Candidate, ImageErrors, TracedSamples, decide
from blender_scenes.render.sampling import HybridSamples
from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.planning.plan import (
    CAUSTICS_TIMES,
    DENOISE_S,
    HYBRID_PROBED_SAMPLES,
    PROBED_SAMPLES,
    RENDER_SAMPLE_S,
    ScenarioPlan,
)
from symolo.core.progress import seconds

HYBRID = HybridSamples(4, 2, 8)


@pytest.mark.parametrize(("hybrid", "expected"), [(None, PROBED_SAMPLES), (HYBRID, HYBRID_PROBED_SAMPLES)])
def test_the_plan_counts_the_samples_of_a_choice_without_noise(hybrid, expected):
    """Hybrid rendering or 8 samples are good enough, as the plan assumes. Images of hybrid rendering are not counted,
    because their maps serve the images of the run."""
    measured: list[TracedSamples] = []

    def measure(candidate: Candidate, _samples: int) -> ImageErrors:
        is_good = isinstance(candidate, HybridSamples) or candidate.samples >= LADDER[2].samples
        if isinstance(candidate, TracedSamples) and candidate not in measured:
            measured.append(candidate)
        return ImageErrors.from_images(4 * [ImageError(2.0 if is_good else 10.0, 0.0, 8.0)])

    decision = decide("job", hybrid, 200, measure)
    sample_s = RENDER_SAMPLE_S * CAUSTICS_TIMES
    of_candidates = sum(each.samples + DENOISE_S[each.prefilter] / sample_s for each in measured)
    assert REFERENCES * decision.reference_samples + of_candidates == pytest.approx(expected, abs=0.5)


@pytest.mark.parametrize(("width_px", "height_px", "samples"), [(160, 120, PROBED_SAMPLES), (320, 240, 4)])
def test_the_plan_states_the_samples_of_a_choice(width_px, height_px, samples):
    size = [f"render.width_px={width_px}", f"render.height_px={height_px}", "rates.camera_hz=5"]
    spec = draw_run(load_scenario("symolo", size), "CW", 1)
    text = " ".join(ScenarioPlan.from_specs([spec], 1).text().split())
    assert f" {samples} samples per pixel in each image that a run measures" in text


def test_a_quality_with_several_numbers_of_samples_is_named_once():
    spec = draw_run(load_scenario("symolo", ["render.samples=8"]), "CW", 1)
    fewer = spec.model_copy(update={"render": spec.render.model_copy(update={"samples": 4})})
    assert "quality    standard, 8 or 4 samples per pixel\n" in ScenarioPlan.from_specs([spec, fewer], 1).text()


MEASURED_CORE_S = {
    (320, 1): 13.2, (320, 10): 71.2, (320, 40): 271.1, (640, 1): 18.9, (640, 10): 140.2, (640, 40): 561.8,
}  # fmt: skip
"""CPU time of `symolo render` for a run of `smoke`, by width and number of images (docs/rendering_time.md)."""


@pytest.mark.parametrize(("width_px", "images"), MEASURED_CORE_S)
def test_the_plan_of_a_short_run_is_within_30_percent_of_what_was_measured(width_px, images):
    settings = [
        f"render.width_px={width_px}",
        f"render.height_px={width_px * 3 // 4}",
        "rates.camera_hz=5",
        f"stop.time_limit_s={0.2 * (images - 1) + 0.1}",
    ]
    (run,) = ScenarioPlan.from_specs([draw_run(load_scenario("smoke", settings), "CW", 1)], 2).runs
    assert run.images == images
    assert run.render_core_s == run.full_core_s
    assert run.render_core_s == pytest.approx(MEASURED_CORE_S[width_px, images], rel=0.3)


def test_the_plan_of_a_run_that_chooses_is_within_30_percent_of_one_that_was_measured():
    """60 images of `smoke` are too few for hybrid rendering; they chose 8 samples and took 850 core-s."""
    settings = ["render.width_px=320", "render.height_px=240", "rates.camera_hz=5", "stop.time_limit_s=11.9"]
    (run,) = ScenarioPlan.from_specs([draw_run(load_scenario("smoke", settings), "CW", 1)], 1).runs
    assert run.images == 60
    assert run.render_core_s == run.full_core_s == pytest.approx(850.3, rel=0.3)


def test_the_plan_states_the_time_with_and_without_hybrid_rendering():
    plan = ScenarioPlan.from_specs([draw_run(load_scenario("symolo"), "CW", 1)], 1)
    (run,) = plan.runs
    assert run.render_core_s < 0.3 * run.full_core_s
    expected = f"{seconds(run.render_core_s)}, or {seconds(run.full_core_s)} if hybrid rendering is too inexact\n"
    assert f"render     about {expected}" in plan.text()
    only_hybrid = ScenarioPlan.from_specs([draw_run(load_scenario("symolo", ["render.method=hybrid"]), "CW", 1)], 1)
    assert "too inexact" not in only_hybrid.text()
