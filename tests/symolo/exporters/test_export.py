"""`symolo export` refuses what it cannot do before it writes, and writes all or nothing."""

import json
import re
import shutil
import sys
from collections import Counter
from dataclasses import replace

import pytest

from symolo.dataset.documents.splits_record import NEIGHBOURS_WARNING
from symolo.exporters import FORMATS, coco, tum
from symolo.exporters.base import ExportSettings
from symolo.exporters.export import exporters_of, open_release, plan


def one_line(ended) -> str:
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    return ended.err


def test_it_says_what_it_wrote_and_of_what(random_release, tmp_path, symolo):
    root, out = random_release(1).root, tmp_path / "out"
    ended = symolo("export", root, "--format", "tum,webdataset", "--out", out)
    assert (ended.code, ended.out) == (0, f"{out}: tum, webdataset, 0.0 MB\n")
    assert sorted(path.name for path in out.iterdir()) == ["export.json", "tum", "webdataset"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out"]
    summary = json.loads((out / "export.json").read_text())
    assert (summary["name"], summary["runs"], summary["licence"]) == ("smoke", ["CW/test_1", "CCW/test_1"], "CC-BY-4.0")
    tag = (root / "tagmanifest-sha256.txt").read_text()
    assert f"{summary['manifest_sha256']}  manifest-sha256.txt" in tag


def test_a_dry_run_says_the_size_of_what_a_run_then_writes(random_release, tmp_path, symolo):
    root, out = random_release(1, annotated=True).root, tmp_path / "out"
    names = "tum,kitti,coco,webdataset,parquet"
    printed = symolo("export", root, "--format", names, "--out", out, "--dry-run").out.splitlines()
    assert not out.exists()
    assert symolo("export", root, "--format", names, "--out", out).code == 0
    for line, name in zip(printed, names.split(","), strict=True):
        files = [path for path in (out / name).rglob("*") if path.is_file()]
        size = sum(path.stat().st_size for path in files) / 1e6
        count = "1 file" if len(files) == 1 else f"{len(files)} files"
        assert line.startswith(f"{name}: {count}, {size:.3f} MB: ")


def test_the_sizes_of_json_are_those_of_the_written_files_which_are_made_once(
    random_release, tmp_path, symolo, monkeypatch
):
    root, out = random_release(1, annotated=True).root, tmp_path / "out"
    made: Counter[str] = Counter()

    def counted(file):
        def content():
            made[file.name] += 1
            return file.content()

        return replace(file, content=content, exact_bytes=None, estimated_bytes=lambda: 0)

    def counting(exporter):
        return replace(exporter, files=lambda data, settings: [counted(f) for f in exporter.files(data, settings)])

    for module in (tum, coco):
        monkeypatch.setattr(module, "EXPORTER", counting(module.EXPORTER))
    document = json.loads(symolo("export", root, "--format", "tum,coco", "--out", out, "--json").out)
    assert set(made.values()) == {1}
    for part in document["formats"]:
        files = [path for path in (out / part["format"]).rglob("*") if path.is_file()]
        assert (part["files"], part["bytes"]) == (len(files), sum(path.stat().st_size for path in files))


def test_the_json_has_every_warning_that_is_printed(random_release, tmp_path, symolo):
    by_image = "{by: image, shares: {train: 0.5, test: 0.5}}"
    arguments = ("--format", "coco", "--splits", by_image, "--out", tmp_path / "out", "--dry-run", "--json")
    ended = symolo("export", random_release(1, annotated=True).root, *arguments)
    printed = [line.removeprefix("warning: ") for line in ended.err.splitlines() if line.startswith("warning: ")]
    assert NEIGHBOURS_WARNING in printed
    assert json.loads(ended.out)["warnings"] == printed


def test_only_the_runs_that_were_asked_for(random_release, tmp_path, symolo):
    out = tmp_path / "out"
    arguments = ("export", random_release(1).root, "--format", "tum", "--out", out, "--runs")
    assert symolo(*arguments, "CCW/*").code == 0
    assert sorted(path.name for path in (out / "tum").iterdir()) == ["CCW"]
    refused = one_line(symolo(*arguments[:-2], tmp_path / "other", "--runs", "X*"))
    assert "no run matches: got 'X*', allowed: a pattern of names such as CW/test_1, CCW/test_1" in refused


def test_what_cannot_be_exported_is_refused_before_anything_is_written(
    random_release, copy_of, tmp_path, tmp_path_factory, symolo
):
    root, out = random_release(1).root, tmp_path / "out"
    no_masks = random_release(1, kinds=("depth", "boxes_2d")).root
    damaged = copy_of(root)
    (damaged / "CW/test_1/data.csv").write_text("")
    taken = tmp_path / "taken"
    taken.mkdir()
    case = tmp_path_factory.mktemp("case")
    (case / "data.csv").write_text("")
    (taken / "mine.txt").write_text("mine")
    known = ", ".join(FORMATS)
    for arguments, what in (
        ((root, "tun", out), f"--format: got 'tun', allowed: {known}; did you mean tum"),
        ((root, "ros2", out), f"--format: got 'ros2', allowed: {known}; a bag of ROS 2 is the format mcap"),
        ((root, "csv", out), "the tables of a release are CSV files already: ROUTE/test_N/data.csv and those of ROUTE"),
        ((root, "croissant", out), f"--format: got 'croissant', allowed: {known}; `symolo pack` writes croissant.json"),
        ((root, "tum,", out), "names separated by commas"),
        ((damaged, "tum", out), "CW/test_1/data.csv: was changed: its SHA-256 is not that of manifest-sha256.txt"),
        ((damaged, "tum", out), "symolo repair"),
        ((root / "CW/test_1", "tum", out), "is a single run, which has no checksums"),
        ((case, "tum", out), "is a case or a log, and no release; name a release; `symolo import` makes one of a log"),
        ((tmp_path / "taken", "tum", out), "neither a release nor a run"),
        ((root, "tum", taken), "is there already; name a folder that is new or empty"),
        ((root, "tum", root / "within"), "lies within the release"),
        ((root, "coco", out), "run CW/test_1 has no annotations of the kind `instance`, which give the masks"),
        ((root, "tum,coco", out), "add `instance` to render.annotations and repeat `symolo release` with the same"),
        ((no_masks, "coco", out), "run CW/test_1 has no annotations of the kind `instance`, which give the masks"),
    ):
        folder, formats, place = arguments
        assert what in one_line(symolo("export", folder, "--format", formats, "--out", place))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["copy", "taken"]
    assert [path.name for path in taken.iterdir()] == ["mine.txt"]


@pytest.mark.parametrize(
    ("name", "module"),
    [
        *((name, "pyarrow") for name in ("parquet", "huggingface", "lerobot")),
        ("mcap", "rosbags"),
        ("ros1", "rosbags"),
        ("hdf5", "h5py"),
    ],
)
def test_a_library_that_is_missing_is_named_before_anything_is_written(
    name, module, random_release, tmp_path, symolo, monkeypatch
):
    for loaded in [one for one in sys.modules if one.startswith(f"{module}.")]:
        monkeypatch.delitem(sys.modules, loaded)
    monkeypatch.setitem(sys.modules, module, None)
    ended = symolo("export", random_release(1).root, "--format", f"tum,{name}", "--out", tmp_path / "out")
    messages = (
        f"symolo: the package {module} is missing; install symolo with the extra `export`:"
        " `pip install '.[export]'` in the folder of its sources, or `pip install 'symolo[export]'` from an index\n"
    )
    assert (ended.code, ended.err) == (5, messages)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError(28, "No space left on device")])
def test_what_ends_midway_leaves_nothing(error, random_release, tmp_path, symolo, monkeypatch):
    root, out = random_release(1).root, tmp_path / "out"
    arguments = ("export", root, "--format", "kitti", "--out", out)
    with monkeypatch.context() as patch:
        patch.setattr("symolo.exporters.export.sha256_of", lambda _path: (_ for _ in ()).throw(error))
        assert symolo(*arguments).code == (130 if error is KeyboardInterrupt else 5)
    assert list(tmp_path.iterdir()) == []
    assert symolo(*arguments).code == 0


def test_a_disk_without_room_is_reported_before_the_work_starts(random_release, tmp_path, symolo, monkeypatch):
    """50 kB free: enough for trajectories, not for images."""
    root = random_release(1).root
    usage = shutil.disk_usage(tmp_path)._replace(free=50_000)
    monkeypatch.setattr(shutil, "disk_usage", lambda _path: usage)
    formats = ",".join(name for name in FORMATS if name not in {"coco", "yolo"})
    refused = symolo("export", root, "--format", formats, "--out", tmp_path / "out")
    assert (refused.code, refused.err.count("\n")) == (5, 1)
    assert re.search(r"/out: about \d+ (MB|kB) are needed and 50 kB are free", refused.err)
    assert "another disk, or choose fewer runs with --runs" in refused.err
    assert list(tmp_path.iterdir()) == []
    assert symolo("export", root, "--format", "tum", "--out", tmp_path / "out").code == 0


def test_the_room_that_is_looked_for_is_about_what_is_written(random_release):
    """Within a factor of two for each format, also where the size is not worked out first."""
    data = open_release(random_release(2, annotated=True).root, None)
    for planned in plan(data, exporters_of(FORMATS, ""), ExportSettings(10**6)):
        asked = sum(file.room_bytes() for file in planned.files)
        taken = sum(file.size_bytes() for file in planned.files)
        assert 0.5 < asked / taken < 2, planned.exporter.name
