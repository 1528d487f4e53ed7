"""Whatever is damaged in a release is found, the right file is named, and repair gives it back."""

import importlib.util
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest

from configs.draw import draw_all
from configs.loader import load_scenario
from pipeline.cli import main
from pipeline.run_folder.stored_runs import spec_problem
from pipeline.run_folder.workspace import Workspace
from pipeline.stages.assemble import assemble
from pipeline.stages.render import JOB, Appearance, RenderTask
from pipeline.stages.simulate_runs import read_recording, simulate_into, simulation_key
from symolo.core.files.atomic_files import make_folder, write_file
from symolo.core.files.file_hashes import sha256_of
from symolo.core.progress import LineReport
from symolo.dataset.tables.rows import Rows
from symolo.verification.verify import verify

_spec = importlib.util.spec_from_file_location("corruptions", Path(__file__).with_name("corruptions.py"))
corruptions = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(corruptions)

SETTINGS = ["stop.time_limit_s=0.4", "render.width_px=32", "render.height_px=24"]


@pytest.fixture(scope="module")
def release(tmp_path_factory) -> Path:
    """Two runs of 0.4 s; its pictures are noise, for what they show plays no part here."""
    workspace = Workspace(tmp_path_factory.mktemp("release") / "data")
    loaded = load_scenario("smoke", SETTINGS)
    specs = draw_all(loaded)
    rng = np.random.default_rng(1)
    with workspace.locked():
        for spec in specs:
            path = workspace.simulate(spec.key).path
            simulate_into(spec.model_dump_json(), path, simulation_key(spec), lambda _share: None)
            rows = Rows.from_recording(read_recording(path))
            order = RenderTask.of(spec.key, Appearance.of(spec), rows, workspace.render(spec.key))
            make_folder(order.task.files)
            write_file(order.task.folder.path / JOB, order.job_text.encode())
            hashes = {}
            for name in order.task.names():
                cv2.imwrite(str(order.task.files / name), rng.integers(30, 220, (24, 32, 3), dtype=np.uint8))
            for name in order.task.names():
                hashes[name] = sha256_of(order.task.files / name)
            order.task.finish(hashes)
        assemble(workspace, loaded.tree, specs, [], LineReport())
    assert list(verify(workspace.out, spec_problem)) == []
    return workspace.out


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
