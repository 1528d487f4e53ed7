import errno
import os
from dataclasses import replace

import cv2
import numpy as np
import pytest

from blender_scenes.render.frame_files import FrameFile, Ledger, put_in_place
from sensors.camera.response import encode_jpeg
from symolo.dataset.layout import frame_name

JPEG = encode_jpeg(np.full((12, 16, 3), 90, np.uint8), 92)


def _made(images, number=1) -> FrameFile:
    images.mkdir(exist_ok=True)
    sha256 = put_in_place(JPEG, images / frame_name(number), 16, 12)
    return FrameFile(number, frame_name(number), sha256, len(JPEG), 0.1)


def test_an_image_is_put_in_place_complete_and_leaves_nothing_beside_it(tmp_path):
    _made(tmp_path / "images")
    assert [p.name for p in (tmp_path / "images").iterdir()] == ["000001.jpg"]
    assert cv2.imread(str(tmp_path / "images" / "000001.jpg")).shape == (12, 16, 3)


def test_a_disk_that_loses_bytes_is_noticed_and_the_place_stays_empty(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "fsync", lambda fd: os.ftruncate(fd, 100))
    with pytest.raises(OSError, match="100 of"):
        put_in_place(JPEG, tmp_path / "000001.jpg", 16, 12)
    assert list(tmp_path.iterdir()) == []


def test_an_image_of_another_size_is_refused(tmp_path):
    with pytest.raises(OSError, match="not the one written"):
        put_in_place(JPEG, tmp_path / "000001.jpg", 32, 24)


def test_recorded_images_are_recognised(tmp_path):
    ledger = Ledger(tmp_path / "images", "job")
    frame = _made(tmp_path / "images")
    assert ledger.whole_files() == {}
    ledger.add(frame)
    assert Ledger(tmp_path / "images", "job").whole_files() == {"000001.jpg": frame}


def test_the_processor_that_put_a_file_in_place_last_made_it_and_one_that_was_not_noted_is_none(tmp_path):
    ledger = Ledger(tmp_path / "images", "job")
    frames = [_made(tmp_path / "images", number) for number in (1, 2, 3)]
    for frame, cpu in zip((*frames, frames[0]), ("b", "a", "", "c"), strict=True):
        ledger.add(replace(frame, cpu=cpu))
    assert ledger.processors() == ("a", "c")
    assert Ledger(tmp_path / "images", "another job").processors() == ()


@pytest.mark.parametrize("damage", ["shorter", "one bit", "missing", "another job", "record cut"])
def test_a_damaged_image_does_not_count(tmp_path, damage):
    images = tmp_path / "images"
    ledger = Ledger(images, "job")
    ledger.add(_made(images))
    ledger.add(_made(images, 2))
    path = images / "000002.jpg"
    if damage == "shorter":
        path.write_bytes(JPEG[:-1])
    elif damage == "one bit":
        path.write_bytes(JPEG[:200] + bytes([JPEG[200] ^ 1]) + JPEG[201:])
    elif damage == "missing":
        path.unlink()
    elif damage == "record cut":
        record = tmp_path / "images.jsonl"
        record.write_bytes(record.read_bytes()[:-5])
    expected = set() if damage == "another job" else {"000001.jpg"}
    job = "other" if damage == "another job" else "job"
    assert set(Ledger(images, job).whole_files()) == expected


def test_a_record_after_one_that_was_cut_short_counts(tmp_path):
    images = tmp_path / "images"
    ledger = Ledger(images, "job")
    ledger.add(_made(images))
    record = tmp_path / "images.jsonl"
    record.write_bytes(record.read_bytes() + b'{"job_sha256": "jo')
    ledger.add(_made(images, 2))
    assert set(ledger.whole_files()) == {"000001.jpg", "000002.jpg"}


def test_a_record_that_the_disk_does_not_take_leaves_no_half(tmp_path, monkeypatch):
    images = tmp_path / "images"
    ledger = Ledger(images, "job")
    ledger.add(_made(images))
    before = (tmp_path / "images.jsonl").read_bytes()
    second = _made(images, 2)
    write = os.write

    def full(descriptor, data):
        if len(data) < 100:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return write(descriptor, data[:50])

    monkeypatch.setattr(os, "write", full)
    with pytest.raises(OSError, match="No space"):
        ledger.add(second)
    assert (tmp_path / "images.jsonl").read_bytes() == before
