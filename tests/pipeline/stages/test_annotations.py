"""Annotations in a release: asked for later they leave the images alone, and what is wrong with them is found."""

import json
import re
import shutil
import struct
import subprocess
import sys
import tarfile
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest

from symolo.verification.verify import verify
from tests.release_fixtures import ONE_ROUTE

RUN = "CW/test_1"
OWN = f"{RUN}/annotations"
KINDS = ("depth", "instance", "semantic", "normals", "flow", "free_floor", "boxes_2d", "boxes_3d", "key_points")
ASKED = f"--set=render.annotations=[{','.join(KINDS)}]"


def times(root, pattern):
    return {path: path.stat().st_mtime_ns for path in root.rglob(pattern)}


@pytest.fixture(scope="module")
def annotated(dataset, tiny, tmp_path_factory) -> Path:
    """The dataset, then asked for with annotations; read only."""
    from pipeline.cli import main  # noqa: PLC0415 - as the user does

    out = Path(shutil.copytree(dataset, tmp_path_factory.mktemp("annotated") / "data"))
    before = times(out / ".stages", "*.jpg")
    assert main(["release", "smoke", "--out", str(out), *tiny, ASKED, "--workers", "1"]) == 0
    assert times(out / ".stages", "*.jpg") == before, "no image is rendered again"
    return out


def test_images_and_tables_stay_the_same_bytes(annotated, dataset, release_of):
    with_them, without = release_of(annotated), release_of(dataset)
    told_elsewhere = {"README.md", "metadata.json", "bag-info.txt", "manifest-sha256.txt", "tagmanifest-sha256.txt"}
    changed = {name for name in without if with_them.get(name) != without[name]}
    assert {name for name in changed if not name.endswith("side/spec.json")} == told_elsewhere
    added = {name.split("/")[3] for name in with_them.keys() - without.keys()}
    assert added == {"annotations.json", "depth", "instance", "semantic", "normals", "flow", "free_floor"}


def test_every_image_has_its_annotations_and_the_dataset_no_fault(annotated):
    names = [f"{number:06d}.png" for number in range(1, 7)]
    for kind in KINDS[:6]:
        there = sorted(path.name for path in (annotated / OWN / kind).iterdir())
        assert there == (names[:-1] if kind == "flow" else names)
    document = json.loads((annotated / OWN / "annotations.json").read_text())
    assert [(annotated / RUN / image["file_name"]).is_file() for image in document["images"]] == [True] * 6
    assert {one["image_id"] for one in document["annotations"]} <= set(range(1, 7))
    assert "annotations/" in (annotated / "README.md").read_text()
    assert list(verify(annotated)) == []


def test_camera_poses_are_those_of_the_side_file(annotated):
    table = np.genfromtxt(annotated / RUN / "side/camera.csv", delimiter=",", skip_header=1)
    document = json.loads((annotated / OWN / "annotations.json").read_text())
    X_WC = np.array([image["X_WC"] for image in document["images"]])
    np.testing.assert_allclose(X_WC[:, :3, :3].reshape(-1, 9), table[:, 2:11], atol=1e-9)
    np.testing.assert_allclose(X_WC[:, :3, 3], table[:, 11:14], atol=1e-6)


def test_a_second_release_touches_nothing_and_one_without_takes_them_back(
    annotated, dataset, copy_of, symolo, tiny, release_of
):
    out = copy_of(annotated, stages=True)
    before = times(out, "*.*")
    assert symolo("release", "smoke", "--out", out, *tiny, ASKED).code == 0
    assert times(out, "*.*") == before
    (out / OWN / "depth/000002.png").write_bytes(b"damaged")
    assert symolo("release", "smoke", "--out", out, *tiny, ASKED).code == 0
    assert release_of(out) == release_of(annotated)
    assert symolo("release", "smoke", "--out", out, *tiny, "--replace").code == 0
    assert release_of(out) == release_of(dataset)


def test_kinds_that_the_list_no_longer_names_are_removed_and_no_image_is_rendered_again(
    annotated, copy_of, symolo, tiny, tmp_path
):
    """The export to COCO then says which kind to add; `annotated` shows that this leaves the images alone, too."""
    out = copy_of(annotated, stages=True)
    rendered = times(out / ".stages/render/CW", "*.jpg")
    assert rendered
    less = (*tiny, f"--set={ONE_ROUTE}", "--set=render.annotations=[depth]")
    assert symolo("release", "smoke", "--out", out, *less, "--replace", "--workers", 1).code == 0
    assert {path.name for path in (out / OWN).iterdir()} == {"annotations.json", "depth"}
    assert times(out / ".stages/render/CW", "*.jpg") == rendered
    refused = symolo("export", out, "--format", "coco", "--out", tmp_path / "out")
    assert refused.code == 2
    assert "add `instance` to render.annotations and repeat `symolo release` with the same --out" in refused.err


def test_the_examples_of_the_page_read_them(annotated, monkeypatch, capsys):
    """On the counter-clockwise route, whose first image sees an obstacle."""
    page = (Path(__file__).parents[3] / "docs/annotations.md").read_text()
    program, projection = re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    program += "print('floor', float(np.abs(p_W[read('semantic') == categories['floor'], 2]).max()), line.any())\n"
    call = [sys.executable, "-c", program]
    done = subprocess.run(call, cwd=annotated / "CCW/test_1", capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert re.search(r"^O2 \[\d+, \d+, \d+, \d+\] (0\.\d|1\.0)", done.stdout, re.MULTILINE)
    assert (floor := re.search(r"^floor (\S+) (\S+)$", done.stdout, re.MULTILINE))
    assert (float(floor[1]) < 1e-3, floor[2]) == (True, "True")
    monkeypatch.chdir(annotated.parent)
    exec(projection.replace('"labelled"', f'"{annotated.name}"'), {})  # noqa: S102 - our own page
    projected = re.findall(
        r"^line_\S+ (?:True|False) \((\S+), (\S+)\) \[ *(\S+) +(\S+)\]", capsys.readouterr().out, re.MULTILINE
    )
    pixels = np.array(projected, dtype=float)
    assert len(pixels) > 3
    np.testing.assert_allclose(pixels[:, :2], pixels[:, 2:], atol=1e-3)


def test_an_export_has_the_boxes_of_what_is_seen_and_every_image(annotated, tmp_path, symolo):
    out = tmp_path / "out"
    assert symolo("export", annotated, "--format", "coco,webdataset", "--out", out).code == 0
    coco = json.loads((out / "coco/annotations/instances.json").read_text())
    images = {image["id"]: (image["run"], image["img"]) for image in coco["images"]}
    solid = [one for one in coco["annotations"] if one["category_id"] in {3, 4}]
    exported = {(*images[one["image_id"]], one["instance_id"]): [one["bbox"], one["area"]] for one in solid}
    expected = {}
    for run in ("CW/test_1", "CCW/test_1"):
        document = json.loads((annotated / run / "annotations/annotations.json").read_text())
        seen = [one for one in document["annotations"] if one["area"]]
        expected |= {(run, one["image_id"], one["instance_id"]): [one["bbox"], one["area"]] for one in seen}
    assert exported == expected
    assert exported
    with tarfile.open(out / "webdataset/symolo-000000.tar") as shard:
        names = shard.getnames()
    pictures = {f"{path.stem}.{path.parent.name}.png" for path in (annotated / OWN).glob("*/*.png")}
    assert {name.rpartition("/")[2] for name in names if name.startswith(RUN) and name.endswith(".png")} == pictures


def replaced(name, pixels):
    return lambda root: cv2.imwrite(str(root / OWN / name), pixels)


def document(change):
    def damage(root):
        path = root / OWN / "annotations.json"
        content = json.loads(path.read_text())
        change(content)
        path.write_text(json.dumps(content))

    return damage


def _png_head(width: int, height: int) -> bytes:
    """The signature and first chunks of a PNG (ISO/IEC 15948) of 16 bit grey."""
    found = b"\x89PNG\r\n\x1a\n"
    for name, data in (
        (b"IHDR", struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0)),
        (b"IDAT", zlib.compress(b"")),
    ):
        found += struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    return found


SIZE = (24, 32)
DAMAGE = {
    "missing": (lambda root: (root / OWN / "depth/000003.png").unlink(), "depth/000003.png", "is missing"),
    "added": (replaced("flow/000006.png", np.zeros((*SIZE, 3), np.uint16)), "flow/000006.png", "is none of"),
    "cut": (
        lambda root: (root / OWN / "flow/000001.png").write_bytes(b""),
        "flow/000001.png",
        "is no image of 32 x 24 px",
    ),
    "a size that nobody can hold": (
        lambda root: (root / OWN / "depth/000001.png").write_bytes(_png_head(200_000, 200_000)),
        "depth/000001.png",
        "is no image of 32 x 24 px",
    ),
    "8 bit": (replaced("depth/000001.png", np.zeros(SIZE, np.uint8)), "depth/000001.png", "is uint8"),
    "size": (
        replaced("semantic/000001.png", np.zeros((9, 9), np.uint8)),
        "semantic/000001.png",
        "is no image of 32 x 24 px",
    ),
    "id": (replaced("instance/000001.png", np.full(SIZE, 999, np.uint16)), "instance/000001.png", "has the id 999"),
    "no JSON": (lambda root: (root / OWN / "annotations.json").write_text("{"), "annotations.json", "cannot be read"),
    "image": (document(lambda d: d["images"].pop()), "annotations.json", "images are not those of data.csv"),
    "instance": (
        document(lambda d: d["annotations"].append({"id": 1, "image_id": 1, "category_id": 3, "instance_id": 999})),
        "annotations.json",
        "an instance that is not there",
    ),
    "kinds": (document(lambda d: d["kinds"].remove("flow")), "annotations.json", "is of depth, .* names"),
    "encoding": (document(lambda d: d["encodings"].update(depth="m")), "annotations.json", "encodings are not"),
    "category": (
        document(lambda d: d["categories"][2].update(name="tape")),
        "annotations.json",
        "categories are not sky, floor, line",
    ),
    "camera": (document(lambda d: d["camera"].update(fx_px=1.0)), "annotations.json", "camera is not that of spec"),
    "pose": (
        document(lambda d: d["images"][1]["X_WC"][0].__setitem__(3, 9.0)),
        "annotations.json",
        "X_WC of image 2 is not that of data.csv",
    ),
    "size of an image": (document(lambda d: d["images"][0].update(width=9)), "annotations.json", "of another size"),
    "category of a pixel": (
        replaced("semantic/000001.png", np.full(SIZE, 2, np.uint8)),
        "semantic/000001.png",
        r"differs in \d+ pixels",
    ),
    "format": (
        document(lambda d: d.update(format=1)),
        "annotations.json",
        r"has format 1, expected \d",
    ),
    "an id beyond 16 bits": (
        document(lambda d: d["instances"].append({"id": 2**70, "name": "x", "category_id": 1, "moves": False})),
        "annotations.json",
        "ids of instances are not different numbers from 1 to 65535",
    ),
    "an id twice": (
        document(lambda d: d["instances"].append(d["instances"][0])),
        "annotations.json",
        "ids of instances are not different",
    ),
    "a category of no integer's size": (
        document(lambda d: d["instances"][0].update(category_id=2**70)),
        "annotations.json",
        "of a category that is not there",
    ),
    "category of a thing": (
        document(
            lambda d: d["annotations"].append(
                {"id": 1, "image_id": 1, "category_id": 99, "instance_id": d["instances"][0]["id"]}
            )
        ),
        "annotations.json",
        "is not of its instance's category",
    ),
    "file of an image": (
        document(lambda d: d["images"][1].update(file_name="images/frame_000001.jpg")),
        "annotations.json",
        "file of image 2 is not that of data.csv",
    ),
    "a kind twice": (document(lambda d: d["kinds"].append("depth")), "annotations.json", "is of depth, .* names"),
    "key point": (document(lambda d: d["key_points"].clear()), "annotations.json", "a key point that is not there"),
}


@pytest.mark.parametrize("kind", DAMAGE)
def test_damage_is_found_by_content(kind, annotated, copy_of, sign):
    damage, name, what = DAMAGE[kind]
    root = copy_of(annotated)
    damage(root)
    sign(root)
    findings = [str(finding) for finding in verify(root)]
    assert any(text.startswith(f"{OWN}/{name}: ") and re.search(what, text) for text in findings), findings
