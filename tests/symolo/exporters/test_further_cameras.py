"""COCO, YOLO and WebDataset of a release with further cameras, by each format's own reader or rules."""

import json
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml
from pycocotools.coco import COCO
from webdataset import tariterators

import symolo
from symolo.core.geometry.poses import as_rows
from symolo.core.progress import LineReport
from symolo.dataset.annotations import (
    ENCODINGS,
    FORMAT,
    AnnotationDocument,
    AnnotationEntry,
    CategoryEntry,
    ImageEntry,
    InstanceEntry,
)
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST, manifest, released_hashes, tag_manifest
from symolo.dataset.splits import SplitRule
from symolo.exporters.base import ExportSettings
from symolo.exporters.export import export, exporters_of, open_release, plan
from symolo.exporters.shared.splits import divided
from symolo.reader.run_folder import RunFolder

RUN = "CW/test_1"
ANNOTATED = ("", "cameras/left/", "cameras/right/")
"""Folders of the cameras with annotations within the run; `rear` has none."""
INSTANCES = {1: ("floor", 1), 2: ("A1", 3), 3: ("O1", 4)}
"""Name and category by id."""
KINDS = {2: "wall", 3: "obstacle"}


def annotate(camera: RunFolder, seed: int) -> None:
    """Write instances that are rectangles over each other, and the boxes around what is seen of them."""
    rng, folder, boxes = np.random.default_rng(seed), camera.folder / "annotations", []
    (folder / "instance").mkdir(parents=True)
    for number in camera.numbers:
        ids = np.ones((24, 32), np.uint16)
        for one in (2, 3):
            (top, bottom), (left, right) = (np.sort(rng.choice(size, 2, replace=False)) for size in ids.shape)
            ids[top:bottom, left:right] = one
        cv2.imwrite(str(folder / f"instance/{number:06d}.png"), ids)
        for one in np.unique(ids[ids > 1]).tolist():
            rows, columns = np.nonzero(ids == one)
            box = tuple(int(n) for n in (columns.min(), rows.min(), np.ptp(columns) + 1, np.ptp(rows) + 1))
            boxes.append(AnnotationEntry(10 * number + one, number, INSTANCES[one][1], one, bbox=box, area=len(rows)))
    images = [
        ImageEntry(one.number, f"images/{one.path.name}", 32, 24, one.t_s, as_rows(one.X_WC)) for one in camera.images
    ]
    names = ("sky", "floor", "line", "wall", "obstacle", "room", "robot")
    kinds = ("instance", "boxes_2d")
    document = AnnotationDocument(
        format=FORMAT,
        kinds=kinds,
        encodings={kind: ENCODINGS[kind] for kind in kinds},
        camera=camera.camera.intrinsics,
        categories=tuple(CategoryEntry(i, name) for i, name in enumerate(names)),
        instances=tuple(InstanceEntry(i, name, kind, moves=False) for i, (name, kind) in INSTANCES.items()),
        key_points=(),
        images=tuple(images),
        annotations=tuple(boxes),
        sightings=(),
    )
    (folder / "annotations.json").write_bytes(document.to_json())


@pytest.fixture(scope="module")
def release(sensing_release, tmp_path_factory) -> Path:
    root = tmp_path_factory.mktemp("annotated") / "data"
    shutil.copytree(sensing_release, root, ignore=shutil.ignore_patterns(".stages"))
    run = symolo.load(root)[RUN]
    for seed, camera in enumerate((run, run.cameras["left"], run.cameras["right"])):
        annotate(camera, seed)
    hashes = released_hashes(root)
    (root / MANIFEST).write_bytes(manifest(hashes))
    (root / TAG_MANIFEST).write_bytes(tag_manifest(hashes))
    return root


@pytest.fixture(scope="module")
def out(release, exported, tmp_path_factory) -> Path:
    return exported(release, tmp_path_factory.mktemp("exported") / "out", "coco", "yolo", "webdataset")


def ids_of(release: Path, camera: str, number: int) -> np.ndarray:
    return cv2.imread(str(release / RUN / camera / f"annotations/instance/{number:06d}.png"), cv2.IMREAD_UNCHANGED)


def test_ids_of_coco_are_unique_over_the_files_of_all_cameras(out):
    files = [COCO(path) for path in (out / "coco/annotations").rglob("*.json")]
    assert len(files) == len(ANNOTATED)
    for entries in ([list(file.imgs) for file in files], [list(file.anns) for file in files]):
        ids = [number for of_file in entries for number in of_file]
        assert min(ids) >= 1
        assert len(set(ids)) == len(ids) > len(files)


def test_coco_has_the_masks_of_each_annotated_camera(release, out):
    files = {path.relative_to(out / "coco/annotations").as_posix() for path in (out / "coco").rglob("*.json")}
    assert files == {f"{camera}instances.json" for camera in ANNOTATED}
    names = set()
    for camera in ANNOTATED:
        coco = COCO(out / f"coco/annotations/{camera}instances.json")
        images = sorted((release / RUN / camera / "images").iterdir())
        assert [image["img"] for image in coco.imgs.values()] == [int(path.stem) for path in images]
        for image, source in zip(coco.imgs.values(), images, strict=True):
            assert (image["run"], image.get("camera")) == (RUN, camera.split("/")[1] if camera else None)
            assert (out / "coco/images" / image["file_name"]).read_bytes() == source.read_bytes()
            ids = ids_of(release, camera, image["img"])
            annotations = coco.loadAnns(coco.getAnnIds(image["id"]))
            assert {one["instance_id"] for one in annotations} == {*np.unique(ids).tolist()}
            for one in annotations:
                np.testing.assert_array_equal(coco.annToMask(one), ids == one["instance_id"])
        names |= {image["file_name"] for image in coco.imgs.values()}
    assert len(names) == sum(len(list((release / RUN / camera / "images").iterdir())) for camera in ANNOTATED)


def test_yolo_has_a_dataset_for_each_annotated_camera(release, out):
    assert {path.parent.relative_to(out / "yolo").as_posix() for path in (out / "yolo").rglob("data.yaml")} == {
        ".",
        "cameras/left",
        "cameras/right",
    }
    for camera in ANNOTATED:
        root = out / "yolo" / camera
        description = yaml.safe_load((root / "data.yaml").read_text())
        stored = sorted((root / description["train"]).rglob("*.jpg"))
        images = sorted((release / RUN / camera / "images").iterdir())
        assert [path.read_bytes() for path in stored] == [path.read_bytes() for path in images]
        for path, source in zip(stored, images, strict=True):
            # The label file of an image has its path with the last folder `images` replaced by `labels`.
            head, _, tail = path.as_posix().rpartition("/images/")
            lines = Path(f"{head}/labels/{tail}").with_suffix(".txt").read_text().splitlines()
            ids = ids_of(release, camera, int(source.stem))
            seen = [one for one in (2, 3) if np.any(ids == one)]
            assert [description["names"][int(line.split()[0])] for line in lines] == [KINDS[one] for one in seen]
            for line, one in zip(lines, seen, strict=True):
                x, y, width, height = (float(number) for number in line.split()[1:])
                rows, columns = np.nonzero(ids == one)
                borders = columns.min() / 32, rows.min() / 24, (columns.max() + 1) / 32, (rows.max() + 1) / 24
                assert (x - width / 2, y - height / 2) == pytest.approx(borders[:2], abs=1e-6)
                assert (x + width / 2, y + height / 2) == pytest.approx(borders[2:], abs=1e-6)


def read_shard(path: Path) -> list[dict]:
    """By the stages of `webdataset.WebDataset`, which itself leaves the file open."""
    with path.open("rb") as stream:
        files = tariterators.tar_file_expander(
            [{"url": str(path), "stream": stream}], handler=tariterators.reraise_exception
        )
        return list(tariterators.group_by_keys(files))


def test_webdataset_has_shards_of_each_camera_with_keys_of_their_own(release, out):
    run, keys = symolo.load(release)[RUN], []
    for name, camera in {"": run, **run.cameras}.items():
        folder = out / "webdataset" / (f"cameras/{name}" if name else "")
        samples = [sample for path in sorted(folder.glob("*.tar")) for sample in read_shard(path)]
        assert len(samples) == len(camera.images)
        for sample, image in zip(samples, camera.images, strict=True):
            row = json.loads(sample["json"])
            assert (row["run"], row.get("camera", "")) == (RUN, name)
            assert (row["t"], row["X_WC"]) == (round(1000 * image.t_s), image.X_WC.tolist())
            assert sample["jpg"] == image.path.read_bytes()
            assert ("instance.png" in sample) == (name != "rear")
        keys += [sample["__key__"] for sample in samples]
    assert len({*keys}) == len(keys)
    labels = json.loads((out / "webdataset/labels.json").read_text())["runs"][RUN]
    assert {"", *labels["encodings_of_cameras"]} == {"", "left", "right"}
    assert labels["encodings_of_cameras"]["left"].keys() == labels["encodings"].keys() == {"instance"}


def test_with_splits_of_images_those_of_one_instant_are_in_one_split(release, tmp_path):
    rule = SplitRule("image", {"train": 0.5, "test": 0.5}, {}, 1)
    data = divided(open_release(release, None), rule)
    export(data, plan(data, exporters_of(("coco",), ""), ExportSettings(1)), tmp_path / "out", LineReport())
    times: dict[str, dict[str, set[float]]] = {}
    for path in (tmp_path / "out/coco/annotations").rglob("*.json"):
        split, images = path.stem.removeprefix("instances_"), json.loads(path.read_text())["images"]
        camera = path.parent.name.replace("annotations", "data.csv")
        times.setdefault(camera, {})[split] = {image["t_s"] for image in images}
    assert times.keys() == {"data.csv", "left", "right"}
    assert all(len(splits) == 2 for splits in times.values())
    for split, at_s in times["data.csv"].items():
        other = "test" if split == "train" else "train"
        for camera in ("left", "right"):
            assert at_s <= times[camera][split]
            assert not at_s & times[camera][other]
