"""The measures of `benchmarks/render`: errors of images, their references, and costs at equal error."""

import argparse
import importlib
import threading

import numpy as np
import pytest


@pytest.fixture
def errors():
    return importlib.import_module("benchmarks.render.references.image_error")


@pytest.fixture
def reference():
    return importlib.import_module("benchmarks.render.references.reference")


def grey(values):
    return np.repeat(np.asarray(values, np.uint8)[..., None], 3, axis=-1)


def test_one_level_of_difference_is_48_dB(errors):
    assert errors.psnr_dB(errors.mean_square(grey(np.full((4, 5), 7)), grey(np.full((4, 5), 8)))) == pytest.approx(
        48.1308, abs=1e-4
    )
    assert errors.psnr_dB(0.0) == float("inf")


def test_ssim_of_even_images_is_its_term_of_luminance(errors):
    """Eq. 13 with no variance is (2ab + C1) / (a^2 + b^2 + C1)."""
    a, b, c1 = 60.0, 90.0, 2.55**2
    got = errors.ssim(grey(np.full((20, 20), a)), grey(np.full((20, 20), b)))
    assert got == pytest.approx((2 * a * b + c1) / (a * a + b * b + c1), abs=1e-9)


def test_ssim_is_that_of_scikit_image(errors):
    """Of release 0.26.0: structural_similarity(gaussian_weights=True, sigma=1.5, use_sample_covariance=False)."""
    y, x = np.mgrid[0:40, 0:48]
    plain, disturbed = grey((7 * x + 3 * y) % 256), grey((7 * x + 3 * y + (x * y) % 23) % 256)
    assert errors.ssim(plain, disturbed) == pytest.approx(0.697010262, abs=2e-6)
    assert errors.ssim(plain, plain) == pytest.approx(1.0, abs=1e-12)


def test_a_reference_composed_of_its_passes_is_the_full_image(reference, monkeypatch):
    """Where nothing is denoised, colour times light plus the rest is what was traced."""
    monkeypatch.setattr(reference, "Denoiser", lambda _threads, _quality: lambda light, _normal, _albedo: light)
    colour, direct, indirect, gloss = np.random.Generator(np.random.PCG64(2)).random((4, 3, 4, 3)).astype(np.float32)
    whole = colour * (direct + indirect) + gloss
    passes = np.stack([whole, colour, direct, indirect, np.zeros_like(whole)])
    assert reference.clean(passes) == pytest.approx(whole, abs=1e-6)


def test_a_reference_of_few_samples_is_refused(reference, tmp_path):
    with pytest.raises(ValueError, match="255 samples is too noisy; at least 256"):
        reference.references(None, 255, tmp_path, 1)


def test_the_cheapest_plain_loop_has_the_fewest_samples_whose_error_is_no_larger():
    plain = importlib.import_module("benchmarks.render.contenders.plain_loop")
    errors = {8: 3.0, 2: 9.0, 4: 5.0}
    assert [plain.fewest_samples(errors, largest) for largest in (2.9, 3.0, 6.0, 9.0)] == [None, 8, 4, 2]


def test_the_start_of_a_run_is_spread_over_200_images():
    plain = importlib.import_module("benchmarks.render.contenders.plain_loop")
    assert plain.RunCost(set_up_s=50.0, image_s=1.5).per_image_s == pytest.approx(1.75)


@pytest.fixture
def judge(monkeypatch):
    """Judges named cases by a function that stands for the rendering."""
    fresh_draws = importlib.import_module("benchmarks.render.errors.fresh_draws")
    views = importlib.import_module("benchmarks.render.references.views")

    def judge(judged_case, names, **options):
        monkeypatch.setattr(fresh_draws, "judged_case", lambda case, _options, _device: judged_case(case.look))
        cases = [views.RandomCase(name, 1, 7) for name in names]
        return list(fresh_draws.judged_cases(cases, argparse.Namespace(**options), "CPU"))

    return judge


def test_several_cases_are_judged_at_a_time(judge):
    all_started = threading.Barrier(3, timeout=5)

    def judged(look):
        all_started.wait()
        return [look]

    assert sorted(judge(judged, "abc", processes=3, stop_after=None)) == [["a"], ["b"], ["c"]]


def test_no_case_starts_late_and_one_that_fails_does_not_stop_the_others(judge, capsys):
    def judged(look):
        if look == "a":
            raise ChildProcessError("Blender died")
        return [look]

    assert judge(judged, "ab", processes=1, stop_after=60) == [["b"]]
    assert "a 1: Blender died" in capsys.readouterr().out
    assert judge(judged, "ab", processes=1, stop_after=0) == [[], []]
