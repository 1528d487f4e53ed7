"""Polygons of masks, beside the rasteriser of pycocotools and a parser of the published format.

https://docs.ultralytics.com/datasets/segment: class, then x and y of each vertex as shares of the size of the image.
"""

import numpy as np
import pytest
import yaml
from pycocotools import mask as coco_masks

from symolo.exporters.shared.polygons import polygon_of

U = np.array([[1, 0, 1], [1, 0, 1], [1, 1, 1]], dtype=bool)


def rasterised(polygon, height, width):
    encoded = coco_masks.frPyObjects([polygon.ravel().tolist()], height, width)
    return coco_masks.decode(encoded)[..., 0].astype(bool)


def blobs(seed):
    """A mask of smooth parts with holes, some of them at the border."""
    rng = np.random.default_rng(seed)
    rows, columns = np.mgrid[:40, :60]
    waves = [np.sin(a * rows + b * columns + c) for a, b, c in rng.uniform(-0.6, 0.6, (6, 3)) * (1, 1, 10)]
    return np.sum(waves, axis=0) > rng.uniform(-1, 1)


@pytest.mark.parametrize(
    "mask",
    [
        *(blobs(seed) for seed in range(8)),
        np.ones((4, 5), dtype=bool),
        np.eye(3, dtype=bool),
        np.pad(~np.pad(np.ones((2, 2), dtype=bool), 1), 1, constant_values=True),
        U,
    ],
)
def test_the_pixels_within_the_polygon_are_those_of_the_mask(mask):
    polygon = polygon_of(mask)
    np.testing.assert_array_equal(rasterised(polygon, *mask.shape), mask)
    assert np.all((polygon >= 0) & (polygon <= mask.shape[::-1]))


def test_a_rectangle_has_eight_vertices_which_cut_off_its_corners():
    polygon = polygon_of(np.pad(np.ones((3, 4), dtype=bool), 1))
    assert {tuple(vertex) for vertex in polygon.tolist()} == {
        *((1.5, 1.0), (4.5, 1.0), (5.0, 1.5), (5.0, 3.5)),
        *((4.5, 4.0), (1.5, 4.0), (1.0, 3.5), (1.0, 1.5)),
    }


def test_labels_for_segmentation_have_a_polygon_of_each_visible_instance(random_release, symolo, tmp_path):
    release = random_release(3, annotated=True)
    ended = symolo("export", release.root, "--format", "yolo", "--polygons", "--out", tmp_path / "out")
    assert ended.code == 0, ended.err
    names = yaml.safe_load((tmp_path / "out/yolo/data.yaml").read_text())["names"]
    assert names == {0: "wall", 1: "obstacle", 2: "line"}
    kinds = {2: "line", 3: "wall", 4: "obstacle", 5: "wall"}
    compared = 0
    for truth in release.runs:
        for number, ids in enumerate(truth.instances, 1):
            file = tmp_path / f"out/yolo/labels/train/{truth.name.replace('/', '-')}-{number:06d}.txt"
            lines = [line.split() for line in file.read_text().splitlines()]
            seen = [one for one in kinds if np.any(ids == one)]
            assert [names[int(line[0])] for line in lines] == [kinds[one] for one in seen]
            for line, one in zip(lines, seen, strict=True):
                height, width = ids.shape
                polygon = np.array(line[1:], dtype=float).reshape(-1, 2) * (width, height)
                got = rasterised(polygon, height, width)
                assert np.sum(got & (ids == one)) / np.sum(got | (ids == one)) > 0.99
                compared += 1
    assert compared


def test_masks_are_needed(random_release, symolo, tmp_path):
    root = random_release(1, kinds=("boxes_2d",)).root
    refused = symolo("export", root, "--format", "yolo", "--polygons", "--out", tmp_path / "out")
    assert refused.code == 2
    assert "CW/test_1 has no annotations of the kind `instance`, which give the polygons; add `instance`" in refused.err
    refused = symolo("export", root, "--format", "tum", "--polygons", "--out", tmp_path / "out")
    assert (refused.code, "--polygons: got 'tum', allowed: --format yolo" in refused.err) == (2, True)
