import os
import struct
import subprocess
import sys
import tracemalloc
import zlib

import numpy as np
import pytest

from symolo.core.files.exr import read_exr


def _exr(channels: dict[str, np.ndarray], compression: int = 0) -> bytes:
    """A file written from the format's description: https://openexr.com/en/latest/OpenEXRFileLayout.html."""
    height, width = next(iter(channels.values())).shape
    kinds = {"<u4": 0, "<f2": 1, "<f4": 2}
    names = sorted(channels)
    listed = b"".join(n.encode() + struct.pack("<xiB3xii", kinds[channels[n].dtype.str], 0, 1, 1) for n in names)
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    attributes = [("channels", "chlist", listed + b"\0"), ("compression", "compression", bytes([compression]))]
    attributes += [
        ("dataWindow", "box2i", window),
        ("displayWindow", "box2i", window),
        ("lineOrder", "lineOrder", b"\0"),
    ]
    head = struct.pack("<ii", 20000630, 2)
    for name, kind, data in attributes:
        head += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data
    head += b"\0"
    lines = [b"".join(channels[n][y].tobytes() for n in names) for y in range(height)]
    offsets, at = b"", len(head) + 8 * height
    for line in lines:
        offsets += struct.pack("<Q", at)
        at += 8 + len(line)
    return head + offsets + b"".join(struct.pack("<ii", y, len(line)) + line for y, line in enumerate(lines))


@pytest.fixture
def channels() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(0)
    return {
        "R": rng.random((5, 7), np.float32),
        "G": rng.random((5, 7)).astype(np.float16),
        "B": rng.integers(0, 2**32, (5, 7), np.uint32),
    }


def test_every_kind_of_channel_comes_back_as_it_was(channels):
    decoded = read_exr(_exr(channels))
    assert set(decoded) == set(channels)
    for name, values in channels.items():
        np.testing.assert_array_equal(decoded[name], values)


def test_a_file_cut_anywhere_is_refused(channels):
    whole = _exr(channels)
    for length in range(len(whole)):
        with pytest.raises(ValueError, match="OpenEXR"):
            read_exr(whole[:length])


def test_a_compression_other_than_zip_is_refused(channels):
    with pytest.raises(ValueError, match="compressed otherwise than by ZIP"):
        read_exr(_exr(channels, compression=4))


def test_a_tiled_file_is_refused(channels):
    whole = bytearray(_exr(channels))
    whole[5] |= 0x02
    with pytest.raises(ValueError, match="tiled"):
        read_exr(bytes(whole))


def test_lines_out_of_order_are_refused(channels):
    whole = bytearray(_exr(channels))
    last = len(whole) - (8 + 7 * 10)
    whole[last : last + 4] = struct.pack("<i", 0)
    with pytest.raises(ValueError, match="out of order"):
        read_exr(bytes(whole))


@pytest.fixture(scope="module")
def by_opencv(tmp_path_factory) -> dict[str, bytes]:
    """The same 35 x 20 pixels by kind of compression, from OpenCV, which must be told early that it may write them."""
    folder = tmp_path_factory.mktemp("exr")
    program = f"""
import cv2, numpy as np
values = np.arange(35 * 20 * 3, dtype=np.float32).reshape(20, 35, 3) / 7
for kind in ("NO", "ZIPS", "ZIP", "PIZ"):
    options = [cv2.IMWRITE_EXR_COMPRESSION, getattr(cv2, f"IMWRITE_EXR_COMPRESSION_{{kind}}")]
    cv2.imwrite(f"{folder}/{{kind}}.exr", values, options)
"""
    environment = {**os.environ, "OPENCV_IO_ENABLE_OPENEXR": "1"}
    subprocess.run([sys.executable, "-c", program], check=True, env=environment, capture_output=True)
    return {path.stem: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.parametrize("kind", ["NO", "ZIPS", "ZIP"])
def test_files_of_another_program_come_back(by_opencv, kind):
    expected = np.arange(35 * 20 * 3, dtype=np.float32).reshape(20, 35, 3) / 7
    decoded = read_exr(by_opencv[kind])
    np.testing.assert_array_equal(np.stack([decoded[name] for name in "BGR"], axis=-1), expected)


def test_a_compressed_file_cut_anywhere_is_refused(by_opencv):
    whole = by_opencv["ZIP"]
    for length in range(0, len(whole), 7):
        with pytest.raises(ValueError, match="OpenEXR"):
            read_exr(whole[:length])


def test_a_compressed_file_with_any_byte_damaged_is_read_or_refused(by_opencv):
    whole, refusals = by_opencv["ZIP"], []
    for place in range(8, len(whole), 11):
        for value in (0x00, 0x7F, 0xFF):
            damaged = whole[:place] + bytes([value]) + whole[place + 1 :]
            try:
                read_exr(damaged, _at_max_a_thousand)
            except ValueError as error:
                refusals.append(str(error))
    assert len(refusals) > 10
    assert all(len(text.splitlines()) == 1 for text in refusals)


def _at_max_a_thousand(width: int, height: int) -> None:
    if width * height > 1000:
        raise ValueError("too large")


def test_a_size_is_reported_before_memory_is_taken(by_opencv):
    sizes = []
    read_exr(by_opencv["ZIP"], lambda width, height: sizes.append((width, height)))
    assert sizes == [(35, 20)]


def test_a_size_that_is_refused_is_not_read(by_opencv):
    huge = by_opencv["ZIP"].replace(struct.pack("<4i", 0, 0, 34, 19), struct.pack("<4i", 0, 0, 10**9, 10**9))
    with pytest.raises(ValueError, match="too large"):
        read_exr(huge, _at_max_a_thousand)


def _zipped(size: tuple[int, int], names: list[bytes]) -> bytes:
    """Floats of bytes that are all zero, in blocks of 16 lines: a first byte of 0, differences of 128."""
    width, height = size
    listed = b"".join(name + struct.pack("<xiIii", 2, 0, 1, 1) for name in names) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    head = struct.pack("<ii", 20000630, 2)
    for name, data in ((b"channels", listed), (b"compression", b"\3"), (b"dataWindow", window)):
        head += name + b"\0x\0" + struct.pack("<i", len(data)) + data
    block = zlib.compress(b"\0" + b"\x80" * (16 * 4 * width * len(names) - 1))
    starts = [len(head) + 1 + 8 * (height // 16) + number * (8 + len(block)) for number in range(height // 16)]
    blocks = b"".join(struct.pack("<ii", 16 * number, len(block)) + block for number in range(height // 16))
    return head + b"\0" + struct.pack(f"<{len(starts)}Q", *starts) + blocks


def test_channels_that_nobody_wants_take_no_memory():
    """Twelve more than the three, of 1 MiB each."""
    data = _zipped((512, 512), [b"B", b"G", b"R", *(b"c%02d" % number for number in range(12))])
    tracemalloc.start()
    decoded = read_exr(data, wanted="RGB")
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert {name: values.shape for name, values in decoded.items()} == dict.fromkeys("RGB", (512, 512))
    assert not any(values.any() for values in decoded.values())
    assert most < 7 << 20


@pytest.mark.parametrize(
    ("names", "message"),
    [
        ([b"B", b"G", b"R", *(b"c%03d" % number for number in range(300))], "of 303 channels; at most 16"),
        ([b"B", b"G", b"R", b"R"], "no channels, or two of one name"),
        ([], "no channels, or two of one name"),
        ([b"\x1b[2J\nX", b"\xff\xfe"], r"channels \\x1b\[2J\\nX, \\xff\\xfe; expected R, G, B"),
    ],
)
def test_channels_that_cannot_be_used_are_refused_in_one_line_that_any_terminal_can_show(names, message):
    with pytest.raises(ValueError, match=message) as caught:
        read_exr(_zipped((64, 32), names), wanted="RGB")
    assert str(caught.value).isprintable()


def test_a_name_in_no_alphabet_is_a_name():
    assert set(read_exr(_zipped((64, 32), [b"B", b"\xff\xfe"]))) == {"B", "\xff\xfe"}
