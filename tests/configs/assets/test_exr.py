import struct

import numpy as np
import pytest

from configs.assets.exr import read_exr


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
    found = read_exr(_exr(channels))
    assert set(found) == set(channels)
    for name, values in channels.items():
        np.testing.assert_array_equal(found[name], values)


def test_a_file_cut_anywhere_is_refused(channels):
    whole = _exr(channels)
    for length in range(len(whole)):
        with pytest.raises(ValueError, match="OpenEXR"):
            read_exr(whole[:length])


def test_a_compressed_file_is_refused(channels):
    with pytest.raises(ValueError, match="compressed"):
        read_exr(_exr(channels, compression=3))


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
