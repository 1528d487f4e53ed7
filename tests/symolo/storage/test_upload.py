"""An upload ends whole or is seen to be unfinished, and sends nothing twice."""

import subprocess
from concurrent.futures import ThreadPoolExecutor

import obstore
import pytest
from obstore.store import MemoryStore

from symolo.core.errors import EnvironmentLacking, InputError
from symolo.core.progress import LineReport
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST
from symolo.storage.bucket import Bucket
from symolo.storage.comparison import released_files
from symolo.storage.download import Remote
from symolo.storage.folder import Folder
from symolo.storage.upload import planned, upload

FILES = 10
"""Of the release of these tests, with its two lists."""


def held_by(store):
    return {name: store.get(name) for name in store.sizes()}


@pytest.fixture
def sent(release, release_of):
    """The release and its bytes by name."""
    root = release()
    content = release_of(root)
    assert len(content) == FILES
    return released_files(root), content


def test_a_stranger_with_sha256sum_finds_every_file_right(release, tmp_path, symolo):
    shelf = tmp_path / "shelf/data"
    ended = symolo("upload", release(), f"file://{shelf}")
    assert (ended.code, ended.out) == (0, f"file://{shelf}: 10 files sent, 0.0 MB; 0 were already there\n")
    check = ["sha256sum", "--strict", "-c", TAG_MANIFEST, MANIFEST]
    assert subprocess.run(check, cwd=shelf, check=True, capture_output=True).stdout.count(b": OK\n") == FILES


def test_the_lists_go_last(sent, store, counting):
    counted = counting(store)
    upload(sent[0], counted, LineReport())
    assert counted.put_names[-2:] == [MANIFEST, TAG_MANIFEST]
    assert held_by(store) == sent[1]


def test_one_that_stops_at_any_object_is_seen_to_be_unfinished_and_then_sends_only_the_rest(sent, store, counting):
    done = 0
    for stop_at in (1, 3, 4, 1):  # so that it takes five
        stopped = counting(store, stop_at)
        with pytest.raises(EnvironmentLacking, match="the network is gone"):
            upload(sent[0], stopped, LineReport())
        done += len(stopped.put_names)
        assert len(store.sizes()) == done
        with pytest.raises(InputError, match="holds no finished release"):
            Remote.from_store(store)
    last = counting(store)
    upload(sent[0], last, LineReport())
    assert done + len(last.put_names) == FILES
    assert held_by(store) == sent[1]


def test_the_same_again_sends_nothing(sent, store, counting):
    upload(sent[0], store, LineReport())
    counted = counting(store)
    upload(sent[0], counted, LineReport())
    assert counted.put_names == []


def test_two_at_the_same_time_harm_nothing(sent):
    store = Bucket("s3://bucket/data", MemoryStore())
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda _: upload(sent[0], store, LineReport()), range(2)))
    assert held_by(store) == sent[1]


def test_another_release_stays_as_it_is(sent, release, store):
    upload(sent[0], store, LineReport())
    other = released_files(release("other", **{"README.md": b"# Another\n"}))
    with pytest.raises(InputError, match="holds a different release; give a different prefix"):
        upload(other, store, LineReport())
    assert held_by(store) == sent[1]


def test_files_of_others_are_left_alone(sent, release, store):
    theirs = {file.name: file for file in released_files(release("other", **{"CW/theirs.txt": b"theirs"}))}
    store.put(theirs["CW/theirs.txt"])
    with pytest.raises(InputError, match=r"not part of this release: CW/theirs\.txt"):
        upload(sent[0], store, LineReport())
    assert held_by(store) == {"CW/theirs.txt": b"theirs"}


def test_check_names_what_is_missing_or_other_or_extra_and_upload_repairs_it(release, release_of, tmp_path, symolo):
    root, shelf = release(), tmp_path / "shelf"
    url = f"file://{shelf}"
    assert symolo("upload", root, url).code == 0
    ended = symolo("upload", root, url, "--check")
    assert (ended.code, ended.out) == (0, f"{url}: all 10 files, none missing or different\n")
    (shelf / "README.md").unlink()
    (shelf / "metadata.json").write_bytes(b"[]\n")
    (shelf / "CW/test_1/data.csv").write_bytes(b"t")
    (shelf / "mine.txt").write_bytes(b"mine")
    ended = symolo("upload", root, url, "--check")
    assert ended.code == 4
    assert ended.out.splitlines() == [
        "CW/test_1/data.csv: has 1 bytes in place of 8",
        "README.md: is missing",
        "metadata.json: has a different SHA-256",
        "mine.txt: is not part of the release",
    ]
    (shelf / "mine.txt").unlink()
    assert (
        symolo("upload", root, url, "--dry-run").out == f"{url}: 3 files would be sent, 0.0 MB; 7 were already there\n"
    )
    assert not (shelf / "README.md").exists()
    assert symolo("upload", root, url).out == f"{url}: 3 files sent, 0.0 MB; 7 were already there\n"
    assert release_of(shelf) == release_of(root)


def test_an_object_that_somebody_else_put_there_without_a_checksum_is_sent_again(sent):
    memory = MemoryStore()
    for name, content in sent[1].items():
        obstore.put(memory, name, content)
    store = Bucket("s3://bucket/data", memory)
    plan = planned(sent[0], store, LineReport())
    assert {file.name for file in plan.to_send} == sent[1].keys() - {MANIFEST, TAG_MANIFEST}
    assert set(plan.different.values()) == {"has no SHA-256 in its metadata, so only a download could check it"}


def test_a_damaged_release_is_not_sent(release, tmp_path, symolo):
    root = release()
    (root / "README.md").write_bytes(b"# Another\n")
    ended = symolo("upload", root, f"file://{tmp_path}/shelf")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert "README.md: was changed" in ended.err
    assert not (tmp_path / "shelf").exists()


def test_a_release_is_not_sent_into_itself(release, symolo):
    root = release()
    ended = symolo("upload", root, f"file://{root}/CW")
    assert (ended.code, "lies within the release" in ended.err) == (2, True)


def test_nor_into_another_one(release, dataset, copy_of, symolo):
    other = copy_of(dataset)
    for name in ("new", "CW/new"):
        ended = symolo("upload", release(), f"file://{other}/{name}")
        assert (ended.code, f"file://{other}/{name}: lies within the release {other};" in ended.err) == (2, True)
    assert symolo("verify", other).code == 0


def test_a_folder_that_another_upload_fills_is_refused(release, tmp_path, symolo):
    shelf = tmp_path / "shelf"
    with Folder(f"file://{shelf}", shelf).locked():
        ended = symolo("upload", release(), f"file://{shelf}")
    assert (ended.code, "another symolo command is working" in ended.err) == (2, True)
    assert list(shelf.iterdir()) == []
