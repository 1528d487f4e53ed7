"""What holds for every importer of measured data."""

import os

import pytest

from configs.errors import InputError
from diagnosis.importers.choose import read_measurement
from pipeline.importers import IMPORTERS


@pytest.fixture
def strange(tmp_path):
    """Paths that are no measured data."""
    (tmp_path / "empty").mkdir()
    (tmp_path / "empty.csv").write_bytes(b"")
    (tmp_path / "binary.csv").write_bytes(bytes(range(256)) * 8)
    (tmp_path / "one_line.csv").write_text("x" * 100_000)
    os.mkfifo(tmp_path / "pipe.csv")
    (tmp_path / "loop.csv").symlink_to(tmp_path / "loop.csv")
    return [tmp_path / "nowhere", *sorted(tmp_path.iterdir())]


@pytest.mark.parametrize("importer", IMPORTERS, ids=lambda importer: importer.name)
def test_an_importer_recognises_nothing_in_what_is_no_measured_data(importer, strange):
    assert [path.name for path in strange if importer.recognises(path)] == []


@pytest.mark.parametrize("importer", IMPORTERS, ids=lambda importer: importer.name)
def test_an_importer_refuses_in_one_line_what_it_is_named_for_and_cannot_read(importer, strange):
    for path in strange:
        with pytest.raises(InputError) as told:
            read_measurement(path, IMPORTERS, importer.name)
        assert "\n" not in str(told.value)
        assert path.name in str(told.value)


def test_importers_have_names_of_their_own_and_say_what_they_read():
    for of in ("name", "what"):
        assert len({getattr(importer, of) for importer in IMPORTERS}) == len(IMPORTERS)
