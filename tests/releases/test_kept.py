"""The small release that is kept of each version: this version verifies it, exports it, reports it and repairs it."""

import shutil
from pathlib import Path

import pytest

from symolo.core.files.file_hashes import sha256_of

FOLDER = Path(__file__).parent
KEPT = sorted(path.parent.name for path in FOLDER.glob("*/metadata.json"))


@pytest.fixture(params=KEPT)
def kept(request, tmp_path):
    return Path(shutil.copytree(FOLDER / request.param, tmp_path / "kept"))


def test_it_is_verified_and_exported(kept, tmp_path, symolo):
    assert (ended := symolo("verify", kept)).code == 0, ended.out
    for name in ("tum", "coco"):
        ended = symolo("export", kept, "--format", name, "--out", tmp_path / name)
        assert (ended.code, any((tmp_path / name).iterdir())) == (0, True), ended.err


@pytest.mark.documents
def test_it_is_reported_and_its_numbers_are_repaired(kept, tmp_path, symolo):
    """Not its images: those of 0.2.0 have less light than those of later versions."""
    assert symolo("report", kept, "--out", tmp_path / "page.html").code == 0
    lost = kept / "CW/test_1/data.csv"
    released = sha256_of(lost)
    lost.write_text("lost")
    assert symolo("verify", kept).code == 4
    ended = symolo("repair", kept)
    assert (ended.code, sha256_of(lost)) == (0, released), ended.err
