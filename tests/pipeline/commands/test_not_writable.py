"""An output that cannot be written is refused before any work, not after it."""

import errno
import os

import pytest

TO_A_FILE = {
    "report": ["report", "DATA", "--out", "NO/page.html"],
    "view": ["view", "DATA", "--out", "NO/page.html"],
    "view --follow": ["view", "DATA", "--follow", "--out", "NO/page.html"],
    "video": ["video", "DATA", "--out", "NO/video.gif"],
    "contact-sheet": ["contact-sheet", "DATA", "--out", "NO/sheet.jpg"],
    "compare": ["compare", "DATA", "DATA", "--page", "NO/page.html"],
    "preview": ["preview", "smoke", "--out", "NO/sheet.jpg"],
    "export": ["export", "DATA", "--format", "tum", "--out", "NO/exported"],
    "baselines": ["baselines", "DATA", "--out", "NO/baselines"],
    "model": ["model", "smoke", "--out", "NO/model"],
    "bag": ["bag", "DATA", "--out", "NO/bag"],
    "release": ["release", "smoke", "--out", "NO/data"],
    "rerender": ["rerender", "DATA/CW/test_1", "--look", "lab", "--out", "NO/lab"],
    "diagnose": ["diagnose", "table-1", "--out", "NO/diagnosis"],
}


@pytest.fixture
def sealed(tmp_path, monkeypatch):
    """A folder on a disk that may only be read, as the system reports one; root may write where nobody else may."""
    folder = tmp_path / "sealed"
    folder.mkdir()

    def refused(*_, **options):
        assert options["dir"] == folder
        raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(folder))

    monkeypatch.setattr("symolo.core.files.paths.tempfile.TemporaryFile", refused)
    return folder


@pytest.mark.parametrize("command", TO_A_FILE)
def test_it_is_refused_before_the_data_are_read(command, sealed, tmp_path, symolo):
    arguments = [
        part.replace("NO", str(sealed)).replace("DATA", str(tmp_path / "not_even_there")) for part in TO_A_FILE[command]
    ]
    ended = symolo(*arguments)
    assert (ended.code, ended.out, ended.err.count("\n")) == (2, "", 1)
    assert f"cannot be written: {sealed}: Read-only file system; name a different folder" in ended.err
    assert not list(sealed.iterdir())
