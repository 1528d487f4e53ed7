"""`release --upload`: each run goes as soon as it is whole, and nothing on the way there costs the release anything."""

import shlex
import time
from types import SimpleNamespace

import pytest

from symolo.core.errors import EnvironmentLacking
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST
from symolo.storage.folder import Folder

SMALL = ["--set=stop.time_limit_s=0.2", "--set=render.width_px=32", "--set=render.height_px=24", "--workers=1"]
LISTS = [MANIFEST, TAG_MANIFEST]


@pytest.fixture
def shelf(monkeypatch, tmp_path):
    """A folder as a store, with the names that were put there; `fails` says of which put it is gone."""
    seen = SimpleNamespace(
        root=tmp_path / "shelf", url=f"file://{tmp_path}/shelf", names=[], fails=lambda _number: False
    )
    put = Folder.put

    def noted(self, file):
        if seen.fails(len(seen.names)):
            raise EnvironmentLacking("the network is gone")
        seen.names.append(file.name)
        put(self, file)

    monkeypatch.setattr(Folder, "put", noted)
    return seen


@pytest.fixture
def release(symolo, tmp_path, shelf, hands):
    del hands  # that make it
    out = tmp_path / "out"
    return lambda *more, out=out: symolo("release", "smoke", "--out", out, *SMALL, "--upload", shelf.url, *more)


def test_a_run_is_there_while_the_next_is_made_and_the_lists_come_last(
    release, hands, shelf, tmp_path, release_of, symolo
):
    there = {}

    plain = hands.paint

    def look(unit):
        end = time.monotonic() + 60
        while unit.name == "CCW/test_1" and len(there) < 10 and time.monotonic() < end:
            time.sleep(0.01)
            there.update((name, (shelf.root / name).read_bytes()) for name in Folder("", shelf.root).sizes())
        plain(unit)

    hands.paint = look
    ended = release()
    assert (ended.code, ended.out.splitlines()[0]) == (0, f"release: 2 of 2 runs, in {tmp_path}/out")
    assert shelf.names[-2:] == LISTS
    content = release_of(tmp_path / "out")
    assert there == {name: data for name, data in content.items() if name.startswith("CW/")}
    assert len(there) == 10
    assert release_of(shelf.root) == content
    assert sorted(shelf.names) == sorted(content)
    assert ended.out.splitlines()[1] == f"{shelf.url}: 25 files there, 25 sent now, 5 of them at the end"
    assert "upload: CW/test_1: 10 files sent, 0.0 MB; 0 were already there" in ended.err
    assert "compare" not in ended.err  # this process has sent it all
    assert symolo("verify", shelf.root).code == 0


def test_interrupted_and_given_again_it_sends_the_rest_and_then_nothing(release, hands, shelf, tmp_path, release_of):
    plain = hands.paint

    def stop(unit):
        if unit.name == "CCW/test_1":
            raise KeyboardInterrupt
        plain(unit)

    hands.paint = stop
    assert release().code == 130
    assert not {*LISTS} & {*shelf.names}
    hands.paint = plain
    assert release().code == 0
    content = release_of(tmp_path / "out")
    assert release_of(shelf.root) == content
    assert sorted(shelf.names) == sorted(content)  # each once
    again = release()
    assert (again.code, again.out.splitlines()[1]) == (
        0,
        f"{shelf.url}: 25 files there, 0 sent now, 0 of them at the end",
    )
    assert len(shelf.names) == 25


def test_a_network_that_is_gone_leaves_the_release_whole_and_names_the_command_that_sends_the_rest(
    release, shelf, tmp_path, release_of, symolo
):
    shelf.fails = lambda number: number >= 3
    ended = release()
    assert ended.code == 5
    assert "the network is gone; the release continues" in ended.err
    assert symolo("verify", tmp_path / "out").code == 0
    last = ended.err.splitlines()[-1]
    assert f"the release is complete in {tmp_path}/out" in last
    shelf.fails = lambda _number: False
    command = shlex.split(last.split("`")[1])
    assert command == ["symolo", "upload", str(tmp_path / "out"), shelf.url]
    assert symolo(*command[1:]).code == 0
    assert release_of(shelf.root) == release_of(tmp_path / "out")


def test_a_network_that_comes_back_costs_nothing(release, shelf, tmp_path, release_of):
    failures = iter([True])
    shelf.fails = lambda number: number >= 3 and next(failures, False)
    assert release().code == 0
    assert release_of(shelf.root) == release_of(tmp_path / "out")


def test_where_a_run_failed_the_place_is_not_finished(release, hands, shelf, tmp_path):
    plain = hands.paint
    hands.paint = lambda unit: plain(unit, grey=0 if unit.name == "CW/test_1" else 128)
    ended = release()
    assert (ended.code, "not finished, because a run failed" in ended.out) == (3, True)
    assert {name.split("/")[0] for name in shelf.names} == {"CCW"}
    assert (tmp_path / "out" / TAG_MANIFEST).is_file()


def test_a_released_run_that_fails_twice_is_not_removed(release, hands, shelf, tmp_path, release_of, symolo):
    out = tmp_path / "out"
    assert symolo("release", "smoke", "--out", out, *SMALL).code == 0
    before = release_of(out)
    plain = hands.paint
    hands.paint = lambda unit: plain(unit, grey=0 if unit.name == "CCW/test_1" else 128)
    for _ in range(2):
        ended = release("--set=look.sun.elevation_deg=70")
        assert (ended.code, "1 released run failed now, and no run was removed" in ended.err) == (2, True)
        assert release_of(out) == before
    assert shelf.names == []


def test_a_place_with_something_else_is_refused_before_anything_is_written(release, shelf, tmp_path, symolo):
    assert release(out=tmp_path / "first").code == 0
    names = [*shelf.names]
    refusals = {("--set=seed=7",): "is not that of this scenario", ("--set=licence=MIT",): "names a different scenario"}
    for settings, message in refusals.items():
        ended = release(*settings)
        assert ended.code == 2, ended.err
        assert message in ended.err
        assert "holds a different release" in ended.err
    for name in LISTS:  # not finished either
        (shelf.root / name).unlink()
    assert release("--set=seed=7").code == 2
    (shelf.root / "CW/test_9").mkdir()
    (shelf.root / "CW/test_9/data.csv").write_bytes(b"")
    assert "CW/test_9/data.csv does not belong to a run of this scenario" in release().err
    for url, code in ((f"file://{tmp_path}/out/x", 2), (f"file://{tmp_path}", 2), ("s3://bucket/data", 5)):
        assert release("--upload", url).code == code
    assert symolo("release", "smoke", "--out", tmp_path / "out", "--allow-http").code == 2
    assert not (tmp_path / "out").exists()
    assert shelf.names == names
