"""Small releases of random numbers and noise, and what is in them, for whatever reads or exports a release."""

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import pytest

from configs.draw import draw_all
from configs.loader import load_scenario
from symolo.core.files.file_hashes import canonical_json
from symolo.core.geometry.pinhole import intrinsics
from symolo.core.progress import LineReport
from symolo.dataset.annotations import ENCODINGS
from symolo.dataset.documents.camera_model import CameraDocument
from symolo.dataset.documents.metadata import RunRecord, describe
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST, manifest, released_hashes, tag_manifest
from symolo.dataset.tables.rows import COLUMNS, STATES, Rows
from symolo.dataset.tables.side_tables import CAMERA, TOF, WHEELS, image_positions
from symolo.exporters.base import ExportSettings
from symolo.exporters.export import export, exporters_of, open_release, plan

SEEDS = [pytest.param(seed, marks=[pytest.mark.faults] if seed > 2 else []) for seed in range(1, 101)]
"""Of releases that every format is held against; two of them by default."""
SHARD_BYTES = 40_000
WIDTH, HEIGHT = 40, 24
SETTINGS = [f"render.width_px={WIDTH}", f"render.height_px={HEIGHT}"]
KINDS = ("depth", "instance", "semantic", "normals", "flow", "free_floor", "boxes_2d", "key_points")
CATEGORIES = ("sky", "floor", "line", "wall", "obstacle", "room", "robot")
INSTANCES = {1: ("floor", 1), 2: ("line_0", 2), 3: ("A1", 3), 4: ("O1", 4), 5: ("A10", 3)}
"""Name and category by id."""


@dataclass(frozen=True)
class Truth:
    """What was put into a run."""

    name: str
    table: np.ndarray
    """(N, 19), the columns of data.csv to their digits."""
    wheels: np.ndarray
    tof: np.ndarray
    """(N, 4), the columns of tof.csv."""
    X_WC: np.ndarray
    """(M, 4, 4)."""
    pictures: tuple[bytes, ...]
    instances: np.ndarray
    """(M, H, W), ids; none where there are no annotations."""
    passes: dict[str, list[np.ndarray]]
    """Other annotations by kind, as stored, channels red, green, blue; of the last image there is no flow."""
    sightings: dict[tuple[int, int], dict[int, tuple[float, float, bool]]]
    """By image and instance: u, v and visible by corner."""
    K: np.ndarray


@dataclass(frozen=True)
class Random:
    root: Path
    runs: tuple[Truth, ...]


@pytest.fixture(params=SEEDS)
def seed(request: pytest.FixtureRequest) -> int:
    return request.param


@pytest.fixture(scope="session")
def exported() -> Callable[..., Path]:
    """Makes an export of a release."""

    def make(root: Path, out: Path, *formats: str, shard_bytes: int = SHARD_BYTES) -> Path:
        data = open_release(root, None)
        export(data, plan(data, exporters_of(formats, ""), ExportSettings(shard_bytes)), out, LineReport())
        return out

    return make


@pytest.fixture(scope="session")
def random_release(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Random]:
    """Makes the release of a seed, without annotations, with those of the seed or with some kinds; read only."""
    made: dict[tuple[int, tuple[str, ...]], Random] = {}

    def make(seed: int = 1, *, annotated: bool = False, kinds: tuple[str, ...] = ()) -> Random:
        release = seed, _kinds(seed) if annotated else kinds
        if release not in made:
            made[release] = _release(tmp_path_factory.mktemp("random") / "data", *release)
        return made[release]

    return make


def _kinds(seed: int) -> tuple[str, ...]:
    """Every other release has to do without images of categories."""
    return tuple(kind for kind in KINDS if seed % 2 == 0 or kind != "semantic")


@cache
def _scenario(kinds: tuple[str, ...]):
    asked = [f"render.annotations=[{','.join(kinds)}]"] if kinds else []
    loaded = load_scenario("smoke", [*SETTINGS, *asked])
    return loaded.tree, draw_all(loaded)


def _release(root: Path, seed: int, kinds: tuple[str, ...]) -> Random:
    rng = np.random.default_rng(seed)
    tree, specs = _scenario(kinds)
    truths = tuple(_run(root / spec.key, spec, rng) for spec in specs)
    rows = [Rows.from_table(truth.table) for truth in truths]
    records = [RunRecord.from_specification(spec, of_run, None) for spec, of_run in zip(specs, rows, strict=True)]
    (root / "metadata.json").write_bytes(describe(tree, specs, records, ()).to_json())
    (root / "README.md").write_text("noise\n")
    (root / "bag-info.txt").write_text("External-Identifier: noise\n")
    hashes = released_hashes(root)
    (root / MANIFEST).write_bytes(manifest(hashes))
    (root / TAG_MANIFEST).write_bytes(tag_manifest(hashes))
    return Random(root, truths)


def _run(folder: Path, spec, rng: np.random.Generator) -> Truth:
    count = int(rng.integers(5, 12))
    table = np.zeros((count, 19))
    table[:, 0] = np.concatenate([[0], np.cumsum(rng.integers(1, 90, count - 1))])
    table[:, 1:3] = rng.uniform(-30, 30, (count, 2))
    table[:, 3] = rng.uniform(-np.pi, np.pi, count)
    table[:, 4] = rng.choice(STATES, count)
    table[:, 5:18] = rng.uniform(0, 1, (count, 13))
    taken = np.sort(rng.choice(count, int(rng.integers(2, 5)), replace=False))
    table[taken, 18] = np.arange(1, len(taken) + 1)
    table = np.column_stack([np.round(table[:, i], column.decimals) for i, column in enumerate(COLUMNS)])
    rows = Rows.from_table(table)
    wheels = np.column_stack((table[:, 0], np.round(rng.normal(size=(count, len(WHEELS.columns) - 1)), 5)))
    wheels[:, WHEELS.header.index("counts_r") :][:, :2] = rng.integers(-9999, 9999, (count, 2))
    tof = np.column_stack((table[:, 0], rng.integers(0, 3, (count, 3))))
    X_WC = np.tile(np.eye(4), (len(taken), 1, 1))
    rotations = np.linalg.qr(rng.normal(size=(len(taken), 3, 3)))[0]
    X_WC[:, :3, :3] = np.round(rotations * np.linalg.det(rotations)[:, None, None], 9)
    X_WC[:, :3, 3] = np.round(rng.uniform(-30, 30, (len(taken), 3)), 6)
    numbers = table[taken][:, [18, 0]]
    poses = np.column_stack((X_WC[:, :3, :3].reshape(-1, 9), X_WC[:, :3, 3]))
    camera = np.column_stack((numbers, poses, numbers[:, 1:] - 5, np.full((len(taken), 1), 10.0)))
    noise = rng.integers(0, 255, (len(taken), HEIGHT, WIDTH, 3), dtype=np.uint8)
    pictures = tuple(cv2.imencode(".jpg", pixels)[1].tobytes() for pixels in noise)
    files = {
        "data.csv": rows.to_csv(),
        "image_positions.txt": image_positions(rows),
        "side/wheels.csv": WHEELS.to_csv(wheels),
        "side/tof.csv": TOF.to_csv(tof),
        "side/camera.csv": CAMERA.to_csv(camera),
        "side/intrinsics.json": CameraDocument.from_imaging(spec).to_json(),
        "side/spec.json": canonical_json(spec.model_dump(mode="json")),
    }
    files |= {f"images/{i:06d}.jpg": data for i, data in enumerate(pictures, start=1)}
    instances, passes, sightings = np.zeros((0, HEIGHT, WIDTH), np.uint16), {}, {}
    if spec.render.annotations:
        instances = np.array([_rectangles(rng) for _ in taken])
        passes = _passes(rng, instances, spec.render.annotations)
        sightings = {(i, one): _corners(rng) for i in range(1, len(taken) + 1) for one in (3, 4, 5)}
        document = _document(spec, camera, X_WC, sightings, instances)
        files["annotations/annotations.json"] = json.dumps(document).encode()
        if "instance" in spec.render.annotations:
            files |= {f"annotations/instance/{i:06d}.png": _png(ids) for i, ids in enumerate(instances, start=1)}
        for kind, stored in passes.items():
            files |= {f"annotations/{kind}/{i:06d}.png": _png(one) for i, one in enumerate(stored, start=1)}
    for name, data in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(data)
    K = np.array(CameraDocument.from_imaging(spec).K)
    return Truth(spec.key, table, wheels, tof, X_WC, pictures, instances, passes, sightings, K)


def _png(stored: np.ndarray) -> bytes:
    """OpenCV takes channels in the opposite order."""
    return cv2.imencode(".png", stored if stored.ndim == 2 else stored[..., ::-1])[1].tobytes()


def _passes(rng: np.random.Generator, instances: np.ndarray, kinds) -> dict[str, list[np.ndarray]]:
    """Noise in the forms of docs/annotations.md; about a quarter of the pixels meet nothing."""
    count = len(instances)
    met = rng.random(instances.shape) < 0.75
    shown = met[..., None].astype(np.uint16)
    toward = rng.normal(size=(count, HEIGHT, WIDTH, 3))
    normal = np.rint(32768 + 32767 * toward / np.linalg.norm(toward, axis=-1, keepdims=True)).astype(np.uint16)
    flow = rng.integers(1, 2**16, (count, HEIGHT, WIDTH, 3), dtype=np.uint16)
    flow[..., 2] = 1
    category = np.array([0, *(category for _, category in INSTANCES.values())], dtype=np.uint8)
    made = {
        "depth": list(rng.integers(1, 65_000, met.shape, dtype=np.uint16) * met),
        "semantic": list(category[instances]),
        "normals": list(normal * shown),
        "flow": list(flow * shown)[:-1],
        "free_floor": list(np.where(met, 255, 0).astype(np.uint8)),
    }
    return {kind: made[kind] for kind in kinds if kind in made}


def _rectangles(rng: np.random.Generator) -> np.ndarray:
    """Over each other, so that masks have holes and pieces; the first pixel may be of any."""
    ids = np.zeros((HEIGHT, WIDTH), np.uint16)
    for one in rng.permutation([1, 1, 2, 2, 3, 3, 4, 5]).tolist():
        (top, bottom), (left, right) = (np.sort(rng.integers(0, size + 1, 2)) for size in ids.shape)
        ids[top:bottom, left:right] = one
    return ids


def _corners(rng: np.random.Generator) -> dict[int, tuple[float, float, bool]]:
    return {
        corner: (round(rng.uniform(0, WIDTH - 1), 4), round(rng.uniform(0, HEIGHT - 1), 4), rng.random() < 0.5)
        for corner in range(8)
        if rng.random() < 0.6
    }


def _boxes(instances: np.ndarray):
    """Of what is seen of walls and obstacles, zeros where nothing is; one has the box around all of it, too."""
    for image, ids in enumerate(instances, start=1):
        for one in (3, 4, 5):
            rows, columns = np.nonzero(ids == one)
            box = (
                [int(n) for n in (columns.min(), rows.min(), np.ptp(columns) + 1, np.ptp(rows) + 1)]
                if len(rows)
                else [0] * 4
            )
            whole = {"amodal_bbox": [1, 2, 3, 4], "amodal_area": 12, "visible_fraction": 0.25, "truncated": True}
            fields = {
                "image_id": image,
                "category_id": INSTANCES[one][1],
                "instance_id": one,
                "bbox": box,
                "area": len(rows),
            }
            yield {"id": 100_000 * image + one, **fields, **(whole if (image, one) == (1, 3) else {})}


def _document(spec, camera, X_WC, sightings, instances) -> dict:
    """By docs/annotations.md; the first key point is one of the line, which is nobody's corner."""
    points = [{"id": 1, "name": "line_0_00", "kind": "line", "instance_id": 2, "p": [0.0, 0.0, 0.0]}]
    for one, kind in ((3, "wall"), (4, "obstacle"), (5, "wall")):
        for corner in range(8):
            name = f"{INSTANCES[one][0]}_{corner}"
            points.append(
                {"id": 10 * one + corner, "name": name, "kind": f"{kind}_corner", "instance_id": one, "p": [0.0] * 3}
            )
    seen = [
        {
            "image_id": image,
            "key_point_id": 10 * one + corner,
            "pixel": [u, v],
            "p_C": [0.0, 0.0, 1.0],
            "visible": shown,
        }
        for (image, one), corners in sightings.items()
        for corner, (u, v, shown) in corners.items()
    ]
    seen += [
        {"image_id": 1, "key_point_id": 1, "pixel": [1.0, 2.0], "p_C": [0.0, 0.0, 1.0], "visible": True},
    ]
    sizes = {"width": WIDTH, "height": HEIGHT}
    kinds = spec.render.annotations
    return {
        "format": 2,
        "kinds": list(kinds),
        "encodings": {kind: ENCODINGS[kind] for kind in kinds},
        "camera": asdict(intrinsics(spec.robot.camera, WIDTH, HEIGHT)),
        "categories": [{"id": i, "name": name} for i, name in enumerate(CATEGORIES)],
        "instances": [
            {"id": one, "name": name, "category_id": category, "moves": False}
            for one, (name, category) in INSTANCES.items()
        ],
        "key_points": points if "key_points" in kinds else [],
        "images": [
            {"id": i, "file_name": f"images/{i:06d}.jpg", **sizes, "t_s": row[1] / 1000, "X_WC": X.tolist()}
            for i, (row, X) in enumerate(zip(camera, X_WC, strict=True), start=1)
        ],
        "annotations": list(_boxes(instances)) if "boxes_2d" in kinds else [],
        "sightings": seen if "key_points" in kinds else [],
    }
