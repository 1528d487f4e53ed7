"""By a parser of the published format (https://docs.ultralytics.com/datasets/detect), beside masks and COCO's boxes."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from pycocotools.coco import COCO

ROUNDED = 0.51e-6
"""Numbers have six decimals."""


def read_yolo(file: Path) -> dict[str, dict[str, tuple[bytes, list[tuple[str, np.ndarray]]]]]:
    """Images of each split by file name: content, and class and box (x, y, w, h as shares) of each object.

    The folder of data.yaml is the root if it has no `path`. Images are below the folder of a split, at any depth. The
    label file of an image has its path with the last folder `images` replaced by `labels`, and ends in `.txt`.
    """
    description = yaml.safe_load(file.read_text())
    assert "path" not in description
    assert {"train", "val", "names"} <= description.keys()
    splits = {}
    for split in ("train", "val", "test"):
        folder = file.parent / description[split] if split in description else None
        splits[split] = {}
        for image in sorted(folder.rglob("*.*")) if folder else ():
            head, _, tail = str(image).rpartition("/images/")
            lines = Path(f"{head}/labels/{tail}").with_suffix(".txt").read_text().splitlines()
            objects = []
            for line in lines:
                number, *box = line.split()
                assert len(box) == 4
                objects.append((description["names"][int(number)], np.array(box, dtype=float)))
            splits[split][image.name] = image.read_bytes(), objects
    return splits


def check_box(box, mask):
    """The box touches the outer borders of the outermost pixels, and lies within the image."""
    height, width = mask.shape
    rows, columns = np.nonzero(mask)
    left, top = box[:2] - box[2:] / 2
    right, bottom = box[:2] + box[2:] / 2
    expected = columns.min() / width, rows.min() / height, (columns.max() + 1) / width, (rows.max() + 1) / height
    np.testing.assert_allclose((left, top, right, bottom), expected, rtol=0, atol=2 * ROUNDED)
    assert np.all((box >= 0) & (box <= 1))


def test_yolo_holds_the_boxes_of_visible_walls_and_obstacles(seed, random_release, exported, tmp_path):
    release = random_release(seed, annotated=True)
    splits = read_yolo(exported(release.root, tmp_path / "out", "yolo") / "yolo/data.yaml")
    assert splits["train"].keys() == splits["val"].keys()
    expected = {
        f"{truth.name.replace('/', '-')}-{number:06d}.jpg": (truth.pictures[number - 1], truth.instances[number - 1])
        for truth in release.runs
        for number in range(1, len(truth.pictures) + 1)
    }
    assert splits["train"].keys() == expected.keys()
    for name, (content, ids) in expected.items():
        stored, objects = splits["train"][name]
        assert stored == content
        seen = [(kind, one) for one, kind in ((3, "wall"), (4, "obstacle"), (5, "wall")) if np.any(ids == one)]
        assert [kind for kind, _ in objects] == [kind for kind, _ in seen]
        for (_, box), (_, one) in zip(objects, seen, strict=True):
            check_box(box, ids == one)


def test_each_split_has_its_folder_and_the_boxes_of_coco(random_release, symolo, tmp_path):
    """COCO's box (first column, first row, width, height) becomes a middle and a size, as shares of the image."""
    out = tmp_path / "out"
    rule = "{runs: {train: [CCW/*], validation: [CW/*]}}"
    root = random_release(2, annotated=True).root
    assert symolo("export", root, "--format", "yolo,coco", "--splits", rule, "--out", out).code == 0
    splits = read_yolo(out / "yolo/data.yaml")
    assert not splits["test"]
    for folder, split in (("train", "train"), ("val", "validation")):
        coco = COCO(out / f"coco/annotations/instances_{split}.json")
        assert len(coco.imgs) == len(splits[folder])
        for image in coco.imgs.values():
            name = f"{image['run'].replace('/', '-')}-{image['img']:06d}.jpg"
            size = np.array([image["width"], image["height"]])
            boxes = [
                (coco.cats[one["category_id"]]["name"], np.array(one["bbox"], dtype=float))
                for one in coco.loadAnns(coco.getAnnIds(image["id"]))
            ]
            wanted = [(kind, box) for kind, box in boxes if kind in ("wall", "obstacle")]
            objects = splits[folder][name][1]
            assert [kind for kind, _ in objects] == [kind for kind, _ in wanted]
            for (_, got), (_, box) in zip(objects, wanted, strict=True):
                np.testing.assert_allclose(got[:2] * size, box[:2] + box[2:] / 2, rtol=0, atol=ROUNDED * size.max())
                np.testing.assert_allclose(got[2:] * size, box[2:], rtol=0, atol=ROUNDED * size.max())


@pytest.mark.parametrize(
    ("rule", "train", "val"),
    [
        ("none", "images/train", "images/train"),
        ("{runs: {train: [CW/*], test: [CCW/*]}}", "images/train", "images/test"),
        ("{runs: {validation: [CW/*], test: [CCW/*]}}", "images/val", "images/val"),
    ],
)
def test_both_folders_that_readers_need_are_named_always(rule, train, val, random_release, symolo, tmp_path):
    root = random_release(1, kinds=("boxes_2d",)).root
    assert symolo("export", root, "--format", "yolo", "--splits", rule, "--out", tmp_path / "out").code == 0
    text = (tmp_path / "out/yolo/data.yaml").read_text()
    description = yaml.safe_load(text)
    assert (description["train"], description["val"]) == (train, val)
    assert text.startswith("# ") == (val != "images/val")


def test_boxes_are_needed(random_release, symolo, tmp_path):
    root = random_release(1, kinds=("instance",)).root
    refused = symolo("export", root, "--format", "yolo", "--out", tmp_path / "out")
    assert refused.code == 2
    assert "CW/test_1 has no annotations of the kind `boxes_2d`, which give the boxes; add `boxes_2d`" in refused.err
