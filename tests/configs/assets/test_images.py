"""What is made of PNG and JPEG files, whole and broken."""

import struct
import subprocess
import sys
import zlib

import cv2
import numpy as np
import pytest

from configs.assets.images import MAX_SIDE_PX, mean_of, read_image


def _png(pixels: np.ndarray) -> bytes:
    return cv2.imencode(".png", pixels)[1].tobytes()


def _jpeg(pixels: np.ndarray) -> bytes:
    return cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, 100])[1].tobytes()


QUARTERS = np.zeros((16, 32, 3), np.uint8)
"""Blue first: red, green; blue, white."""
QUARTERS[:8, :16], QUARTERS[:8, 16:], QUARTERS[8:, :16], QUARTERS[8:, 16:] = (0, 0, 255), (0, 255, 0), (255, 0, 0), 255


def test_a_png_is_what_it_was_red_first():
    decoded = read_image(_png(QUARTERS))
    assert decoded.dtype == np.uint8
    np.testing.assert_array_equal(decoded, QUARTERS[..., ::-1])


def test_a_jpeg_is_nearly_what_it_was():
    decoded = read_image(_jpeg(QUARTERS)).astype(int)
    assert np.median(np.abs(decoded - QUARTERS[..., ::-1])) <= 2


@pytest.mark.parametrize(
    "pixels",
    [
        np.full((2, 3), 128, np.uint8),
        np.full((2, 3, 4), (128, 128, 128, 7), np.uint8),
        np.full((2, 3, 3), 128 * 257, np.uint16),
    ],
    ids=["grey", "with opacity", "16 bits"],
)
def test_other_kinds_of_png_count_as_colours_of_8_bits(pixels):
    np.testing.assert_array_equal(read_image(_png(pixels)), np.full((2, 3, 3), 128))


def test_the_orientation_of_a_camera_held_upright_is_undone():
    """EXIF tag 0x0112, value 6: the first row is the right hand side (CIPA DC-008)."""
    exif = b"Exif\0\0MM\0*\0\0\0\x08\0\x01" + struct.pack(">HHIHH", 0x0112, 3, 1, 6, 0) + b"\0\0\0\0"
    plain = _jpeg(QUARTERS)
    turned = plain[:2] + b"\xff\xe1" + struct.pack(">H", len(exif) + 2) + exif + plain[2:]
    decoded = read_image(turned)
    assert decoded.shape == (32, 16, 3)
    corners = [decoded[y, x] > 128 for y, x in ((2, 2), (2, 13), (29, 2), (29, 13))]
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
            read_image(whole[:length])


@pytest.mark.parametrize("whole", [_png(QUARTERS), _jpeg(QUARTERS)], ids=["PNG", "JPEG"])
def test_a_file_with_any_byte_damaged_is_read_or_refused(whole, capfd):
    refusals = []
    for place in range(0, len(whole), 3):
        damaged = whole[:place] + bytes([whole[place] ^ 0xFF]) + whole[place + 1 :]
        try:
            assert read_image(damaged).shape[2] == 3
        except ValueError as error:
            refusals.append(str(error))
    assert len(refusals) > 5
    assert all(len(text.splitlines()) == 1 for text in refusals)
    assert capfd.readouterr().err == ""


def _chunk(kind: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


@pytest.mark.parametrize(("size", "expected"), [((100_000, 100_000), "at most 64 million"), ((0, 5), "no pixel")])
def test_a_size_that_cannot_be_is_refused_before_it_is_made(size, expected):
    head = _chunk(b"IHDR", struct.pack(">IIBBBBB", *size, 8, 2, 0, 0, 0))
    body = _chunk(b"IDAT", zlib.compress(b"\0" * 1000))
    with pytest.raises(ValueError, match=expected):
        read_image(b"\x89PNG\r\n\x1a\n" + head + body + _chunk(b"IEND", b""))


def test_a_large_image_is_averaged_down():
    pixels = np.zeros((2, 2 * MAX_SIDE_PX, 3), np.uint8)
    pixels[:, ::2] = 200
    decoded = read_image(_png(pixels))
    assert decoded.shape == (1, MAX_SIDE_PX, 3)
    assert (decoded == 100).all()


@pytest.mark.parametrize("data", [b"", b"GIF89a", b"\xff\xd8", b"<svg/>"])
def test_other_files_are_refused_by_their_content(data):
    with pytest.raises(ValueError, match="neither a PNG nor a JPEG"):
        read_image(data)


def _jpeg_parts() -> tuple[bytes, bytes, bytes, bytes]:
    """Up to the frame's header, that, what follows, and the marker of the end."""
    whole = _jpeg(QUARTERS)
    at = whole.index(b"\xff\xc0")
    end = at + 2 + int.from_bytes(whole[at + 2 : at + 4], "big")
    return whole[:at], whole[at:end], whole[end:-2], whole[-2:]


def test_a_comment_behind_the_pixels_does_no_harm():
    """Segments may stand before any marker that is not of a scan's own data (ITU-T T.81, B.1.1.2 and B.2.4.5)."""
    *parts, end = _jpeg_parts()
    commented = b"".join(parts) + b"\xff\xfe\x00\x04hi" + end
    np.testing.assert_array_equal(read_image(commented), read_image(_jpeg(QUARTERS)))


def test_a_second_frame_does_not_hide_the_size_of_the_first():
    before, frame, rest, end = _jpeg_parts()
    large = frame[:5] + struct.pack(">HH", 60_000, 60_000) + frame[9:]
    with pytest.raises(ValueError, match="the JPEG has two frames"):
        read_image(before + large + rest + frame + end)
    with pytest.raises(ValueError, match="at most 64 million"):
        read_image(before + large + rest + end)
    with pytest.raises(ValueError, match="the JPEG has no frame"):
        read_image(before + end)


def test_a_png_has_one_header_at_its_beginning():
    """PNG specification, 5.6."""
    whole = _png(QUARTERS)
    head, rest = whole[8:33], whole[33:]
    small = _chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0))
    text = _chunk(b"tEXt", b"Title\0none")
    assert read_image(whole[:8] + head + text + rest).shape == (16, 32, 3)
    for chunks in (head + rest[:-12] + small + rest[-12:], text + head + rest, head + head + rest):
        with pytest.raises(ValueError, match="header is not first, or not alone"):
            read_image(whole[:8] + chunks)


def test_a_jpeg_without_half_of_its_pixels_is_refused_and_nothing_else_is_said(capfd):
    """libjpeg makes up what is missing, with a line of its own about corrupt data."""
    noise = _jpeg(np.random.default_rng(1).integers(0, 256, (40, 60, 3)).astype(np.uint8))
    with pytest.raises(ValueError, match="cannot be decoded"):
        read_image(noise[: len(noise) // 2] + b"\xff\xd9")
    assert capfd.readouterr().err == ""


def test_what_libpng_says_of_a_broken_stream_stays_unsaid(capfd):
    head = _chunk(b"IHDR", struct.pack(">IIBBBBB", 30, 20, 8, 0, 0, 0, 0))
    body = zlib.compress(np.random.default_rng(1).bytes(20 * 31))[:300]
    with pytest.raises(ValueError, match="cannot be decoded"):
        read_image(b"\x89PNG\r\n\x1a\n" + head + _chunk(b"IDAT", body) + _chunk(b"IEND", b""))
    assert capfd.readouterr().err == ""


def test_a_process_without_a_standard_error_stream_reads_images(tmp_path):
    (tmp_path / "a.png").write_bytes(_png(QUARTERS))
    program = "import os, sys; os.close(2); from pathlib import Path; from configs.assets.images import read_image;"
    program += "print(read_image(Path(sys.argv[1]).read_bytes()).shape)"
    done = subprocess.run([sys.executable, "-c", program, tmp_path / "a.png"], stdout=subprocess.PIPE, check=True)
    assert done.stdout == b"(16, 32, 3)\n"
