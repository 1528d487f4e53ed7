"""The choice of a run's rendering from the errors of its candidates, and the file with the choice."""

from dataclasses import replace

import numpy as np
import pytest

from blender_scenes.render.image_errors import ImageError
from blender_scenes.render.probe import (
    LADDER,
    PROBE,
    Decision,
    ImageErrors,
    TracedSamples,
    decide,
    is_decided,
    probed_numbers,
    read_decision,
    to_json,
)
from blender_scenes.render.sampling import HybridSamples, TracingSettings

HYBRID = HybridSamples(4, 2, 8)
JPEG = (8.0, 8.0, 8.0, 8.0)
CERTAIN = (0.0, 0.0, 0.0, 0.0)
OPEN = TracingSettings(seed=1, samples=8, denoise=True, hybrid=HYBRID, probe=True)


def _errors(*rendering: float) -> ImageErrors:
    return ImageErrors(rendering or JPEG, JPEG, CERTAIN)


def _decided(by_samples: dict[int, float], hybrid: float | None = None) -> tuple[Decision, list]:
    """Return the decision for errors by candidate, the same in each view, and the candidates that were measured."""
    asked: list[HybridSamples | TracedSamples] = []

    def measure(candidate: HybridSamples | TracedSamples, _samples: int) -> ImageErrors:
        asked.append(candidate)
        error = hybrid if isinstance(candidate, HybridSamples) else by_samples[candidate.samples]
        assert error is not None
        return _errors(*(error,) * 4)

    return decide("job", None if hybrid is None else HYBRID, 200, measure), asked


def test_hybrid_rendering_with_a_small_error_is_taken_and_nothing_else_is_measured():
    decision, asked = _decided({}, hybrid=4.0)
    assert decision.hybrid == HYBRID
    assert decision.full is None
    assert asked == [HYBRID]


def test_the_cheapest_full_rendering_with_a_small_error_is_taken_where_hybrid_rendering_is_not_good_enough():
    decision, _ = _decided({2: 8.0, 4: 6.0, 8: 4.5}, hybrid=20.0)
    assert decision.hybrid is None
    assert decision.full == TracedSamples(8)
    assert decision.errors == replace(_errors(*(4.5,) * 4), error_probability=0.025)


def test_steps_that_cannot_do_are_not_measured():
    """With its margin, the error is 25 times too large: halved with each doubling at best, it takes five doublings."""
    _, asked = _decided({2: 140.0, 64: 4.4})
    assert list(dict.fromkeys(candidate.samples for candidate in asked)) == [2, 64]


def _decided_in_noise(images: int, error_of_two: float, standard_error: float, hybrid: float | None = None) -> Decision:
    """Return the decision of a run of so many images where the error is inversely proportional to the samples, and the
    standard error of its estimate, that of references of 8 samples, to theirs."""

    def measure(candidate: HybridSamples | TracedSamples, samples: int) -> ImageErrors:
        error = hybrid if isinstance(candidate, HybridSamples) else error_of_two * 2 / candidate.samples
        return ImageErrors.from_images(4 * [ImageError(error or 0.0, standard_error * 8 / samples, 8.0)])

    return decide("job", None if hybrid is None else HYBRID, images, measure)


@pytest.mark.parametrize(("images", "samples"), [(200, 32), (5000, 64)])
def test_references_get_more_samples_until_their_noise_does_not_decide(images, samples):
    """With 2 samples the error is that of JPEG, 8, with a lower limit of 8 - 1.645 * 6 * 8 / n for references of n.

    It leaves that open for n = 8, 16 and 32 (5.5, and a small error is below 5.6), but not for 64 (6.8). With 4 samples
    the upper limit is 4 + 1.96 * 6 * 8 / n: 9.9 for n = 16, and 6.9 for n = 32, where only 4 - 2 samples for each
    image are left to be saved. A short run does not trace 64 * 16 samples for that.
    """
    decision = _decided_in_noise(images, 8.0, 6.0)
    assert (decision.full, decision.reference_samples) == (TracedSamples(4), samples)


@pytest.mark.parametrize(
    ("error", "standard_error", "samples", "reference_samples"),
    [
        (4.0, 0.25, 2, 1),  # 4 + 1.96 * 2 = 7.9 with references of one sample
        (4.0, 0.5, 2, 4),  # 4 + 1.96 * 4 = 11.8, 4 + 2.39 * 2 = 8.8, 4 + 2.64 * 1 = 6.6
        (3.5, 0.52, 2, 2),  # the noise of one sample, 1.96 * 4.2 = 8.2, hides any error; 3.5 + 1.96 * 2.1 = 7.6
        (4.0, 1.0, 2, 8),
        (64.0, 0.25, 32, 8),  # 2 samples are refused, for which 8 are needed
    ],
)
def test_references_that_show_a_small_error_get_no_more_samples(error, standard_error, samples, reference_samples):
    """The standard errors are those of references of 8 samples; with one sample they are 8 times as large.

    The quantiles of the normal distribution are those of 5 % / 2, 5 % / 6 and 5 % / 12 for the first three tests.
    """
    decision = _decided_in_noise(200, error, standard_error)
    assert (decision.full, decision.reference_samples) == (TracedSamples(samples), reference_samples)


def test_what_more_samples_can_save_follows_from_the_first_test_of_the_next_candidate():
    """References of 16 samples leave open whether 2 samples do: 6.8 - 1.645 * 2 = 3.5. It is their second test. But 4
    samples will pass their first one with 3.4 + 1.96 * 2 = 7.3 (a second one, with 3.4 + 2.39 * 2 = 8.2, would fail).
    So 200 images can save 2 samples each, which is less than the cost of 16 references of 32."""
    decision = _decided_in_noise(200, 6.8, 4.0)
    assert (decision.full, decision.reference_samples) == (TracedSamples(4), 16)


def test_a_long_run_tests_again_a_candidate_that_would_have_passed_a_first_test():
    """With references of 8 samples, 2 samples fail their first test with 4 + 1.96 * 3.6 = 11.1; with those of 16, the
    second one with 4 + 2.39 * 1.8 = 8.3, where 1.96 would pass with 7.5. With 32, 4 + 2.64 * 0.9 = 6.4 passes."""
    decision = _decided_in_noise(5000, 4.0, 3.6)
    assert (decision.full, decision.reference_samples) == (TracedSamples(2), 32)


@pytest.mark.parametrize(
    ("images", "samples"), [(1, 8), (4, 8), (5, 16), (8, 16), (9, 32), (17, 64), (34, 128), (9999, 128)]
)
def test_references_of_more_than_8_samples_cost_no_more_than_they_can_save(images, samples):
    """Noise that hides everything makes a run take 64 samples, and 2 might do: 62 for each image. Four references of
    four images with n samples each cost 16 n."""
    decision = _decided_in_noise(images, 1.0, 1e6)
    assert (decision.full, decision.reference_samples) == (LADDER[-1], samples)


@pytest.mark.parametrize("first_standard_error", [0.5, 2.0])
def test_of_candidates_with_an_error_at_the_limit_at_most_one_of_twenty_is_taken(first_standard_error):
    """Hybrid rendering has the error of JPEG in the first of four images, and nearly none in the others; full rendering
    is exact. With 5 % in each test of up to eight, 14 to 20 % are taken. The standard error is a multiple of JPEG's
    error, for references of one sample. The noise is that of independent values, whose products estimate the error.
    """
    random, values = np.random.Generator(np.random.PCG64(5)), 100
    variance = first_standard_error * 8.0 * (6 * values) ** 0.5
    hybrid_error = np.array([8.0, 0.2, 0.2, 0.2])

    def is_taken() -> bool:
        noise = [random.normal(0, variance**0.5, (4, 4, values))]

        def measure(candidate: HybridSamples | TracedSamples, samples: int) -> ImageErrors:
            while len(noise) < samples:
                noise.append(random.normal(0, variance**0.5, (4, 4, values)))
            errors = hybrid_error if isinstance(candidate, HybridSamples) else 0 * hybrid_error
            signs = (-1) ** np.arange(values)
            references = errors[:, np.newaxis, np.newaxis] ** 0.5 * signs + np.mean(noise, axis=0)
            squares = np.sum(references, axis=1) ** 2 - np.sum(references**2, axis=1)
            of_noise = variance / len(noise)
            standard_errors = ((of_noise**2 / 6 + errors * of_noise) / values) ** 0.5
            rows = zip(squares.mean(axis=-1) / 12, standard_errors, strict=True)
            return ImageErrors.from_images(ImageError(float(error), float(sd), 8.0) for error, sd in rows)

        return decide("job", HYBRID, 9999, measure).hybrid is not None

    # The standard deviation of a share of 5 % of 300 is 1.3 %.
    assert np.mean([is_taken() for _ in range(300)]) < 0.08


def test_noise_that_hides_the_error_of_hybrid_rendering_is_made_smaller():
    """With one, two or four samples, it hides any error. Then the upper limit is 4 + 1.96 * 3 = 9.9 with 8 samples, and
    4 + 2.39 * 1.5 = 7.6 with 16."""
    decision = _decided_in_noise(200, 8.0, 3.0, hybrid=4.0)
    assert (decision.hybrid, decision.reference_samples) == (HYBRID, 16)


def test_the_most_exact_rendering_is_taken_where_none_is_good_enough():
    decision, _ = _decided({samples.samples: 1000.0 for samples in LADDER})
    assert decision.full == LADDER[-1]
    assert decision.errors.excess > 1


@pytest.mark.parametrize(
    ("rendering", "small"),
    [
        ((5.5, 5.5, 5.5, 5.5), True),  # 1.6 dB below JPEG
        ((5.7, 5.7, 5.7, 5.7), False),  # 1.5 dB below JPEG: other images may be above it
        ((1.0, 1.0, 1.0, 8.1), False),  # one of the images that were measured is worse than JPEG
        ((1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0), True),
        ((-0.5, 0.1, 0.2, 0.1), True),  # noise of the estimate
    ],
)
def test_an_error_is_small_if_other_images_are_not_expected_to_exceed_that_of_jpeg(rendering, small):
    assert (ImageErrors.from_images(ImageError(each, 0.0, 8.0) for each in rendering).excess <= 1) == small


def test_no_further_image_is_measured_after_one_that_is_worse_than_its_jpeg():
    good, bad, unseen = ImageError(2.0, 0.1, 8.0), ImageError(9.0, 0.2, 8.0), ImageError(1.0, 0.1, 8.0)
    measured = iter([good, bad, unseen])
    errors = ImageErrors.until_refused(measured)
    assert errors == ImageErrors((2.0, 9.0), (8.0, 8.0), (0.1, 0.2))
    assert errors.excess > 1
    assert next(measured) == unseen
    assert ImageErrors.until_refused([good, unseen]) == ImageErrors.from_images([good, unseen])


@pytest.mark.parametrize(("standard_error", "small"), [(3.0, True), (3.1, False), (8.0, False)])
def test_an_error_whose_noise_may_hide_a_larger_one_than_that_of_jpeg_is_not_small(standard_error, small):
    """The upper limits of 3 with 95 % confidence are 3 + 1.645 * 3 = 7.9, below JPEG, and 3 + 1.645 * 3.1 = 8.1."""
    errors = ImageErrors.from_images([ImageError(3.0, standard_error, 8.0)] + 3 * [ImageError(3.0, 0.0, 8.0)])
    assert (errors.excess <= 1) == small


@pytest.mark.parametrize("count", [4, 8])
@pytest.mark.parametrize(("spread_dB", "most"), [(1.0, 0.07), (2.0, 0.14)])
def test_about_one_image_of_twenty_exceeds_the_limit(count, spread_dB, most):
    """More do where images differ much more than most runs do, as few images do not show it."""
    relative_dB = np.random.Generator(np.random.PCG64(3)).normal(-4.0, spread_dB, (700, count + 1))
    errors = 8.0 * 10 ** (relative_dB / 10)
    limits_dB = np.array(
        [ImageErrors.from_images(ImageError(each, 0.0, 8.0) for each in row[:-1]).limit_dB for row in errors]
    )
    assert np.mean(relative_dB[:, -1] > limits_dB) < most


def test_the_limit_of_many_equal_images_is_that_of_the_spread_that_is_assumed():
    """Upper limit for a normal distribution: mean + t sqrt(s2 (1 + 1/n)), here s2 = 4 / 7 and t = 1.85."""
    assert _errors(8.0, 8.0, 8.0, 8.0).limit_dB == pytest.approx(1.85 * (4 / 7 * 1.25) ** 0.5)


@pytest.mark.parametrize(("images", "measured"), [(50, 4), (200, 4), (300, 6), (400, 8), (5000, 8), (3, 3)])
def test_long_runs_measure_more_images(images, measured):
    numbers = probed_numbers(images)
    assert len(numbers) == measured
    assert all(0 <= number < images for number in numbers)


def test_the_choice_replaces_what_the_job_leaves_open():
    full = Decision("job", None, TracedSamples(16), _errors(), 8).applied(OPEN)
    assert (full.samples, full.hybrid, full.prefilter, full.probe) == (16, None, "ACCURATE", False)
    hybrid = Decision("job", HYBRID, None, _errors(), 8).applied(OPEN)
    assert (hybrid.hybrid, hybrid.probe) == (HYBRID, False)


def test_the_record_has_decibels_of_the_mean_of_all_views():
    """A mean square of 6.5025 is a ten-thousandth of 255^2."""
    record = ImageErrors((6.5025, 6.5025), (65.025, 65.025), (0.0, 0.0)).record()
    assert (record.views, record.psnr_db, record.jpeg_psnr_db) == (2, 40.0, 30.0)
    assert record.relative_limit_db == round(-10 + 1.85 * (4 / 5 * 1.5) ** 0.5, 1)


def test_only_the_choice_for_the_same_job_counts(tmp_path):
    images, decision = tmp_path / "images", Decision("this job", None, TracedSamples(4), _errors(), 8)
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
