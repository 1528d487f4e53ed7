"""The random releases that the exporters are tested with, packed."""

from dataclasses import dataclass
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest

from pipeline.cli import main

_PLACE = Path(__file__).parents[1] / "exporters" / "conftest.py"
_SPEC = spec_from_file_location("random_releases", _PLACE)
assert _SPEC is not None
assert _SPEC.loader is not None
_releases = module_from_spec(_SPEC)
_SPEC.loader.exec_module(_releases)
random_release = _releases.random_release

ABOUT = """
title: "Two drives: noise & nothing"
authors:
  - {family: Carberry, given: Josiah, orcid: 0000-0002-1825-0097, affiliation: Brown University}
  - {family: "A [laboratory](https://example.org)"}
published: "2026-11-22"
publisher: Zenodo
doi: 10.5281/zenodo.1234567
"""


@dataclass(frozen=True)
class Packed:
    release: Path
    truth: tuple
    """What was put into each run."""
    about: Path
    out: Path
    shard_bytes: int

    @property
    def shard_gb(self) -> str:
        return f"{self.shard_bytes / 1e9:.9f}"


@pytest.fixture(scope="session")
def about(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("about") / "about.yaml"
    path.write_text(ABOUT)
    return path


@pytest.fixture(scope="session")
def packed(random_release, about, tmp_path_factory) -> Packed:
    """A release of two runs, in shards that hold no two of them; read only."""
    random = random_release(annotated=True)
    out = tmp_path_factory.mktemp("packed") / "upload"
    shard_bytes = 20_000 + max(in_a_tar(random.root / run.name) for run in random.runs)
    arguments = ["--about", str(about), "--out", str(out), "--shard-gb", f"{shard_bytes / 1e9:.9f}"]
    assert main(["pack", str(random.root), *arguments]) == 0
    return Packed(random.root, random.runs, about, out, shard_bytes)


def in_a_tar(folder: Path) -> int:
    """Bytes of a folder's files: each has a head of 512 and is filled up to a multiple of them (POSIX ustar)."""
    sizes = [path.stat().st_size for path in folder.rglob("*") if path.is_file()]
    return sum(512 + -(-size // 512) * 512 for size in sizes)
