"""`symolo verify --reproduce`: images rendered again, on a machine like that of the dataset and on another one."""

import itertools
import json
import re
from collections import Counter

import cv2
import numpy as np
import pytest

from pipeline.repair.reproduction import drawn_images
from pipeline.work.supervisor import UnitFailure
from symolo.dataset.documents.metadata import read_metadata

SAME = "images have the same bytes when they are rendered again (--seed"


@pytest.fixture
def elsewhere(dataset, copy_of, sign):
    """The dataset as if another version of Blender had made it."""
    root = copy_of(dataset)
    content = json.loads((root / "metadata.json").read_text())
    content["made_with"]["bpy"] = "4.4.0"
    (root / "metadata.json").write_text(json.dumps(content))
    sign(root)
    return root


def forge(root, sign):
    """Replace an image by one of a single grey, with lists of checksums that fit."""
    path = root / "CW/test_1/images/000002.jpg"
    path.write_bytes(cv2.imencode(".jpg", np.full((24, 32, 3), 90, np.uint8))[1].tobytes())
    sign(root)
    return path.relative_to(root).as_posix()


def test_blender_gives_the_same_bytes_again_and_a_forged_image_is_found(dataset, copy_of, sign, symolo):
    """Of one run, so that Blender starts once."""
    root = copy_of(dataset)
    file = forge(root, sign)
    assert symolo("verify", root).code == 0, "the lists fit"
    metadata = read_metadata(root)
    seed = next(seed for seed in itertools.count() if is_of_the_forged_run(drawn_images(metadata, 4, seed)))
    ended = symolo("verify", root, "--reproduce", "4", "--seed", seed, "--workers", "1")
    assert ended.code == 4
    fault, conclusion = ended.out.splitlines()[1:]
    assert re.match(rf"{file}: differs when it is rendered again \([\d.]+ dB\): \d+ of 768 pixels differ", fault)
    assert conclusion == f"{root}: 3 of 4 {SAME} {seed})"
    assert not (root / ".stages").exists()


def is_of_the_forged_run(drawing):
    return [one.record.run for one in drawing] == ["CW/test_1"] and 2 in drawing[0].numbers


def test_the_seed_is_printed_and_repeats_the_draw(dataset, symolo, hands):
    del hands  # every image comes out grey, so that each one that is drawn is named
    first = symolo("verify", dataset, "--reproduce", "3")
    (seed,) = re.findall(r"--seed (\d+)", first.out)
    assert symolo("verify", dataset, "--reproduce", "3", "--seed", seed).out == first.out
    files = re.findall(r"^(\S+\.jpg): differs", first.out, re.MULTILINE)
    assert len(files) == len(set(files)) == 3


def test_every_image_is_drawn_as_often_as_every_other(dataset):
    """12 images, of which 3 are drawn 200 times: each is expected 50 times, with a standard deviation of 6.1."""
    metadata = read_metadata(dataset)
    assert metadata is not None
    drawn = [drawn_images(metadata, 3, seed) for seed in range(200)]
    counts = Counter((one.record.run, number) for drawing in drawn for one in drawing for number in one.numbers)
    assert len(counts) == 12
    assert all(abs(count - 50) < 4 * 6.1 for count in counts.values())


def test_other_bytes_on_another_machine_are_no_fault_but_no_proof(elsewhere, symolo, hands):
    del hands
    ended = symolo("verify", elsewhere, "--reproduce", "2", "--seed", "3")
    assert ended.code == 5
    assert "reproduce: equal bytes cannot be expected: the release was made with bpy 4.4.0, here it is" in ended.err
    assert "different bytes are no proof of a fault here: the release was made with bpy 4.4.0" in ended.err
    assert f"0 of 2 {SAME} 3)" in ended.out


def test_an_image_that_cannot_be_rendered_is_no_fault(dataset, symolo, monkeypatch):
    def fail(units, _workers, _on_event, **_options):
        return [UnitFailure(unit, "Blender is gone") for unit in units]

    monkeypatch.setattr("pipeline.executors.local.run_units", fail)
    ended = symolo("verify", dataset, "--reproduce", "1", "--seed", "1")
    assert ended.code == 5
    assert "could not be rendered again" in ended.out
    assert "Blender is gone" in ended.err


def test_a_dataset_with_faults_is_not_rendered(dataset, copy_of, symolo):
    root = copy_of(dataset)
    (root / "README.md").write_text("changed")
    ended = symolo("verify", root, "--reproduce", "1")
    assert (ended.code, "rendered" in ended.out + ended.err) == (4, False)


def test_it_works_on_a_bag(dataset, tmp_path, symolo, hands):
    hands.paint = lambda _unit: None
    assert symolo("bag", dataset, "--out", tmp_path / "bag").code == 0
    ended = symolo("verify", tmp_path / "bag", "--reproduce", "1", "--seed", "1")
    assert "could not be rendered again" in ended.out
