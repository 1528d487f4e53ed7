"""Small releases whose runs drive on known curves and whose images are painted, so that every number is known."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
import pytest

from configs.draw import draw_all
from configs.loader import load_scenario
from configs.schema.scenario import RunSpec
from symolo.core.files.file_hashes import canonical_json
from symolo.dataset.documents.metadata import FailedRun, RunRecord, describe
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST, manifest, released_hashes, tag_manifest
from symolo.dataset.tables.rows import Rows

WIDTH, HEIGHT = 48, 32
ROWS, EVERY = 41, 4
"""Rows of a run at 20 Hz, of which every fourth has an image, the first and the last among them."""
STATES = [0] * 20 + [5] * 12 + [0] * 9
SETTINGS = [f"render.width_px={WIDTH}", f"render.height_px={HEIGHT}", "routes.0.runs=2"]


@dataclass
class Wanted:
    """What a release shall be."""

    settings: Sequence[str] = ()
    grey: Callable[[int, int], int] = lambda _, image: 120 + image
    """Of the flat image with that number (from 1) of that run (from 0)."""
    description: str = ""
    licence: str = "CC-BY-4.0"
    warnings: Sequence[str] = ()
    """Of the first run."""
    failed: Sequence[FailedRun] = field(default_factory=list)


@pytest.fixture(scope="module")
def painted(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """Makes a release; read only."""

    def make(**wanted) -> Path:
        return _release(tmp_path_factory.mktemp("painted") / "data", Wanted(**wanted))

    return make


def _release(root: Path, wanted: Wanted) -> Path:
    # A list of routes replaces those that other settings are about, so it comes first.
    settings = sorted([*SETTINGS, *wanted.settings], key=lambda text: not text.startswith("routes="))
    loaded = load_scenario("smoke", settings)
    records = []
    for number, spec in enumerate(draw_all(loaded)):
        rows = drive()
        _write_run(root / spec.key, spec, rows, [wanted.grey(number, image) for image in rows.image if image])
        records.append(RunRecord.from_specification(spec, rows, None, wanted.warnings if number == 0 else ()))
    tree = loaded.tree | {"licence": wanted.licence}
    tree |= {"description": wanted.description} if wanted.description else {}
    described = describe(tree, draw_all(loaded), records, wanted.failed)
    (root / "metadata.json").write_bytes(described.to_json())
    hashes = released_hashes(root)
    (root / MANIFEST).write_bytes(manifest(hashes))
    (root / TAG_MANIFEST).write_bytes(tag_manifest(hashes))
    return root


def drive() -> Rows:
    """Two seconds at 0.2 m/s down the eastern straight of the dataset arena, x = 0.55 m, then 30 mm beside it."""
    table = np.zeros((ROWS, 19))
    table[:, 0] = 50 * np.arange(ROWS)
    table[:, 1] = np.where(np.arange(ROWS) < 20, 0.55, 0.58)
    table[:, 2] = -0.20 - 0.01 * np.arange(ROWS)
    table[:, 3] = round(-np.pi / 2, 6)
    table[:, 4] = STATES
    table[:, 5] = 0.2
    table[:, 7:10] = 2.0  # no target
    table[:, 10:18] = 0.9
    table[::EVERY, 18] = np.arange(1, ROWS // EVERY + 2)
    return Rows.from_table(table)


def _write_run(folder: Path, spec: RunSpec, rows: Rows, greys: Sequence[int]) -> None:
    (folder / "side").mkdir(parents=True)
    (folder / "images").mkdir()
    (folder / "data.csv").write_bytes(rows.to_csv())
    (folder / "side/spec.json").write_bytes(canonical_json(spec.model_dump(mode="json")))
    for number, grey in enumerate(greys, start=1):
        flat = np.full((HEIGHT, WIDTH, 3), grey, np.uint8)
        (folder / f"images/{number:06d}.jpg").write_bytes(cv2.imencode(".jpg", flat)[1].tobytes())
