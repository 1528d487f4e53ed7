from dataclasses import replace
from math import erf, exp, sqrt

import cv2
import numpy as np
import pytest
from pydantic import TypeAdapter

from configs.schema.appearance.look import CameraLook
from sensors.camera.colour import light_rgb
from sensors.camera.metering import median_luminance
from sensors.camera.response import (
    CameraResponse,
    corner_share,
    develop,
    develop_part,
    encode_jpeg,
    inverse_tone,
    tone,
    white_level,
)

PLAIN = CameraLook(
    contrast=1, saturation=1, vignetting=0, shot_noise=0, read_noise=0, brightness=0.18, white_balance_adaption=1
)
GREY = np.full((48, 64, 3), 3.0, np.float32)


def _response(look: CameraLook = PLAIN, light=(1.0, 1.0, 1.0), seed: int = 1) -> CameraResponse:
    return CameraResponse.from_look(look, light, seed, jpeg_quality=92)


def test_the_median_becomes_middle_grey_whatever_the_light():
    for light in (0.01, 3.0, 500.0):
        pixels = develop(light * GREY, _response(), median_luminance(light * GREY), 1)
        assert np.all(pixels == 118)  # 255 (1.055 * 0.18^(1/2.4) - 0.055), IEC 61966-2-1


def test_one_exposure_for_the_run_keeps_the_difference_between_frames_and_full_adaption_removes_it():
    fixed = _response(PLAIN.model_copy(update={"exposure_adaption": 0.0}))
    own = _response(PLAIN.model_copy(update={"exposure_adaption": 1.0}))
    assert develop(0.5 * GREY, fixed, 3.0, 1).mean() < develop(GREY, fixed, 3.0, 1).mean() - 20
    assert np.array_equal(develop(0.5 * GREY, own, 3.0, 1), develop(GREY, own, 3.0, 1))


def test_the_balanced_light_is_neutral():
    light = light_rgb(3200)
    lit = GREY * np.array(light, np.float32)
    pixels = develop(lit, _response(light=light), median_luminance(lit), 1)
    assert np.ptp(pixels[0, 0].astype(int)) <= 1
    unbalanced = PLAIN.model_copy(update={"white_balance_adaption": 0.0, "white_balance_K": 6504.0})
    warm = develop(lit, _response(unbalanced, light), median_luminance(lit), 1)[0, 0].astype(int)
    assert warm[0] > warm[1] > warm[2]


def test_brighter_light_never_makes_a_darker_pixel_and_never_overflows():
    ramp = np.repeat(np.geomspace(1e-3, 1e3, 256, dtype=np.float32)[None, :, None], 3, axis=2)
    values = develop(ramp, _response(CameraLook(vignetting=0, shot_noise=0, read_noise=0)), 1.0, 1)[0, :, 1]
    assert np.all(np.diff(values.astype(int)) >= 0)
    assert values[0] < 30
    assert values[-1] == 255


def test_vignetting_takes_its_share_in_the_corner_and_nothing_in_the_middle():
    look = PLAIN.model_copy(update={"vignetting": 0.4, "exposure_adaption": 0.0})
    plain = develop(np.full((481, 641, 3), 0.1, np.float32), _response(), 0.1, 1)
    shaded = develop(np.full((481, 641, 3), 0.1, np.float32), _response(look), 0.1, 1)
    linear = (((shaded / 255) + 0.055) / 1.055) ** 2.4
    assert shaded[240, 320, 1] == plain[240, 320, 1]
    assert linear[0, 0, 1] == pytest.approx(0.6 * 0.18, rel=0.02)


def test_shading_raises_the_light_by_its_stops_from_border_to_border():
    look = PLAIN.model_copy(update={"shading_right_ev": 1.0, "shading_down_ev": -0.5, "exposure_adaption": 0.0})
    shaded = develop(np.full((481, 641, 3), 0.1, np.float32), _response(look), 0.1, 1)[..., 1]
    linear = (((shaded / 255) + 0.055) / 1.055) ** 2.4
    assert linear[240, 640] / linear[240, 0] == pytest.approx(2.0, rel=0.02)
    assert linear[480, 320] / linear[0, 320] == pytest.approx(2**-0.5, rel=0.02)
    assert linear[240, 320] == pytest.approx(0.18, rel=0.02)


@pytest.mark.parametrize(("right_ev", "down_ev"), [(2.0, 0.0), (0.0, 2.0)])
def test_shading_along_one_side_alone_is_even_between_the_middles_of_the_pixels(right_ev, down_ev):
    """Two stops over four pixels are half a stop each, and the middle is a quarter of a stop from its neighbours."""
    look = PLAIN.model_copy(update={"shading_right_ev": right_ev, "shading_down_ev": down_ev, "exposure_adaption": 0.0})
    linear = decoded(develop(np.full((4, 4, 3), 0.1, np.float32), _response(look), 0.1, 1)[..., 1])
    shaded = 0.18 * 2.0 ** np.array([-0.75, -0.25, 0.25, 0.75])
    expected = np.tile(shaded, (4, 1))
    assert linear == pytest.approx(expected if right_ev else expected.T, rel=0.02)


def test_noise_belongs_to_the_frame_and_grows_with_the_root_of_the_light():
    look = PLAIN.model_copy(update={"shot_noise": 0.05})
    light = np.full((240, 320, 3), 1.0, np.float32)
    light[:, 160:] = 4.0
    one, again, other = (develop(light, _response(look), 2.0, number).astype(int) for number in (1, 1, 2))
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)
    linear = ((one / 255 + 0.055) / 1.055) ** 2.4
    dark, bright = linear[:, :150, 1], linear[:, 170:, 1]
    assert dark.std() == pytest.approx(0.05 * np.sqrt(dark.mean()), rel=0.1)
    assert bright.std() / dark.std() == pytest.approx(2.0, rel=0.1)


def test_the_white_balance_amplifies_the_noise_of_the_sensor():
    """Raw blue of b times the green has sqrt(b) of its shot noise; the gain 1 / b makes 1 / sqrt(b) of that."""
    light = np.array(light_rgb(3000), np.float32)
    lit = np.full((240, 320, 3), light / light[1], np.float32)
    look = PLAIN.model_copy(update={"shot_noise": 0.02})
    pixels = develop(lit, _response(look, tuple(light.tolist())), median_luminance(lit), 1)
    linear = ((pixels / 255 + 0.055) / 1.055) ** 2.4
    red, green, blue = linear.reshape(-1, 3).std(axis=0)
    assert blue / green == pytest.approx(np.sqrt(light[1] / light[2]), rel=0.03)
    assert red / green == pytest.approx(np.sqrt(light[1] / light[0]), rel=0.03)


def test_sharpening_overshoots_on_both_sides_of_an_edge_by_its_amount():
    edge = np.where(np.arange(64) < 32, 0.5, 2.0)[None, :, None] * np.ones((48, 1, 3))
    edge = edge.astype(np.float32)
    sharpening = PLAIN.model_copy(update={"sharpening": 0.5, "sharpening_radius_px": 2.0})
    plain, sharp = (develop(edge, _response(look), 1.0, 1)[24, :, 1].astype(int) for look in (PLAIN, sharpening))
    low, high = plain[0], plain[-1]
    # A step blurred by a Gaussian is its integral: half a pixel beside the edge it differs by this from the step.
    differs = 0.5 - 0.5 * erf(0.5 / 2.0 / np.sqrt(2))
    assert sharp[32] - high == pytest.approx(0.5 * differs * (high - low), abs=1.5)
    assert low - sharp[31] == pytest.approx(0.5 * differs * (high - low), abs=1.5)
    assert sharp[[0, -1]].tolist() == [low, high]


def test_sharpening_gives_an_edge_no_colour_and_none_changes_nothing():
    rng = np.random.Generator(np.random.PCG64(3))
    light = (GREY * rng.uniform(0.2, 2.0, (48, 64, 1))).astype(np.float32)
    sharp = develop(light, _response(PLAIN.model_copy(update={"sharpening": 2.0})), 3.0, 1)
    assert np.ptp(sharp.astype(int), axis=2).max() <= 1
    wide = PLAIN.model_copy(update={"sharpening": 0.0, "sharpening_radius_px": 5.0})
    assert np.array_equal(develop(light, _response(wide), 3.0, 1), develop(light, _response(), 3.0, 1))


def test_the_blur_of_the_lens_spreads_a_step_as_its_gaussian_does():
    edge = (np.where(np.arange(64) < 32, 0.02, 0.20)[None, :, None] * np.ones((48, 1, 3))).astype(np.float32)
    look = PLAIN.model_copy(update={"exposure_adaption": 0.0, "lens_blur_px": 1.5})
    pixels = develop(edge, _response(look), 0.18, 1)[24, :, 1]
    linear = ((pixels / 255 + 0.055) / 1.055) ** 2.4
    expected = [0.02 + 0.18 * (0.5 + 0.5 * erf((x + 0.5 - 32) / 1.5 / np.sqrt(2))) for x in range(26, 38)]
    assert linear[26:38] == pytest.approx(np.array(expected), abs=0.003)


def test_the_glare_of_the_lens_lifts_the_blacks_by_its_share_of_the_mean():
    light = np.full((40, 60, 3), 0.24, np.float32)
    light[:, :15] = 0.0
    look = PLAIN.model_copy(update={"exposure_adaption": 0.0, "veiling_glare": 0.1})
    pixels = develop(light, _response(look), 0.18, 1)[20, [5, 40], 1]
    linear = ((pixels / 255 + 0.055) / 1.055) ** 2.4
    assert linear == pytest.approx([0.1 * 0.18, 0.9 * 0.24 + 0.1 * 0.18], abs=0.003)


def test_a_single_black_frame_stays_black_and_ends_no_run():
    assert develop(0 * GREY, _response(PLAIN.model_copy(update={"exposure_adaption": 0.5})), 3.0, 1).max() == 0


def test_a_bright_patch_shortens_the_exposure_until_little_of_it_burns():
    light = np.full((60, 80, 3), 0.1, np.float32)
    light[:, 60:] = 20.0
    plain, patched = develop(light[:, :60], _response(), 0.1, 1), develop(light, _response(), 0.1, 1)
    assert patched[:, :60].max() < plain.min()
    assert np.mean(patched >= 250) < 0.05


def test_a_black_image_is_an_error_that_names_the_remedy():
    with pytest.raises(ValueError, match="lamp or a sky"):
        median_luminance(np.zeros((4, 4, 3), np.float32))


def test_the_jpeg_holds_the_image():
    rng = np.random.default_rng(0)
    image = cv2.resize(rng.integers(0, 255, (3, 4, 3), np.uint8), (64, 48), interpolation=cv2.INTER_CUBIC).astype(
        np.uint8
    )
    back = cv2.imdecode(np.frombuffer(encode_jpeg(image, 98), np.uint8), cv2.IMREAD_COLOR)
    assert np.abs(cv2.cvtColor(back, cv2.COLOR_BGR2RGB).astype(int) - image).mean() < 2


def test_the_seed_decides_the_noise():
    look = PLAIN.model_copy(update={"shot_noise": 0.05})
    response = _response(look)
    assert not np.array_equal(develop(GREY, response, 3.0, 1), develop(GREY, replace(response, seed=2), 3.0, 1))


@pytest.mark.parametrize("adaption", [0.0, 0.5, 1.0])
def test_the_warmest_light_has_a_white_balance_too(adaption):
    """A light of 1900 K and less has no blue at all within Rec. 709."""
    look = CameraLook(white_balance_K=1500, white_balance_adaption=adaption)
    gains = CameraResponse.from_look(look, light_rgb(1500), 1, jpeg_quality=92).white_balance
    assert np.all(np.isfinite(gains))
    assert gains[0] < 1 < gains[2] <= 50


def decoded(pixels):
    """Linear light of 8-bit values above 0.0031308, by IEC 61966-2-1."""
    return ((np.asarray(pixels) / 255 + 0.055) / 1.055) ** 2.4


@pytest.mark.parametrize(
    ("linear", "coded"),
    [
        (0.0, 0.0),
        (0.001, 0.01292),
        (0.0031, 0.040052),
        (0.0032, 1.055 * 0.0032 ** (1 / 2.4) - 0.055),
        (0.5, 1.055 * 0.5 ** (1 / 2.4) - 0.055),
        (0.6, 1.055 * 0.6 ** (1 / 2.4) - 0.055),
        # Above 0.6 light approaches 1 with the same slope: 1 - 0.4 exp(-(x - 0.6) / 0.4).
        (0.8, 1.055 * (1 - 0.4 * exp(-0.5)) ** (1 / 2.4) - 0.055),
        (3.0, 1.055 * (1 - 0.4 * exp(-6.0)) ** (1 / 2.4) - 0.055),
    ],
)
def test_the_tone_curve_is_that_of_srgb_with_a_shoulder(linear, coded):
    assert tone(np.array([linear]), 1.0)[0] == pytest.approx(coded, abs=1e-6)


def test_contrast_turns_the_logarithm_of_light_about_middle_grey():
    for linear, power, same_as in ((0.18, 1.5, 0.18), (0.09, 2.0, 0.045), (0.36, 0.5, 0.18 * sqrt(2))):
        assert tone(np.array([linear]), power) == pytest.approx(tone(np.array([same_as]), 1.0), rel=1e-6)


@pytest.mark.parametrize("contrast", [0.8, 1.0, 1.3])
def test_the_light_of_a_tone_is_found_back(contrast):
    light = np.array([0.0, 1e-4, 0.002, 0.0031, 0.004, 0.05, 0.18, 0.55, 0.65, 1.0, 2.0])
    assert inverse_tone(tone(light, contrast).astype(np.float64), contrast) == pytest.approx(light, rel=1e-4, abs=1e-9)


def test_beyond_white_and_black_the_light_of_a_tone_is_a_number():
    low, high = inverse_tone(np.array([-0.1, 1.2]), 1.0)
    assert low == 0.0
    assert 5.0 < high < np.inf


def test_corners_are_where_the_square_of_the_distance_is_1():
    width, height = 640, 480
    assert corner_share(np.array([-0.5, 639.5]), np.array([479.5, -0.5]), width, height) == pytest.approx([1.0, 1.0])
    assert corner_share(np.array([319.5]), np.array([239.5]), width, height)[0] == 0.0
    right, bottom = corner_share(np.array([639.5, 319.5]), np.array([239.5, 479.5]), width, height)
    assert (right, bottom) == pytest.approx((640**2 / (640**2 + 480**2), 480**2 / (640**2 + 480**2)))


def test_compensation_doubles_the_brightness_with_each_step():
    for steps, factor in ((1.0, 2.0), (-2.0, 0.25)):
        assert _response(PLAIN.model_copy(update={"compensation_ev": steps})).brightness == pytest.approx(0.18 * factor)


def test_the_white_balance_goes_from_its_setting_to_the_light_by_ratios():
    light = np.array(light_rgb(3200))
    fixed = np.array(light_rgb(5500))
    for share in (0.0, 0.3, 1.0):
        look = PLAIN.model_copy(update={"white_balance_adaption": share, "white_balance_K": 5500.0})
        expected = (fixed[1] / fixed) ** (1 - share) * (light[1] / light) ** share
        assert _response(look, tuple(7.0 * light)).white_balance == pytest.approx(tuple(expected))
    dark = _response(PLAIN.model_copy(update={"white_balance_K": 5500.0}), (0.0, 0.0, 0.0))
    assert dark.white_balance == pytest.approx(tuple(fixed[1] / fixed))


def test_light_without_blue_has_a_fiftieth_of_it():
    gains = _response(PLAIN, (2.0, 1.0, 0.0)).white_balance
    assert gains == pytest.approx((0.5, 1.0, 1.0 / 0.04))


def test_light_is_metered_by_the_luminance_of_rec_709():
    light = np.tile(np.array([1.0, 2.0, 3.0], np.float32), (3, 4, 1))
    light[0, 0] = 100.0
    assert median_luminance(light) == pytest.approx(0.2126 + 2 * 0.7152 + 3 * 0.0722, rel=1e-3)


def test_the_exposure_is_a_mean_of_ratios_of_the_frame_and_the_run():
    """A frame of 4 times the run's light: with half of the adaption it is twice as bright as middle grey."""
    half = _response(PLAIN.model_copy(update={"exposure_adaption": 0.5}))
    assert decoded(develop(4 * GREY, half, 3.0, 1)) == pytest.approx(0.36, abs=0.003)
    quarter = _response(PLAIN.model_copy(update={"exposure_adaption": 0.25}))
    assert decoded(develop(GREY / 16, quarter, 3.0, 1)) == pytest.approx(0.18 / 8, abs=0.001)


def test_the_exposure_follows_a_frame_down_to_a_thousandth_of_the_run():
    own = _response(PLAIN.model_copy(update={"exposure_adaption": 1.0}))
    for factor, linear in ((2e-3, 0.18), (1e-4, 0.018)):
        assert decoded(develop(factor * GREY, own, 3.0, 1)) == pytest.approx(linear, rel=0.03)


def test_the_exposure_follows_what_the_lens_brings_light_to():
    own = _response(PLAIN.model_copy(update={"exposure_adaption": 1.0}))
    light = np.where(np.arange(64)[None, :, None] < 20, 0.1 * GREY, 0 * GREY)
    field = np.broadcast_to(np.arange(64) < 20, (48, 64))
    assert decoded(develop(light, own, 3.0, 1, field)[:, :20]) == pytest.approx(0.18, abs=0.003)


@pytest.mark.parametrize(("columns", "linear"), [(3, 0.18), (5, 0.1 / 20.0)])
def test_up_to_a_25th_of_the_frame_may_burn(columns, linear):
    light = np.full((50, 100, 3), 0.1, np.float32)
    light[:, :columns] = 20.0
    pixels = develop(light, _response(), 0.1, 1)
    assert decoded(pixels[:, columns:]) == pytest.approx(linear, rel=0.05)


def test_read_noise_is_the_same_in_dark_and_bright_and_variances_add():
    light = np.full((200, 300, 3), 0.5, np.float32)
    light[:, 150:] = 2.0
    for shot, read in ((0.0, 0.03), (0.04, 0.03)):
        look = PLAIN.model_copy(update={"shot_noise": shot, "read_noise": read, "exposure_adaption": 0.0})
        linear = decoded(develop(light, _response(look), 1.0, 1))[..., 1]
        for half, level in ((linear[:, :148], 0.09), (linear[:, 152:], 0.36)):
            assert half.mean() == pytest.approx(level, rel=0.01)
            assert half.std() == pytest.approx(sqrt(shot**2 * level + read**2), rel=0.03)


def test_noise_of_neighbours_is_alike_as_behind_a_colour_filter():
    """A Gaussian of 0.6 pixels, cut to 3: neighbours share 2 a / (1 + 2 a^2) with a = exp(-1 / 0.72) beside 1."""
    look = PLAIN.model_copy(update={"read_noise": 0.02})
    linear = decoded(develop(np.full((240, 320, 3), 1.0, np.float32), _response(look), 1.0, 1))[..., 1]
    noise, a = linear - linear.mean(), exp(-1 / 0.72)
    assert np.mean(noise[:, 1:] * noise[:, :-1]) / noise.var() == pytest.approx(2 * a / (1 + 2 * a * a), abs=0.02)


def test_saturation_stretches_colours_from_their_grey():
    light = np.tile(np.array([0.20, 0.18, 0.12], np.float32), (8, 8, 1))
    grey = 0.2126 * 0.20 + 0.7152 * 0.18 + 0.0722 * 0.12
    for saturation in (0.0, 1.6):
        look = PLAIN.model_copy(update={"saturation": saturation, "exposure_adaption": 0.0})
        expected = 0.18 / grey * (grey + saturation * (np.array([0.20, 0.18, 0.12]) - grey))
        assert decoded(develop(light, _response(look), grey, 1)[4, 4]) == pytest.approx(expected, rel=0.02)
    wild = PLAIN.model_copy(update={"saturation": 6.0, "exposure_adaption": 0.0})
    assert develop(light, _response(wild), grey, 1)[4, 4, 2] == 0


def test_sharpening_sees_colours_by_the_weights_of_jpeg():
    """An edge of one colour alone overshoots by its weight in BT.601, in all three channels."""
    for channel, weight, sharpening in ((0, 0.299, 2.0), (1, 0.587, 1.0), (2, 0.114, 2.0)):
        light = np.full((9, 64, 3), 0.18, np.float32)
        light[:, 32:, channel] = 0.5
        plain, sharp = (
            develop(light, _response(PLAIN.model_copy(update={"exposure_adaption": 0.0, "sharpening": s})), 0.18, 1)
            for s in (0.0, sharpening)
        )
        edge, other = plain[4, :, channel].astype(int), (channel + 1) % 3
        differs = 0.5 - 0.5 * erf(0.5 / sqrt(2))
        rise = sharpening * weight * differs * (edge[-1] - edge[0])
        assert sharp[4, 32, other].astype(int) - plain[4, 32, other] == pytest.approx(rise, abs=1.5)


def test_black_and_white_stay_so_beside_a_sharpened_edge():
    edge = np.where(np.arange(64) < 32, 0.0, 10.0)[None, :, None] * np.ones((9, 1, 3), np.float32)
    look = PLAIN.model_copy(update={"brightness": 5.0, "sharpening": 3.0})
    pixels = develop(edge.astype(np.float32), _response(look), 10.0, 1)[4, :, 1]
    assert pixels[[31, 32]].tolist() == [0, 255]


def test_a_lower_quality_makes_a_smaller_file():
    noise = np.random.default_rng(0).integers(0, 255, (48, 64, 3), np.uint8)
    assert len(encode_jpeg(noise, 30)) < len(encode_jpeg(noise, 60)) < len(encode_jpeg(noise, 95))


def test_blur_and_sharpening_are_the_same_along_rows_and_columns():
    light = np.random.default_rng(2).uniform(0.05, 0.4, (48, 48, 3)).astype(np.float32)
    for changes in ({"lens_blur_px": 1.2}, {"sharpening": 1.0, "sharpening_radius_px": 1.5}):
        response = _response(PLAIN.model_copy(update=changes))
        turned = develop(np.ascontiguousarray(light.transpose(1, 0, 2)), response, 0.2, 1)
        assert np.abs(turned.transpose(1, 0, 2).astype(int) - develop(light, response, 0.2, 1)).max() <= 1


def test_noise_makes_no_pixel_of_the_sensor_darker_than_black():
    """Without its negative half, noise has a mean of sd / sqrt(2 pi), in each channel before they are mixed."""
    look = PLAIN.model_copy(update={"read_noise": 0.05, "saturation": 0.0})
    coded = develop_part(np.zeros((240, 320, 3), np.float32), _response(look), 1.0, 1)[..., 1]
    assert inverse_tone(coded.astype(np.float64) / 255, 1.0).mean() == pytest.approx(0.05 / sqrt(2 * np.pi), rel=0.05)


def test_light_of_the_white_level_has_the_tone_of_white():
    level = white_level(3.0, _response())
    assert develop_part(np.full((3, 3, 3), level, np.float32), _response(), 3.0, None) == pytest.approx(
        255 * tone(np.ones(1), 1.0)[0]
    )


def test_steps_without_effect_are_left_out_of_the_text_and_read_back_as_they_were():
    """As in the files of versions that had no such steps."""
    text = TypeAdapter(CameraResponse)
    steps = {"defocus_px", "pixel_px", "colour_filter", "noise_reduction", "colour_blur_px"}
    steps |= {"shading_right_ev", "shading_down_ev"}
    assert not steps & text.dump_python(_response(), mode="json").keys()
    assert text.validate_json(text.dump_json(_response())) == _response()
    with_all = replace(
        _response(), defocus_px=1.5, pixel_px=1.2, colour_filter="bayer", noise_reduction=0.3, colour_blur_px=2.0,
        shading_right_ev=0.1, shading_down_ev=-0.1,
    )  # fmt: skip
    assert text.validate_json(text.dump_json(with_all)) == with_all


def test_a_response_cannot_be_changed(changeable):
    assert changeable(CameraResponse) == []
