"""Each format that knows splits is opened by its own reader: the runs of each split are those of the release's rule."""

import json
import tarfile

import datasets
import h5py
import numpy as np
import pandas as pd
import pytest
from pycocotools.coco import COCO

import symolo as library
from symolo.core.errors import InputError

FORMATS = "coco,webdataset,parquet,hdf5,huggingface,lerobot"
TRAIN, TEST = "CCW/test_1", "CW/test_1"
"""Runs of the two splits; in the release, the one of the test comes first."""
LISTED = f"{{runs: {{train: [CCW/*], test: [{TEST}]}}}}"


@pytest.fixture(scope="module")
def divided(random_release, tmp_path_factory):
    """The release, and its export with one run for training and the other for the test."""
    release = random_release(2, annotated=True)
    out = tmp_path_factory.mktemp("divided") / "out"
    from pipeline.cli import main  # noqa: PLC0415 - as the user does

    assert main(["export", str(release.root), "--format", FORMATS, "--splits", LISTED, "--out", str(out)]) == 0
    return release, out


def images_of(release, run):
    return sum(len(truth.pictures) for truth in release.runs if truth.name == run)


def test_coco_has_a_file_for_each_split(divided):
    release, out = divided
    assert {path.name for path in (out / "coco/annotations").iterdir()} == {
        "instances_train.json",
        "instances_test.json",
    }
    ids = [COCO(path).anns.keys() for path in (out / "coco/annotations").iterdir()]
    assert not ids[0] & ids[1]
    for split, run in (("train", TRAIN), ("test", TEST)):
        coco = COCO(out / f"coco/annotations/instances_{split}.json")
        images = coco.loadImgs(coco.getImgIds())
        assert {image["run"] for image in images} == {run}
        assert len(images) == images_of(release, run)
        assert {one["image_id"] for one in coco.anns.values()} <= {image["id"] for image in images}
        assert all((out / "coco/images" / image["file_name"]).is_file() for image in images)


def test_webdataset_has_shards_for_each_split(divided):
    release, out = divided
    for split, run in (("train", TRAIN), ("test", TEST)):
        names = [name for path in (out / "webdataset").glob(f"symolo-{split}-*.tar") for name in tar_names(path)]
        assert {name.rpartition("/")[0] for name in names} == {run}
        assert sum(name.endswith(".jpg") for name in names) == images_of(release, run)
    assert len([*(out / "webdataset").glob("*.tar")]) == len([*(out / "webdataset").glob("symolo-t*-*.tar")])


def tar_names(path):
    with tarfile.open(path) as shard:
        return shard.getnames()


def test_datasets_loads_each_split(divided, tmp_path, monkeypatch):
    release, out = divided
    monkeypatch.setattr(datasets.config, "HF_HUB_OFFLINE", True)
    datasets.disable_progress_bars()
    for table in ("images", "rows"):
        loaded = datasets.load_dataset(str(out / "huggingface"), table, cache_dir=str(tmp_path / "cache"))
        assert {split: set(part["run"]) for split, part in loaded.items()} == {"train": {TRAIN}, "test": {TEST}}
    assert {split: len(part) for split, part in loaded.items()} == {
        "train": len(release.runs[1].table),
        "test": len(release.runs[0].table),
    }


def test_lerobot_has_a_range_of_episodes_for_each_split(divided):
    release, out = divided
    info = json.loads((out / "lerobot/meta/info.json").read_text())
    assert info["splits"] == {"train": "0:1", "test": "1:2"}
    frames = pd.concat([pd.read_parquet(path) for path in sorted((out / "lerobot/data").glob("*/*.parquet"))])
    for episode, run in enumerate((TRAIN, TEST)):
        of_episode = frames[frames["episode_index"] == episode]
        assert {image["path"].rpartition("/")[0] for image in of_episode["observation.images.front"]} == {run}
        assert len(of_episode) == images_of(release, run)


def test_parquet_and_hdf5_name_the_split_of_each_run(divided):
    _, out = divided
    for name in ("rows", "images", "wheels"):
        table = pd.read_parquet(out / f"parquet/{name}.parquet")
        assert {*zip(table["run"], table["split"], strict=True)} == {(TRAIN, "train"), (TEST, "test")}
    for run, split in ((TRAIN, "train"), (TEST, "test")):
        with h5py.File(out / "hdf5/tables.hdf5") as file:
            assert file[run].attrs["split"] == split
        with h5py.File(out / f"hdf5/{run}/0.hdf5") as file:
            assert file.attrs["split"] == split


def test_export_names_the_splits_and_how_many_images_they_have(divided, symolo, tmp_path):
    release, out = divided
    assert json.loads((out / "export.json").read_text())["splits"]["runs"] == {"train": [TRAIN], "test": [TEST]}
    ended = symolo(
        "export", release.root, "--format", "tum", "--splits", LISTED, "--out", tmp_path / "out", "--dry-run"
    )
    counts = [images_of(release, run) for run in (TRAIN, TEST)]
    assert ended.out.splitlines()[-1] == (f"splits: train 1 run, {counts[0]} images; test 1 run, {counts[1]} images")
    assert not (tmp_path / "out").exists()


def test_splits_by_image_are_warned_about_and_have_every_image_once(random_release, symolo, tmp_path):
    release, out = random_release(2, annotated=True), tmp_path / "out"
    rule = tmp_path / "rule.yaml"
    rule.write_text("splits:  # as in a scenario\n  by: image\n  shares: {train: 0.5, test: 0.5}\n")
    formats = "coco,webdataset,parquet,hdf5,huggingface"
    ended = symolo("export", release.root, "--format", formats, "--splits", rule, "--out", out)
    assert ended.code == 0
    assert "warning: splits by image: neighbouring images of a run are nearly alike" in ended.err
    parts = {
        split: {
            (image["run"], image["img"])
            for image in json.loads((out / f"coco/annotations/instances_{split}.json").read_text())["images"]
        }
        for split in ("train", "test")
    }
    whole = {(truth.name, number) for truth in release.runs for number in range(1, len(truth.pictures) + 1)}
    assert parts["train"] | parts["test"] == whole
    assert not parts["train"] & parts["test"]
    assert abs(len(parts["train"]) - len(parts["test"])) <= 1
    table = pd.read_parquet(out / "parquet/images.parquet")
    assert {split: {*zip(part["run"], part["img"], strict=True)} for split, part in table.groupby("split")} == parts
    for split, images in parts.items():
        rows = pd.read_parquet([*(out / "huggingface/images").glob(f"{split}-*")])
        assert {*zip(rows["run"], rows["img"], strict=True)} == images
        names = [name for path in (out / "webdataset").glob(f"symolo-{split}-*.tar") for name in tar_names(path)]
        assert {name.rpartition(".")[0] for name in names if name.endswith(".jpg")} == {
            f"{run}/{number:06d}" for run, number in images
        }
    refused = symolo("export", release.root, "--format", "lerobot", "--splits", rule, "--out", tmp_path / "lerobot")
    assert refused.code == 2
    assert "splits by image: a split of lerobot is a range of whole runs; divide by run" in refused.err


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        ("{by: run}", "--splits: splits.by: 2 groups are too few for 3 splits: the groups are CCW/test_1, CW/test_1"),
        ("{by: runs}", "--splits: splits.by: got 'runs', allowed: one of run, route, look"),
        ("{by: run, shares: {train: 0.5, test: 0.6}}", "got 'train 0.5, test 0.6: in all 1.1', allowed: shares whose"),
        ("{runs: {train: [CW/*]}}", "splits.runs: CCW/test_1 is in no split; add"),
        ("nothing.yaml", "--splits: got 'nothing.yaml', allowed: a YAML file, a text such as '{by: run}', or none"),
    ],
)
def test_a_wrong_rule_is_refused_before_the_work(rule, message, random_release, symolo, tmp_path):
    ended = symolo("export", random_release(1).root, "--format", "tum", "--splits", rule, "--out", tmp_path / "out")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert message in ended.err
    assert not (tmp_path / "out").exists()


@pytest.fixture
def with_splits(random_release, copy_of, sign):
    """A release whose metadata has splits."""
    root = copy_of(random_release(1).root)
    metadata = json.loads((root / "metadata.json").read_text())
    metadata["splits"] = {"by": "run", "seed": 1, "runs": {"train": [TRAIN], "test": [TEST]}}
    (root / "metadata.json").write_text(json.dumps(metadata))
    sign(root)
    return root


def test_an_export_takes_the_splits_of_the_release_by_default(with_splits, symolo, tmp_path):
    def shards(*options):
        out = tmp_path / f"out{len([*tmp_path.iterdir()])}"
        ended = symolo("export", with_splits, "--format", "webdataset", "--out", out, *options)
        assert ended.code == 0, ended.err
        return sorted(path.name for path in (out / "webdataset").iterdir())

    assert shards() == ["symolo-test-000000.tar", "symolo-train-000000.tar"]
    assert shards("--splits", "none") == ["symolo-000000.tar"]
    assert shards("--splits", "{runs: {validation: ['*']}}") == ["symolo-validation-000000.tar"]
    empty = symolo("export", with_splits, "--format", "tum", "--runs", "CW/*", "--out", tmp_path / "empty")
    assert empty.code == 2
    assert "split train has no runs among those that are exported; choose more runs with --runs" in empty.err


def test_an_export_of_a_split_whose_runs_all_failed_names_them(with_splits, sign, symolo, tmp_path):
    path = with_splits / "metadata.json"
    metadata = json.loads(path.read_text())
    metadata["splits"]["runs"] = {"train": [TRAIN, TEST], "validation": []}
    metadata["failed_runs"] = [{"run": "CW/test_7", "stage": "simulate", "problem": "touched O1 at 3.00 s"}]
    path.write_text(json.dumps(metadata))
    sign(with_splits)
    ended = symolo("export", with_splits, "--format", "coco", "--out", tmp_path / "out")
    assert ended.code == 2
    assert "split validation is empty: CW/test_7 failed when the dataset was made; choose other splits" in ended.err


def test_a_publication_of_a_dataset_with_an_empty_split_gets_a_warning(with_splits, sign, symolo, tmp_path):
    path = with_splits / "metadata.json"
    metadata = json.loads(path.read_text())
    metadata["splits"]["runs"] = {"train": [TRAIN, TEST], "validation": []}
    path.write_text(json.dumps(metadata))
    sign(with_splits)
    about = tmp_path / "about.yaml"
    about.write_text('title: T\nauthors: [{family: F}]\npublished: "2026-11-22"\npublisher: Zenodo\n')
    ended = symolo("pack", with_splits, "--about", about, "--out", tmp_path / "out", "--dry-run")
    assert ended.code == 0, ended.err
    assert ended.err.count("warning: the split ") == 1
    assert "warning: the split validation is empty, because its runs failed or were left out" in ended.err


def test_the_reader_gives_the_runs_and_images_of_a_split(with_splits, random_release):
    data = library.load(with_splits)
    assert [run.name for run in data.split("train")] == [TRAIN]
    assert {image.run.name for image in data.split_images("test")} == {TEST}
    assert np.all(data.split("test").rows["run"] == TEST)
    with pytest.raises(InputError, match="has no split tests; allowed: train, test; did you mean test"):
        data.split("tests")
    with pytest.raises(InputError, match="is not divided into splits; set `splits` in its scenario"):
        library.load(random_release(1).root).split("train")


def test_metadata_whose_splits_do_not_fit_the_runs_are_damaged(with_splits):
    path = with_splits / "metadata.json"
    for change, message in (
        ({"train": ["CW/test_9"], "test": [TEST]}, "there is no run CW/test_9"),
        ({"train": [TEST], "test": [TEST]}, f"{TEST} is in several splits"),
    ):
        metadata = json.loads(path.read_text())
        path.write_text(json.dumps(metadata | {"splits": metadata["splits"] | {"runs": change}}))
        with pytest.raises(InputError, match=message):
            library.load(with_splits)
