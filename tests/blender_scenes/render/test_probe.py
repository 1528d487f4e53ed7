"""The choice of a run's rendering from the errors of its candidates, and the file with the choice."""

import pytest

from blender_scenes.render.probe import (
    LADDER,
    PROBE,
    CropErrors,
    Decision,
    TracedSamples,
    decide,
    is_decided,
    read_decision,
    to_json,
)
from blender_scenes.render.sampling import HybridSamples, TracingSettings

HYBRID = HybridSamples(4, 2, 8)
JPEG = (8.0, 8.0, 8.0, 8.0)
OPEN = TracingSettings(seed=1, samples=8, denoise=True, hybrid=HYBRID, probe=True)


def _errors(*rendering: float) -> CropErrors:
    return CropErrors(rendering or JPEG, JPEG)


def _decided(by_samples: dict[int, float], hybrid: float | None = None) -> tuple[Decision, list]:
    """Return the decision for errors by candidate, the same in each view, and the candidates that were measured."""
    asked: list[HybridSamples | TracedSamples] = []

    def measure(candidate: HybridSamples | TracedSamples) -> CropErrors:
        asked.append(candidate)
        error = hybrid if isinstance(candidate, HybridSamples) else by_samples[candidate.samples]
        assert error is not None
        return _errors(*(error,) * 4)

    return decide("job", None if hybrid is None else HYBRID, measure), asked


def test_hybrid_rendering_with_a_small_error_is_taken_and_nothing_else_is_measured():
    decision, asked = _decided({}, hybrid=4.0)
    assert decision.hybrid == HYBRID
    assert decision.full is None
    assert asked == [HYBRID]


def test_the_cheapest_full_rendering_with_a_small_error_is_taken_where_hybrid_rendering_is_not_good_enough():
    decision, _ = _decided({2: 16.0, 4: 10.0, 8: 6.0}, hybrid=20.0)
    assert decision.hybrid is None
    assert decision.full == TracedSamples(8)
    assert decision.errors == _errors(*(6.0,) * 4)


def test_steps_that_cannot_do_are_not_measured():
    """The error is 30 times too large: halved with each doubling at best, it takes five doublings."""
    _, asked = _decided({2: 240.0, 64: 5.0})
    assert [candidate.samples for candidate in asked] == [2, 64]


def test_the_most_exact_rendering_is_taken_where_none_is_good_enough():
    decision, _ = _decided({samples.samples: 1000.0 for samples in LADDER})
    assert decision.full == LADDER[-1]
    assert decision.errors.excess > 1


@pytest.mark.parametrize(
    ("rendering", "small"),
    [
        ((6.0, 6.0, 6.0, 6.0), True),  # 1.2 dB below JPEG
        ((7.8, 7.8, 7.8, 7.8), False),  # on the mean, half a decibel is kept in reserve
        ((1.0, 1.0, 1.0, 10.0), True),  # one view 0.97 dB above JPEG
        ((1.0, 1.0, 1.0, 10.5), False),  # one view 1.2 dB above JPEG
        ((-0.5, 0.1, 0.2, 0.1), True),  # noise of the estimate
    ],
)
def test_an_error_is_small_if_it_is_below_that_of_jpeg_on_the_mean_and_nowhere_far_above(rendering, small):
    assert (_errors(*rendering).excess <= 1) == small


def test_the_choice_replaces_what_the_job_leaves_open():
    full = Decision("job", None, TracedSamples(16), _errors()).applied(OPEN)
    assert (full.samples, full.hybrid, full.prefilter, full.probe) == (16, None, "ACCURATE", False)
    hybrid = Decision("job", HYBRID, None, _errors()).applied(OPEN)
    assert (hybrid.hybrid, hybrid.probe) == (HYBRID, False)


def test_the_record_has_decibels_of_the_mean_of_all_views():
    """A mean square of 6.5025 is a ten-thousandth of 255^2."""
    record = CropErrors((6.5025, 6.5025), (65.025, 65.025)).record()
    assert (record.views, record.psnr_db, record.jpeg_psnr_db) == (2, 40.0, 30.0)


def test_only_the_choice_for_the_same_job_counts(tmp_path):
    images, decision = tmp_path / "images", Decision("this job", None, TracedSamples(4), _errors())
    assert read_decision(images, "this job") is None
    (tmp_path / PROBE).write_bytes(to_json(decision))
    assert read_decision(images, "this job") == decision
    assert read_decision(images, "another job") is None
    assert is_decided(OPEN, images, "this job")
    assert not is_decided(OPEN, images, "another job")
    (tmp_path / PROBE).write_bytes(to_json(decision)[:40])
    assert read_decision(images, "this job") is None


def test_fixed_settings_are_decided_without_a_file(tmp_path):
    assert is_decided(TracingSettings(seed=1, samples=8, denoise=True), tmp_path / "images", "job")
