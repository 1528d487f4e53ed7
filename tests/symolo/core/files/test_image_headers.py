"""An image that would take long to decode is refused by its header."""

import time
import zlib

import cv2
import numpy as np
import pytest

from symolo.core.files.image_headers import image_size
from symolo.dataset.pixels import MAX_PIXELS, decoded_bytes

SECONDS = 2.0
"""Of the processor, for one image."""


def grey(width, height):
    return np.full((height, width, 3), 128, np.uint8)


def encoded(kind, image, *settings):
    return cv2.imencode(kind, image, settings)[1].tobytes()


def with_scans(times, width=1000, height=1000):
    """A progressive JPEG whose last scan is there so many times."""
    data = encoded(".jpg", grey(width, height), cv2.IMWRITE_JPEG_PROGRESSIVE, 1)
    last = data.rfind(b"\xff\xda")
    return data[:last] + times * data[last:-2] + data[-2:]


def chunk(kind, body):
    return len(body).to_bytes(4, "big") + kind + body + zlib.crc32(kind + body).to_bytes(4, "big")


def png_of(width, height, depth=1, colour_type=0, *, extra=b""):
    """A PNG of zeros, one bit for a pixel where nothing else is said, whose header tells the truth."""
    header = width.to_bytes(4, "big") + height.to_bytes(4, "big") + bytes([depth, colour_type, 0, 0, 0])
    rows = zlib.compress(bytes(height * (1 + -(-width // 8))), 1)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + extra + chunk(b"IDAT", rows) + chunk(b"IEND", b"")


@pytest.mark.parametrize("kind", [".jpg", ".png"])
def test_the_size_is_that_of_the_decoder(kind):
    data = encoded(kind, grey(31, 17))
    assert image_size(data, MAX_PIXELS) == (31, 17)
    np.testing.assert_array_equal(decoded_bytes(data), cv2.imdecode(np.frombuffer(data, np.uint8), -1))


@pytest.mark.parametrize("settings", [(cv2.IMWRITE_JPEG_PROGRESSIVE, 1), (cv2.IMWRITE_JPEG_RST_INTERVAL, 1)])
def test_images_of_common_encoders_are_read(settings):
    noise = np.random.default_rng(1).integers(0, 256, (480, 640, 3), np.uint8)
    assert decoded_bytes(encoded(".jpg", noise, *settings)).shape == noise.shape


@pytest.mark.parametrize("times", [200, 1000, 40_000])
def test_a_jpeg_of_many_scans_is_refused_at_once(times):
    data = with_scans(times)
    begin = time.process_time()
    assert decoded_bytes(data) is None
    assert time.process_time() - begin < SECONDS
    with pytest.raises(ValueError, match=r"is a JPEG of 1000 x 1000 pixels in \d+ scans, which takes too long"):
        image_size(data, MAX_PIXELS)


def test_what_is_accepted_is_decoded_within_seconds():
    """The most scans of an image of usual size, and the largest image."""
    for data in (with_scans(80, 640, 480), encoded(".jpg", grey(8000, 4000)), png_of(8000, 4000)):
        begin = time.process_time()
        assert decoded_bytes(data) is not None
        assert time.process_time() - begin < SECONDS


@pytest.mark.parametrize("side", [8200, 60_000, 2**31 - 1])
def test_an_image_of_too_many_pixels_is_refused_before_it_is_unpacked(side):
    data = bytearray(png_of(8, 8))
    data[16:24] = side.to_bytes(4, "big") * 2
    data[29:33] = zlib.crc32(data[12:29]).to_bytes(4, "big")
    with pytest.raises(ValueError, match=f"has {side} x {side} pixels; at most 67 million can be read"):
        image_size(bytes(data), MAX_PIXELS)
    assert decoded_bytes(bytes(data)) is None


def with_header(data, width, height, frame=None):
    """A JPEG whose frame states another size, or is of another kind."""
    changed = bytearray(data)
    at = next(i for i in range(len(data)) if data[i] == 0xFF and data[i + 1] in {0xC0, 0xC2})
    changed[at + 1] = frame or data[at + 1]
    changed[at + 5 : at + 9] = height.to_bytes(2, "big") + width.to_bytes(2, "big")
    return bytes(changed)


PROGRESSIVE = with_scans(1, 64, 64)
ONE_SCAN = PROGRESSIVE[: PROGRESSIVE.find(b"\xff", PROGRESSIVE.find(b"\xff\xda") + 2)] + b"\xff\xd9"


@pytest.mark.parametrize(
    ("data", "problem"),
    [
        (png_of(8192, 8192, 16, 6), "take 1073 MB to decode"),
        (png_of(8192, 8192, 16, 4), "take 1073 MB to decode"),
        (png_of(8192, 8192, 16, 2), "take 805 MB to decode"),
        (png_of(8192, 8192, 8, 3), "take 536 MB to decode"),
        (png_of(8192, 8192, 8, 2, extra=chunk(b"tRNS", bytes(6))), "take 536 MB to decode"),
        (png_of(64, 64, extra=chunk(b"acTL", bytes(8))), "is an animation"),
        (with_header(PROGRESSIVE, 8192, 8192), "in 10 scans, which takes too long to decode"),
        (with_header(ONE_SCAN, 8192, 8192), "take 603 MB to decode"),
        (with_header(encoded(".jpg", grey(64, 64)), 64, 64, 0xC9), "is a JPEG of a rare kind"),
    ],
)
def test_an_image_that_takes_much_memory_or_time_is_refused(data, problem):
    with pytest.raises(ValueError, match=problem):
        image_size(data, MAX_PIXELS)
    assert decoded_bytes(data) is None


@pytest.mark.parametrize(
    "data",
    [
        png_of(8192, 8192, 8, 2),
        png_of(8192, 8192, 16, 0),
        png_of(7680, 4320, 16, 2),
        with_header(encoded(".jpg", grey(64, 64)), 8192, 8192),
        with_header(PROGRESSIVE, 7000, 5000),
    ],
)
def test_what_a_release_or_a_camera_has_is_not_refused(data):
    image_size(data, MAX_PIXELS)


@pytest.mark.parametrize(
    "data",
    [
        b"\xff\xd8" + b"\xff\xe1\0\2" * (16 << 20),
        b"\xff\xd8" + b"\xff" * (64 << 20),
        png_of(8, 8)[:33] + chunk(b"tEXt", b"") * (5 << 20),
    ],
    ids=["markers", "filling", "chunks"],
)
def test_many_empty_parts_take_no_time(data):
    begin = time.process_time()
    with pytest.raises(ValueError, match="more than 100000"):
        image_size(data, MAX_PIXELS)
    assert time.process_time() - begin < SECONDS


@pytest.mark.parametrize(
    "data", [b"", b"\xff\xd8\xff", b"\x89PNG\r\n\x1a\n", b"GIF89a", b"II*\0", b"\xff" * 100, b"BM" + bytes(60)]
)
def test_what_is_no_png_or_jpeg_reaches_no_decoder(data):
    assert decoded_bytes(data) is None


def test_long_data_without_a_marker_take_no_time():
    begin = time.process_time()
    assert decoded_bytes(with_scans(1)[:-2] + b"\xff\0" * (16 << 20)) is None
    assert time.process_time() - begin < SECONDS
