"""`symolo repair` makes exactly the damaged files again; the rest is in tests/faults/test_corruptions.py."""

import json
import shutil

import cv2
import numpy as np
import pytest

from pipeline.repair import existing_copies, repair_state
from pipeline.repair.repair_state import with_one_bit_flipped
from symolo.verification.verify import verify

RUN = "CW/test_1"


@pytest.fixture
def killed_at_write(monkeypatch):
    """Interrupts a repair at the nth file that a module of it puts in place."""

    def at(count, module=repair_state):
        put, write = [], module.write_file

        def killed(path, data):
            if len(put) == count - 1:
                raise KeyboardInterrupt
            put.append(path)
            write(path, data)

        monkeypatch.setattr(module, "write_file", killed)

    return at


def test_one_wrong_bit_is_found_by_its_hash_alone():
    """SHA-256 of `abc` as FIPS 180-2 prints it, appendix B.1; `cbc` differs in one bit, `dbc` in two."""
    digest = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    assert with_one_bit_flipped(b"cbc", digest) == b"abc"
    assert with_one_bit_flipped(b"abb", digest) == b"abc"
    assert with_one_bit_flipped(b"dbc", digest) is None
    assert with_one_bit_flipped(b"", digest) is None


def test_an_interrupted_repair_leaves_whole_files_and_goes_on(
    dataset, copy_of, symolo, release_of, monkeypatch, killed_at_write
):
    root = copy_of(dataset, stages=True)
    names = [f"{RUN}/images/00000{number}.jpg" for number in (1, 2, 3)]
    for name in names:
        (root / name).write_bytes(b"")
    killed_at_write(2)
    assert symolo("repair", root).code == 130
    monkeypatch.undo()
    assert [len((root / name).read_bytes()) > 0 for name in names] == [True, False, False]
    assert not (root / ".stages/repair").exists()
    assert symolo("repair", root).code == 0
    assert release_of(root) == release_of(dataset)


@pytest.mark.parametrize("module", [repair_state, existing_copies])
def test_two_files_that_were_swapped_are_both_restored_after_an_interruption_between_them(
    module, dataset, copy_of, symolo, release_of, monkeypatch, killed_at_write
):
    """The content of metadata.json follows from nothing else, so that it must not be lost with what was overwritten."""
    root = copy_of(dataset)
    (root / "metadata.json").rename(root / "other")
    (root / "README.md").rename(root / "metadata.json")
    (root / "other").rename(root / "README.md")
    killed_at_write(2, module)
    assert symolo("repair", root).code == 130
    monkeypatch.undo()
    ended = symolo("repair", root)
    assert ended.code == 0
    assert "written again" not in ended.out
    assert release_of(root) == release_of(dataset)
    assert not (root / ".stages").exists()


def test_a_file_under_another_name_is_no_file_of_the_users_own_after_an_interruption(
    dataset, copy_of, symolo, release_of, monkeypatch
):
    root = copy_of(dataset)
    (root / RUN / "data.csv").rename(root / RUN / "moved.csv")

    def killed(*_arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr("pipeline.repair.repair._remove", killed)
    assert symolo("repair", root).code == 130
    monkeypatch.undo()
    assert symolo("repair", root).code == 0
    assert release_of(root) == release_of(dataset)


def test_what_a_killed_repair_left_in_a_run_is_removed(dataset, copy_of, symolo, release_of):
    root = copy_of(dataset)
    (root / RUN / "images/.000001.jpg.0123456789abcdef.tmp").write_bytes(b"half")
    assert symolo("repair", root).code == 0
    assert release_of(root) == release_of(dataset)


def test_a_file_that_comes_out_otherwise_is_left_and_the_reason_reported(dataset, copy_of, sign, symolo):
    """A README of another version: its checksum is what was released, and nothing here makes it again."""
    root = copy_of(dataset)
    metadata = root / "metadata.json"
    content = json.loads(metadata.read_text())
    content["made_with"]["bpy"] = "4.4.0"
    metadata.write_text(json.dumps(content))
    (root / "README.md").write_text("of another version")
    sign(root)
    (root / "README.md").write_text("damaged")
    ended = symolo("repair", root)
    assert ended.code == 4
    assert (root / "README.md").read_text() == "damaged"
    assert "not repaired: README.md: was changed" in ended.out
    assert "the release was made with bpy 4.4.0, here it is" in ended.out


def test_a_link_in_place_of_a_run_is_found_and_not_followed(dataset, copy_of, tmp_path):
    root = copy_of(dataset)
    (root / "CW/test_1/data.csv").rename(tmp_path / "kept.csv")
    (root / "CW/test_1").rename(tmp_path / "elsewhere")
    (root / "CW/test_1").symlink_to(tmp_path / "elsewhere")
    before = sorted(path.name for path in (tmp_path / "elsewhere").rglob("*"))
    findings = {finding.file for finding in verify(root)}
    assert f"{RUN}/data.csv" in findings
    assert RUN in findings
    assert sorted(path.name for path in (tmp_path / "elsewhere").rglob("*")) == before


def test_no_dataset_and_a_bag_are_refused_in_one_line(dataset, tmp_path, symolo):
    (tmp_path / "empty").mkdir()
    assert symolo("bag", dataset, "--out", tmp_path / "bag").code == 0
    for folder in ("empty", "bag"):
        ended = symolo("repair", tmp_path / folder)
        assert (ended.code, ended.err.count("\n")) == (2, 1)


@pytest.mark.faults
def test_without_stages_a_run_is_simulated_and_only_the_damaged_frames_are_rendered(
    dataset, copy_of, symolo, release_of
):
    root = copy_of(dataset)
    image = root / RUN / "images/000003.jpg"
    image.write_bytes(image.read_bytes()[:100])
    (root / RUN / "data.csv").unlink()
    (root / RUN / "side/spec.json").write_bytes(b"")
    ended = symolo("repair", root)
    assert ended.code == 0
    assert "1 of 1 frame " in ended.err
    assert release_of(root) == release_of(dataset)
    assert not (root / ".stages").exists()


@pytest.mark.faults
def test_without_stages_annotations_are_made_again_with_the_frames_that_need_it(
    tmp_path, tiny, copy_of, symolo, release_of
):
    """One file of each kind, the tables, and the image of another frame."""
    kinds = ["depth", "instance", "semantic", "normals", "flow", "free_floor"]
    asked = f"render.annotations=[{','.join(kinds)},boxes_2d,boxes_3d,key_points]"
    made = tmp_path / "made"
    assert symolo("release", "smoke", "--out", made, *tiny, f"--set={asked}", "--workers", "1").code == 0
    root = copy_of(made)
    for number, kind in enumerate(kinds, start=1):
        path = root / RUN / f"annotations/{kind}/{number:06d}.png"
        path.write_bytes(path.read_bytes()[:50] if number % 2 else b"")
    (root / RUN / "annotations/annotations.json").unlink()
    (root / RUN / "images/000002.jpg").unlink()
    ended = symolo("repair", root)
    assert (ended.code, list(verify(root))) == (0, [])
    assert release_of(root) == release_of(made)
    assert not (root / ".stages").exists()


@pytest.mark.faults
def test_pictures_of_the_users_own_are_needed_to_make_a_frame_again(tmp_path, tiny, copy_of, symolo, release_of):
    """They lie in .stages/assets alone: with it the frame comes out the same, without it the reason is told."""
    floor = np.random.Generator(np.random.PCG64(1)).integers(0, 256, (64, 64, 3), dtype=np.uint8)
    assert cv2.imwrite(str(tmp_path / "floor.png"), floor)
    look = "name: own\nassets: .\nfloor: {material: image, image: {file: floor.png}}\n"
    (tmp_path / "own.yaml").write_text(look)
    own = [f"--set=look={tmp_path / 'own.yaml'}"]
    made = tmp_path / "made"
    assert symolo("release", "smoke", "--out", made, *tiny, *own, "--workers", "1").code == 0
    root = copy_of(made)
    shutil.copytree(made / ".stages/assets", root / ".stages/assets")
    picture = root / RUN / "images/000003.jpg"
    picture.unlink()
    assert symolo("repair", root).code == 0
    assert release_of(root) == release_of(made)
    shutil.rmtree(root / ".stages")
    picture.unlink()
    ended = symolo("repair", root)
    assert ended.code == 4
    assert ".stages/assets no longer contains them" in ended.out + ended.err
