"""`symolo repair` makes exactly the damaged files again; the rest is in tests/faults/test_corruptions.py."""

import json

import pytest

from pipeline.repair.mending import with_one_bit_less_wrong
from pipeline.verify import verify

RUN = "CW/test_1"


def test_one_wrong_bit_is_found_by_its_hash_alone():
    """SHA-256 of `abc` as FIPS 180-2 prints it, appendix B.1; `cbc` differs in one bit, `dbc` in two."""
    digest = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    assert with_one_bit_less_wrong(b"cbc", digest) == b"abc"
    assert with_one_bit_less_wrong(b"abb", digest) == b"abc"
    assert with_one_bit_less_wrong(b"dbc", digest) is None
    assert with_one_bit_less_wrong(b"", digest) is None


def test_an_interrupted_repair_leaves_whole_files_and_goes_on(dataset, copy_of, symolo, release_of, monkeypatch):
    root = copy_of(dataset, stages=True)
    names = [f"{RUN}/images/00000{number}.jpg" for number in (1, 2, 3)]
    for name in names:
        (root / name).write_bytes(b"")
    put = []
    from pipeline.repair import mending  # noqa: PLC0415 - to be changed

    write = mending.write_file

    def killed(path, data):
        if put:
            raise KeyboardInterrupt
        put.append(path)
        write(path, data)

    monkeypatch.setattr(mending, "write_file", killed)
    assert symolo("repair", root).code == 130
    monkeypatch.undo()
    assert [len((root / name).read_bytes()) > 0 for name in names] == [True, False, False]
    assert not (root / ".stages/repair").exists()
    assert symolo("repair", root).code == 0
    assert release_of(root) == release_of(dataset)


def test_a_file_that_comes_out_otherwise_is_left_and_the_reason_told(dataset, copy_of, sign, symolo):
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
    assert "bpy 4.4.0 made it and here is" in ended.out


def test_a_link_in_place_of_a_run_is_found_and_not_followed(dataset, copy_of, tmp_path):
    root = copy_of(dataset)
    (root / "CW/test_1/data.csv").rename(tmp_path / "kept.csv")
    (root / "CW/test_1").rename(tmp_path / "elsewhere")
    (root / "CW/test_1").symlink_to(tmp_path / "elsewhere")
    before = sorted(path.name for path in (tmp_path / "elsewhere").rglob("*"))
    found = {finding.file for finding in verify(root)}
    assert f"{RUN}/data.csv" in found
    assert RUN in found
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
    assert "1 of 1 frames" in ended.err
    assert release_of(root) == release_of(dataset)
    assert not (root / ".stages").exists()
