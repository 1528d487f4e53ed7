"""What is made of panoramas of the whole sphere, whole and broken."""

import struct

import cv2
import numpy as np
import pytest

from configs.assets.panoramas import mean_above, read_panorama


def _hdr(light: np.ndarray) -> bytes:
    """Radiance, from (H, W, 3) red first; values that are powers of two come back as they were."""
    return cv2.imencode(".hdr", np.ascontiguousarray(light[..., ::-1], np.float32))[1].tobytes()


def _exr(light: np.ndarray, names: str = "BGR") -> bytes:
    """Uncompressed, as https://openexr.com/en/latest/OpenEXRFileLayout.html describes it."""
    height, width, _ = light.shape
    channels = b"".join(name.encode() + struct.pack("<xiB3xii", 2, 0, 1, 1) for name in names) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    attributes = [("channels", channels), ("compression", b"\0"), ("dataWindow", window)]
    head = struct.pack("<ii", 20000630, 2)
    for name, data in attributes:
        head += name.encode() + b"\0x\0" + struct.pack("<i", len(data)) + data
    lines = [np.ascontiguousarray(row.T[::-1], "<f4").tobytes() for row in light]
    body = b"".join(struct.pack("<ii", y, len(line)) + line for y, line in enumerate(lines))
    return head + b"\0" + b"\0" * 8 * height + body


SPHERE = np.ones((8, 16, 3), np.float32)
SPHERE[:4] = (0.25, 0.5, 2.0)
SPHERE[0, 3] = 4.0


@pytest.mark.parametrize("make", [_hdr, _exr])
def test_both_kinds_come_back_red_first_and_zenith_first(make):
    decoded = read_panorama(make(SPHERE))
    assert decoded.dtype == np.float32
    np.testing.assert_allclose(decoded, SPHERE, rtol=0.01)


def test_the_mean_is_by_solid_angle_above_the_horizon():
    """A band from 30 to 90 degrees has the solid angle of 1 - sin 30 deg, half of the hemisphere's."""
    light = np.zeros((180, 360, 3))
    light[:60], light[60:90], light[90:] = 0.2, 0.6, 9.0
    assert mean_above(light.astype(np.float32)) == pytest.approx((0.4, 0.4, 0.4), rel=1e-4)


def test_a_sun_is_no_part_of_the_sky():
    """It counts as twenty times the median, here one pixel of a row of 360 among 90."""
    light = np.full((180, 360, 3), 0.5, np.float32)
    light[45, 7] = 40_000.0
    assert mean_above(light) == pytest.approx((0.5, 0.5, 0.5), rel=0.002)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e30])
def test_components_that_are_no_light_are_refused(value):
    light = SPHERE.copy()
    light[2, 5, 1] = value
    with pytest.raises(ValueError, match="1 components that are not numbers"):
        read_panorama(_exr(light))


def test_what_is_below_zero_counts_as_zero():
    """As the conversion of colours outside Rec. 709 leaves it."""
    light = SPHERE.copy()
    light[2, 5, 1] = -0.01
    assert read_panorama(_exr(light)).min() == 0


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (_hdr(SPHERE[:, :8]), "8 x 8 pixels; a panorama of the whole sphere is twice as wide as high"),
        (_hdr(np.zeros((8, 16, 3))), "black above the horizon"),
        (_hdr(SPHERE).replace(b"-Y 8 +X 16", b"-Y 90000 +X 180000"), "180000 x 90000 pixels; at most 8192 x 4096"),
        (_hdr(SPHERE).replace(b"-Y 8", b"+Y 8"), "rows from top to bottom"),
        (_hdr(SPHERE).replace(b"rgbe", b"xyze"), "in RGB"),
        (_hdr(SPHERE).replace(b"-Y 8 +X 16", b"-Y  90000 +X 180000\n\n-Y 8 +X 16"), "rows from top to bottom"),
        (_exr(SPHERE, "UVY"), "channels U, V, Y; expected R, G, B"),
        (b"\x89PNG\r\n\x1a\n", "neither a Radiance"),
        (b"", "neither a Radiance"),
    ],
)
def test_what_is_no_panorama_is_refused(data, message):
    with pytest.raises(ValueError, match=message.replace("+", r"\+")):
        read_panorama(data)


@pytest.mark.parametrize("whole", [_hdr(SPHERE), _exr(SPHERE)], ids=["Radiance", "OpenEXR"])
def test_a_file_cut_anywhere_is_refused(whole, capfd):
    for length in range(0, len(whole), 5):
        with pytest.raises(ValueError, match=r"cut short|truncated|neither|not a Radiance"):
            read_panorama(whole[:length])
    assert capfd.readouterr().err == ""


def test_other_lines_in_a_header_change_nothing():
    whole = _hdr(SPHERE)
    plain = b"FORMAT=32-bit_rle_rgbe\n"
    assert plain in whole
    with_comments = whole.replace(plain, b"# by a camera\n" + plain + b"EXPOSURE=1.0\nGAMMA=1.0\n")
    np.testing.assert_array_equal(read_panorama(with_comments), read_panorama(whole))


def test_a_wide_panorama_is_averaged_down(monkeypatch):
    monkeypatch.setattr("configs.assets.panoramas.MAX_WIDTH_PX", 8)
    light = np.ones((8, 16, 3), np.float32)
    light[:, ::2] = 0.5
    decoded = read_panorama(_hdr(light))
    assert decoded.shape == (4, 8, 3)
    np.testing.assert_allclose(decoded, 0.75, rtol=0.01)
