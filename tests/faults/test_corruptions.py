"""Whatever is damaged in a release is found, the right file is named, and repair gives it back."""

import shutil
from pathlib import Path

import pytest

from pipeline.cli import main
from pipeline.run_folder.stored_spec import spec_problem
from symolo.verification.verify import verify
from tests.faults import corruptions


def found_wrong(corrupter, kinds, count) -> list[str]:
    """What `verify` made of each damage that it did not find as it was."""
    wrong = []
    for i in range(count):
        damage = corrupter.damage(kinds[i % len(kinds)])
        named = {finding.file for finding in verify(corrupter.copy, spec_problem)}
        if named != damage.files:
            wrong.append(f"{i}: {damage.kind} of {sorted(damage.files)}: named {sorted(named)}")
        corrupter.mend(damage)
    return wrong


def test_every_kind_of_damage_is_found_and_only_the_right_file_named(release, tmp_path):
    corrupter = corruptions.Corrupter(release, tmp_path / "copy", seed=7)
    kinds = list(corruptions.KINDS)
    assert found_wrong(corrupter, kinds, 2 * len(kinds)) == []
    assert list(verify(corrupter.copy, spec_problem)) == []


@pytest.mark.faults
def test_ten_thousand_corruptions_are_found(release, tmp_path):
    corrupter = corruptions.Corrupter(release, tmp_path / "copy", seed=8)
    assert found_wrong(corrupter, list(corruptions.KINDS), 10_000) == []


def test_repair_gives_back_what_the_stages_keep(release, tmp_path):
    """A damage of each kind, one after the other."""
    copy = tmp_path / "copy"
    corrupter = corruptions.Corrupter(release, copy, seed=9)
    shutil.copytree(release / ".stages", copy / ".stages")
    for kind in corruptions.KINDS:
        damage = corrupter.damage(kind)
        assert main(["repair", str(copy), "--remove-extra"]) == 0, damage
        assert sorted(_content(copy).items()) == sorted(_content(release).items()), damage


@pytest.mark.parametrize("fits", [False, True], ids=["lists as released", "lists that fit"])
def test_repair_has_nothing_to_say_if_and_only_if_verify_finds_nothing(fits, release, tmp_path, sign, symolo):
    """Of each kind of damage; with lists that fit it, only the content of the files can tell."""
    # No seed edits metadata.json, for which `repair` tries all its 400,000 bits; `test_repair.py` does.
    for i, kind in enumerate(corruptions.KINDS):
        copy = tmp_path / str(i)
        damage = corruptions.Corrupter(release, copy, seed=220 + i).damage(kind)
        if fits:
            sign(copy)
        _agree(copy, symolo, damage)


def test_empty_folders_that_belong_to_no_release_are_found_and_removed(release, tmp_path, symolo):
    copy = tmp_path / "copy"
    shutil.copytree(release, copy, ignore=shutil.ignore_patterns(".stages"))
    (copy / "CW/test_9/images").mkdir(parents=True)
    (copy / "notes").mkdir()
    findings = {fault.file: fault.what for fault in verify(copy, spec_problem)}
    assert findings.keys() >= {"CW/test_9/images", "notes"}
    assert findings["notes"] == "is an empty folder, and manifest-sha256.txt names no file in it"
    ended = symolo("repair", copy)
    assert ended.code == 4
    assert "notes: is an empty folder, and manifest-sha256.txt names no file in it; --remove-extra" in ended.out
    assert symolo("repair", copy, "--remove-extra").code == 0
    assert list(verify(copy, spec_problem)) == []
    assert not (copy / "CW/test_9").exists()


def test_repair_and_verify_agree_on_content_whose_checksums_fit(release, tmp_path, sign, symolo):
    """What no list of checksums can tell."""
    deep = b"[" * 100_000 + b"]" * 100_000
    contents = {
        "metadata.json": deep,
        "CW/test_1/side/spec.json": deep,
        "CW/test_1/side/intrinsics.json": b'{"a":' * 100_000,
        "CW/test_1/data.csv": b"t,x\n1,2\n",
        "CW/test_1/images/000001.jpg": b"\xff\xd8\xff and no more",
        "CW/test_1/image_positions.txt": b"",
    }
    for i, (name, data) in enumerate(contents.items()):
        copy = tmp_path / str(i)
        shutil.copytree(release, copy, ignore=shutil.ignore_patterns(".stages"))
        (copy / name).write_bytes(data)
        sign(copy)
        assert _agree(copy, symolo, name), f"{name}: nobody finds it"


def _agree(copy: Path, symolo, damage: object) -> bool:
    """Whether `verify` finds a fault; `repair` then repairs or names one, and else says that there is none."""
    faults = [str(fault) for fault in verify(copy, spec_problem)]
    ended = symolo("repair", copy)
    has_nothing_to_say = ended.code == 0 and "0 faults repaired, every file is as it was released" in ended.out
    assert has_nothing_to_say == (not faults), (damage, faults, ended)
    left = list(verify(copy, spec_problem))
    assert (ended.code == 0) == (not left), (damage, left, ended)
    return bool(faults)


@pytest.mark.faults
def test_repair_of_every_file_that_can_be_made_without_the_stages(release, tmp_path):
    """All but the images, which are noise here; each is emptied in turn, metadata.json has one bit flipped."""
    copy = tmp_path / "copy"
    corrupter = corruptions.Corrupter(release, copy, seed=10)
    for name in corrupter.names:
        if name.endswith(".jpg"):
            continue
        data = (copy / name).read_bytes()
        flipped = bytes([data[0], data[1] ^ 4]) + data[2:]
        (copy / name).write_bytes(flipped if name == "metadata.json" else b"")
        assert main(["repair", str(copy)]) == 0, name
        assert _content(copy) == _content(release)
    assert not (copy / ".stages").exists()


def _content(root: Path) -> dict[str, bytes]:
    files = (path for path in root.rglob("*") if path.is_file() and ".stages" not in path.parts)
    return {path.relative_to(root).as_posix(): path.read_bytes() for path in files}
