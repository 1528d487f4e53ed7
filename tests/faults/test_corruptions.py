"""Whatever is damaged in a release is found, the right file is named, and repair gives it back."""

import importlib.util
import shutil
from pathlib import Path

import pytest

from pipeline.cli import main
from pipeline.run_folder.stored_runs import spec_problem
from symolo.verification.verify import verify

_spec = importlib.util.spec_from_file_location("corruptions", Path(__file__).with_name("corruptions.py"))
corruptions = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(corruptions)


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


@pytest.mark.faults
def test_repair_of_every_file_that_can_be_made_without_the_stages(release, tmp_path):
    """All but the pictures, which are noise here; each is emptied in turn, metadata.json has one bit flipped."""
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
