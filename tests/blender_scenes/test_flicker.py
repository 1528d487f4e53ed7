import numpy as np
import pytest

from blender_scenes.lighting.flicker import caught, frame_gains, mains_phase_rad
from blender_scenes.render.job import FramePose, build_job
from configs.schema.appearance.lighting import FlickerLook, LampsLook, SkyLook
from configs.schema.appearance.look import LookConfig
from configs.schema.scenario import Render

TIMES = 0.2 * np.arange(1, 30)
WHITE = (0.4, 0.5, 0.6)


@pytest.mark.parametrize("exposure_s", [0.0003, 0.004, 0.0173])
def test_a_frame_catches_the_mean_of_the_light_over_its_exposure(exposure_s):
    """The modulation at twice the mains frequency, integrated by the midpoint rule."""
    flicker = FlickerLook(depth=0.4, mains_hz=49.93)
    fine = TIMES[:, None] + exposure_s * ((np.arange(4000) + 0.5) / 4000 - 0.5)
    light = 1 + 0.4 * np.cos(2 * np.pi * 2 * 49.93 * fine + 0.7)
    np.testing.assert_allclose(caught(flicker, TIMES, exposure_s, 0.7), light.mean(axis=1), atol=1e-6)


def test_an_exposure_of_whole_half_periods_sees_no_flicker():
    flicker = FlickerLook(depth=1.0, mains_hz=50.0)
    np.testing.assert_allclose(caught(flicker, TIMES, 0.03, 1.0), 1.0, atol=1e-12)


def test_a_camera_of_5_hz_sees_one_phase_of_50_hz_and_a_slow_beat_of_a_grid_beside_it():
    still = caught(FlickerLook(depth=0.5, mains_hz=50.0), TIMES, 0.0, 1.0)
    np.testing.assert_allclose(still, 1 + 0.5 * np.cos(1.0), atol=1e-9)
    beat = caught(FlickerLook(depth=0.5, mains_hz=50.1), TIMES, 0.0, 1.0)
    np.testing.assert_allclose(beat, 1 + 0.5 * np.cos(2 * np.pi * 0.2 * TIMES + 1.0), atol=1e-9)


def test_each_channel_varies_by_the_lamps_share_of_its_light():
    flicker = FlickerLook(depth=0.5, mains_hz=50.1)
    alone = np.array(frame_gains(flicker, TIMES, 0.001, WHITE, WHITE, 3))
    mixed = np.array(frame_gains(flicker, TIMES, 0.001, (0.1, 0.25, 0.6), WHITE, 3))
    assert np.ptp(alone[:, 0]) > 0.8
    np.testing.assert_allclose(mixed - 1, (alone - 1) * [0.25, 0.5, 1.0])


def test_without_depth_or_lamps_every_gain_is_exactly_one():
    one = [(1.0, 1.0, 1.0)] * len(TIMES)
    assert frame_gains(FlickerLook(), TIMES, 0.001, WHITE, WHITE, 3) == one
    assert frame_gains(FlickerLook(depth=0.5), TIMES, 0.001, (0.0, 0.0, 0.0), WHITE, 3) == one
    assert frame_gains(FlickerLook(depth=0.5), TIMES, 0.001, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 3) == one


def test_the_phase_belongs_to_the_seed():
    flicker = FlickerLook(depth=0.5)
    assert frame_gains(flicker, TIMES, 0.001, WHITE, WHITE, 3) == frame_gains(flicker, TIMES, 0.001, WHITE, WHITE, 3)
    assert frame_gains(flicker, TIMES, 0.001, WHITE, WHITE, 3) != frame_gains(flicker, TIMES, 0.001, WHITE, WHITE, 4)


def _gains(arena, robot, lamps, sky):
    frames = [FramePose(i, 0.2 * i, 0.0, 0.0, 0.0) for i in range(1, 20)]
    job = build_job(arena, robot, LookConfig(name="f", lamps=lamps, sky=sky), Render(), frames, 5)
    return np.array([view.light_gain for view in job.frames]), job.to_json()


def test_frames_under_lamps_alone_flicker_in_full_and_daylight_steadies_them(arena, robot):
    lamps = LampsLook(flicker=FlickerLook(depth=0.4, mains_hz=50.1))
    alone, text = _gains(arena, robot, lamps, SkyLook(luminance_kcd_m2=0))
    mixed, _ = _gains(arena, robot, lamps, SkyLook(luminance_kcd_m2=3))
    _, steady = _gains(arena, robot, LampsLook(), SkyLook(luminance_kcd_m2=0))
    assert np.ptp(alone) == pytest.approx(0.8, rel=0.05)
    assert 0.05 < np.ptp(mixed[:, 1]) < 0.95 * np.ptp(alone)
    assert "light_gain" in text
    assert "light_gain" not in steady


def test_the_recorded_phase_is_that_of_the_light():
    """Of lamps alone, which the record's formula gives: 1 + depth cos(4 pi mains_hz t + phase)."""
    gains = frame_gains(FlickerLook(depth=0.4, mains_hz=50.3), TIMES, 0.0, WHITE, WHITE, 7)
    expected = 1 + 0.4 * np.cos(4 * np.pi * 50.3 * TIMES + mains_phase_rad(7))
    np.testing.assert_allclose(np.array(gains), np.repeat(expected[:, None], 3, axis=1), atol=1e-9)
