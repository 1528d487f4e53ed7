import gzip
import hashlib

import pytest

from blender_scenes.render.frame_files import FrameFile, Ledger
from blender_scenes.render.job_file import job_path, job_sha256, read_job, write_job
from pipeline.run_folder.workspace import StageFolder
from pipeline.stages.render import journal
from symolo.core.files.plain_files import FileKind

TEXT = '{"vertices":[' + ",".join(f"[{i / 7},{i / 11}]" for i in range(2000)) + "]}\n"
SHA256 = hashlib.sha256(TEXT.encode()).hexdigest()


def test_a_job_is_a_gzip_file_of_its_text_and_less_than_half_as_large(tmp_path):
    write_job(tmp_path, TEXT)
    path = job_path(tmp_path)
    assert (path.name, gzip.decompress(path.read_bytes())) == ("job.json.gz", TEXT.encode())
    assert path.stat().st_size < 0.5 * len(TEXT)
    assert (read_job(path), job_sha256(path)) == (TEXT.encode(), SHA256)


def test_the_same_job_is_the_same_bytes_at_any_time(tmp_path, monkeypatch):
    made = []
    for second in (1e9, 2e9):
        monkeypatch.setattr("time.time", lambda at=second: at)
        write_job(tmp_path, TEXT)
        made.append(job_path(tmp_path).read_bytes())
    assert made[0] == made[1]


def test_the_job_of_an_earlier_version_is_read_and_replaced(tmp_path):
    (tmp_path / "job.json").write_text(TEXT)
    path = job_path(tmp_path)
    assert (path.name, read_job(path), job_sha256(path)) == ("job.json", TEXT.encode(), SHA256)
    write_job(tmp_path, TEXT)
    assert [file.name for file in tmp_path.iterdir()] == ["job.json.gz"]


def test_images_that_an_earlier_version_has_made_of_a_job_are_its_images_still(tmp_path):
    (tmp_path / "job.json").write_text(TEXT)
    Ledger(tmp_path / "images", SHA256).add(FrameFile(1, "000001.jpg", "0" * 64, 9, 0.1, cpu="a"))
    before = journal(StageFolder(tmp_path), "images").processors()
    write_job(tmp_path, TEXT)
    assert before == journal(StageFolder(tmp_path), "images").processors() == ("a",)


@pytest.mark.parametrize("damage", ["cut", "one bit", "more"])
def test_a_damaged_job_is_refused_and_has_no_images(tmp_path, damage):
    write_job(tmp_path, TEXT)
    path = job_path(tmp_path)
    data = bytearray(path.read_bytes())
    data[-6] ^= damage == "one bit"
    path.write_bytes({"cut": data[:-9], "one bit": data, "more": data + b"x"}[damage])
    with pytest.raises(ValueError, match=r"job\.json\.gz: the file is damaged"):
        read_job(path)
    assert job_sha256(path) != SHA256


def test_a_job_that_unpacks_to_more_than_a_job_may_have_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(FileKind.JOB, "max_bytes", 50_000)
    write_job(tmp_path, "0" * 50_000)
    assert len(read_job(job_path(tmp_path))) == 50_000
    write_job(tmp_path, "0" * 50_001)
    with pytest.raises(ValueError, match="longer than 50000 bytes"):
        read_job(job_path(tmp_path))
