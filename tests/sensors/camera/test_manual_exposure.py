"""Manual exposure: time, f-number and ISO speed make the exposure, and nothing in the image changes it.

A sensor of ISO speed S saturates at the exposure 78 / S lx s (ISO 12232), and a lens of f-number N gives an area of the
luminance L the illuminance 0.65 L / N^2 in the image. So the linear value, relative to saturation, is
L t S / (120 N^2) (Lagarde and de Rousiers, Moving Frostbite to Physically Based Rendering, 2014, section 5.1).
"""

import numpy as np
import pytest

from configs.loader import load_scenario, load_section
from configs.schema.appearance.camera_look import CameraLook, ManualExposure
from sensors.camera.response import CameraResponse, develop, develop_part, inverse_tone, white_level
from symolo.core.errors import InputError

PLAIN = CameraLook(
    contrast=1, saturation=1, vignetting=0, shot_noise=0, read_noise=0, brightness=0.7, white_balance_adaption=1
)
GREY = np.ones((8, 8, 3), np.float32)


def response(time_s=0.01, iso=100.0, f_number=2.8, base_iso=100.0, **settings):
    manual = ManualExposure(iso=iso, f_number=f_number, base_iso=base_iso)
    update = {"exposure_time_s": time_s, "manual_exposure": manual, **settings}
    return CameraResponse.from_look(PLAIN.model_copy(update=update), (1.0, 1.0, 1.0), 1, 92)


def linear(light_kcd_m2, camera, metered=3.0):
    values = develop_part(light_kcd_m2 * GREY, camera, metered, None)
    return float(inverse_tone(np.asarray(values, float) / 255, 1.0).mean())


def test_the_linear_value_is_that_of_the_exposure_equation():
    """48 cd/m2, as of white paper under 150 lx, at 1/50 s, f/2 and ISO 100: 48 x 0.02 x 100 / (120 x 4) = 0.2."""
    assert linear(0.048, response(0.02, 100.0, 2.0)) == pytest.approx(0.2, rel=1e-4)
    assert linear(0.048, response(0.02, 100.0, 2.8)) == pytest.approx(0.2 / 1.96, rel=1e-4)


@pytest.mark.parametrize(("change", "factor"), [({"time_s": 0.02}, 2), ({"iso": 400}, 4), ({"f_number": 5.6}, 0.25)])
def test_twice_the_time_is_twice_the_light(change, factor):
    assert linear(0.1, response(**change)) == pytest.approx(factor * linear(0.1, response()), rel=1e-4)


def test_twice_the_light_in_the_room_is_twice_the_light_in_the_image_whatever_the_meter_shows():
    camera = response()
    dark, light = (linear(each, camera, metered) for each, metered in ((0.1, 0.1), (0.2, 0.9)))
    assert light == pytest.approx(2 * dark, rel=1e-4)


def test_compensation_acts_as_a_filter_on_the_lens():
    assert linear(0.1, response(compensation_ev=-1.0)) == pytest.approx(0.5 * linear(0.1, response()), rel=1e-4)


def test_neither_brightness_nor_adaption_nor_bright_areas_change_it():
    picture = np.concatenate([0.05 * GREY, 20 * GREY])
    pixels = [
        develop(picture, response(brightness=brightness, exposure_adaption=adaption), 0.3, 1)
        for brightness, adaption in ((0.1, 0.0), (0.9, 1.0))
    ]
    assert np.array_equal(*pixels)
    assert (pixels[0][0, 0, 0], pixels[0][-1, 0, 0]) == (pytest.approx(linear_grey(0.05), abs=1), 255)


def linear_grey(light_kcd_m2):
    return float(develop_part(light_kcd_m2 * GREY, response(), 1.0, None)[0, 0, 0])


def test_what_is_brighter_than_white_is_clipped():
    """White is 1200 N^2 / (1000 t S) kcd/m2: 0.94 at 1/100 s, f/2.8 and ISO 1000."""
    camera = response(iso=1000.0)
    assert white_level(3.0, camera) == pytest.approx(0.120 * 2.8**2 / (0.01 * 1000.0))
    assert develop(10 * white_level(3.0, camera) * GREY, camera, 3.0, 1).min() == 255


@pytest.mark.parametrize(("iso", "base_iso"), [(100.0, 100.0), (400.0, 100.0), (1600.0, 100.0), (1600.0, 200.0)])
def test_noise_is_that_of_the_electrons_that_are_left_for_white(iso, base_iso):
    """A pixel of 10000 electrons, shot noise 1 %, with 8 electrons of read noise.

    At four times its base ISO speed, 2500 electrons are white. A quarter of that has a standard deviation of
    sqrt(625 + 8^2) electrons, 1.05 % of white.
    """
    camera = response(iso=iso, base_iso=base_iso, shot_noise=0.01, read_noise=0.0008)
    even = np.full((300, 300, 3), 0.25 * white_level(3.0, camera), np.float32)
    values = inverse_tone(np.asarray(develop_part(even, camera, 3.0, 1), float) / 255, 1.0)
    white = 10_000 * base_iso / iso
    electrons = np.random.default_rng(1).poisson(0.25 * white, 400_000) + np.random.default_rng(2).normal(0, 8, 400_000)
    assert values.std() == pytest.approx(np.sqrt(0.25 * white + 8**2) / white, rel=0.02)
    assert values.std() == pytest.approx(electrons.std() / white, rel=0.02)


@pytest.mark.parametrize("change", [{"time_s": 0.02}, {"f_number": 5.6}, {"compensation_ev": -1.0}])
def test_noise_of_white_follows_nothing_but_the_gain(change):
    noisy = {"shot_noise": 0.01, "read_noise": 0.0008}
    one, other = response(**noisy), response(**change, **noisy)
    assert (one.shot_noise, one.read_noise) == (other.shot_noise, other.read_noise) == (0.01, 0.0008)


def test_noise_of_an_automatic_camera_is_as_it_is_set():
    automatic = CameraResponse.from_look(CameraLook(shot_noise=0.02, read_noise=0.001), (1.0, 1.0, 1.0), 1, 92)
    assert (automatic.shot_noise, automatic.read_noise) == (0.02, 0.001)


def test_an_automatic_camera_has_the_settings_of_before():
    assert "manual_exposure" not in CameraLook().model_dump(mode="json")


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (["look.camera.manual_exposure.iso=200"], "look.camera.exposure_time_s: got 0.0, allowed: more than 0"),
        (["look.camera.manual_exposure.iso=200", "look.camera.exposure_time_s=10"], "is it in seconds? 10 ms are 0.01"),
        (
            ["look.camera.manual_exposure.iso=50", "look.camera.exposure_time_s=0.01"],
            "look.camera.manual_exposure.iso: got 50.0, allowed: at least the base_iso of 100",
        ),
        (["look.camera.manual_exposure={f_number: 2}", "look.camera.exposure_time_s=0.01"], "iso: missing"),
    ],
)
def test_an_exposure_that_no_camera_has_is_refused(settings, message):
    with pytest.raises(InputError) as error:
        load_scenario("smoke", settings)
    assert message in str(error.value)


def test_a_look_and_a_further_camera_may_have_it():
    manual = ["look.camera.manual_exposure.iso=200", "look.camera.exposure_time_s=0.01"]
    load_section("look", "lab", manual)
    load_scenario("smoke", [*manual, "robot.sensors={rear: {kind: camera, exposure_time_s: 0.02}}"])
    with pytest.raises(InputError, match=r"robot\.sensors\.rear.*exposure_time_s"):
        load_scenario("smoke", [*manual, "robot.sensors={rear: {kind: camera, exposure_time_s: 0.0}}"])
