"""What holds for every importer of measured data."""

import errno
import os
from pathlib import Path

import pytest

from diagnosis.importers.choose import read_measurement
from pipeline.diagnosing.importers import IMPORTERS
from symolo.core.errors import FaultsError, InputError


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
def test_an_importer_refuses_in_a_line_for_each_fault_what_it_is_named_for_and_cannot_read(importer, strange):
    for path in strange:
        with pytest.raises(InputError) as caught:
            read_measurement(path, IMPORTERS, importer.name)
        faults = caught.value.faults if isinstance(caught.value, FaultsError) else (caught.value,)
        assert [str(fault) for fault in faults if "\n" in str(fault) or path.name not in str(fault)] == []


@pytest.fixture
def locked(tmp_path, monkeypatch):
    """A folder whose names can be listed and whose files cannot be reached; root may reach any, hence no mode."""
    folder = tmp_path / "locked"
    folder.mkdir()
    for name in ("data.csv", "nominal.yaml", "metadata.json", "1_metadata.csv", "1_run-01.csv"):
        (folder / name).write_text("1,2\n")
    stat = Path.stat

    def refusing(path, *, follow_symlinks=True):
        if path.parent == folder:
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
        return stat(path, follow_symlinks=follow_symlinks)

    monkeypatch.setattr(Path, "stat", refusing)
    return folder


@pytest.mark.parametrize("importer", IMPORTERS, ids=lambda importer: importer.name)
def test_asking_an_importer_about_a_folder_without_permission_never_raises(importer, locked):
    assert importer.recognises(locked) in {True, False}
    assert not importer.recognises(locked / "data.csv")


def test_a_folder_without_permission_is_refused_in_one_line_that_says_so(locked):
    for path in (locked, locked / "data.csv"):
        with pytest.raises(InputError, match=r"locked.*cannot be read: Permission denied"):
            read_measurement(path, IMPORTERS)


@pytest.mark.parametrize("importer", IMPORTERS, ids=lambda importer: importer.name)
def test_an_importer_named_for_a_folder_without_permission_refuses_it(importer, locked):
    with pytest.raises(InputError, match="locked"):
        read_measurement(locked, IMPORTERS, importer.name)


def test_importers_have_different_names():
    assert len({importer.name for importer in IMPORTERS}) == len(IMPORTERS)
