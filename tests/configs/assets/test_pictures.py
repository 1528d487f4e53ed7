"""What is made of PNG and JPEG files, whole and broken."""

import struct
import zlib

import cv2
import numpy as np
import pytest

from configs.assets.pictures import LONGEST_SIDE_PX, mean_of, read_picture


def _png(pixels: np.ndarray) -> bytes:
    return cv2.imencode(".png", pixels)[1].tobytes()


def _jpeg(pixels: np.ndarray) -> bytes:
    return cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, 100])[1].tobytes()


QUARTERS = np.zeros((16, 32, 3), np.uint8)
"""Blue first: red, green; blue, white."""
QUARTERS[:8, :16], QUARTERS[:8, 16:], QUARTERS[8:, :16], QUARTERS[8:, 16:] = (0, 0, 255), (0, 255, 0), (255, 0, 0), 255


def test_a_png_is_what_it_was_red_first():
    found = read_picture(_png(QUARTERS))
    assert found.dtype == np.uint8
    np.testing.assert_array_equal(found, QUARTERS[..., ::-1])


def test_a_jpeg_is_nearly_what_it_was():
    found = read_picture(_jpeg(QUARTERS)).astype(int)
    assert np.median(np.abs(found - QUARTERS[..., ::-1])) <= 2


@pytest.mark.parametrize(
    "pixels",
    [
        np.full((2, 3), 128, np.uint8),
        np.full((2, 3, 4), (128, 128, 128, 7), np.uint8),
        np.full((2, 3, 3), 128 * 257, np.uint16),
    ],
    ids=["grey", "with opacity", "16 bits"],
)
def test_other_kinds_of_png_are_told_as_colours_of_8_bits(pixels):
    np.testing.assert_array_equal(read_picture(_png(pixels)), np.full((2, 3, 3), 128))


def test_the_orientation_of_a_camera_held_upright_is_undone():
    """EXIF tag 0x0112, value 6: the first row is the right hand side (CIPA DC-008)."""
    exif = b"Exif\0\0MM\0*\0\0\0\x08\0\x01" + struct.pack(">HHIHH", 0x0112, 3, 1, 6, 0) + b"\0\0\0\0"
    plain = _jpeg(QUARTERS)
    turned = plain[:2] + b"\xff\xe1" + struct.pack(">H", len(exif) + 2) + exif + plain[2:]
    found = read_picture(turned)
    assert found.shape == (32, 16, 3)
    corners = [found[y, x] > 128 for y, x in ((2, 2), (2, 13), (29, 2), (29, 13))]
    blue, red, white, green = ([0, 0, 1], [1, 0, 0], [1, 1, 1], [0, 1, 0])
    assert [corner.astype(int).tolist() for corner in corners] == [blue, red, white, green]


def test_the_mean_is_of_light_not_of_numbers():
    """188 of 255 in sRGB is half of white's light; (188/255 + 0.055)/1.055 to the 2.4 is 0.5029 (IEC 61966-2-1)."""
    black_and_white = np.zeros((4, 4, 3), np.uint8)
    black_and_white[::2] = 255
    assert mean_of(black_and_white) == pytest.approx((0.5, 0.5, 0.5))
    assert mean_of(np.full((4, 4, 3), (188, 0, 255), np.uint8)) == pytest.approx((0.5029, 0.0, 1.0), abs=1e-4)


@pytest.mark.parametrize("whole", [_png(QUARTERS), _jpeg(QUARTERS)], ids=["PNG", "JPEG"])
def test_a_file_cut_anywhere_is_refused(whole):
    for length in range(len(whole)):
        with pytest.raises(ValueError, match=r"cut short|neither|damaged"):
            read_picture(whole[:length])


@pytest.mark.parametrize("whole", [_png(QUARTERS), _jpeg(QUARTERS)], ids=["PNG", "JPEG"])
def test_a_file_with_any_byte_damaged_is_read_or_refused(whole, capfd):
    refusals = []
    for place in range(0, len(whole), 3):
        damaged = whole[:place] + bytes([whole[place] ^ 0xFF]) + whole[place + 1 :]
        try:
            assert read_picture(damaged).shape[2] == 3
        except ValueError as error:
            refusals.append(str(error))
    assert len(refusals) > 5
    assert all(len(text.splitlines()) == 1 for text in refusals)
    assert "imdecode" not in capfd.readouterr().err


def _chunk(kind: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


@pytest.mark.parametrize(("size", "told"), [((100_000, 100_000), "at most 64 million"), ((0, 5), "no pixel")])
def test_a_size_that_cannot_be_is_refused_before_it_is_made(size, told):
    head = _chunk(b"IHDR", struct.pack(">IIBBBBB", *size, 8, 2, 0, 0, 0))
    body = _chunk(b"IDAT", zlib.compress(b"\0" * 1000))
    with pytest.raises(ValueError, match=told):
        read_picture(b"\x89PNG\r\n\x1a\n" + head + body + _chunk(b"IEND", b""))


def test_a_large_picture_is_averaged_down():
    pixels = np.zeros((2, 2 * LONGEST_SIDE_PX, 3), np.uint8)
    pixels[:, ::2] = 200
    found = read_picture(_png(pixels))
    assert found.shape == (1, LONGEST_SIDE_PX, 3)
    assert (found == 100).all()


@pytest.mark.parametrize("data", [b"", b"GIF89a", b"\xff\xd8", b"<svg/>"])
def test_other_files_are_refused_by_their_content(data):
    with pytest.raises(ValueError, match="neither a PNG nor a JPEG"):
        read_picture(data)
