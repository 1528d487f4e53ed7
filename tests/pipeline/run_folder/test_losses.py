"""No command takes files away from a finished release of something else unless the user says so."""

import pytest

ONE_ROUTE = "--set=routes=[{name: CW, start: {x_m: 0.55, y_m: -0.20, yaw_deg: -90}, runs: 1}]"
SIGNATURE = "tagmanifest-sha256.txt.minisig"
BRIGHT = "--set=look.sun.elevation_deg=70"


def state_of(folder):
    return {path: path.stat().st_mtime_ns for path in folder.rglob("*")}


@pytest.fixture
def out(dataset, copy_of):
    return copy_of(dataset, stages=True)


@pytest.fixture
def signed(out):
    (out / SIGNATURE).write_text("untrusted comment: of a test\n")
    return out


@pytest.mark.parametrize("command", [["release"], ["assemble"], ["hil", "--simulated"], ["release", "--dry-run"]])
def test_a_finished_release_of_another_scenario_is_not_replaced(signed, symolo, tiny, command):
    before = state_of(signed)
    ended = symolo(*command, "smoke", "--out", signed, *tiny, "--set=name=other")
    assert ended.code == 2
    message = ended.err.splitlines()[-1]
    assert "contains the finished dataset smoke, and not other" in message
    assert "2 runs (CCW/test_1, CW/test_1), 12 images and the signature would be lost" in message
    assert message.endswith("name another folder with --out, or give --replace")
    assert state_of(signed) == before


def test_without_stages_it_is_protected_too(dataset, copy_of, symolo, tiny):
    out = copy_of(dataset)
    ended = symolo("release", "smoke", "--out", out, *tiny, "--set=name=other")
    assert (ended.code, "12 images" in ended.err) == (2, True)
    assert not (out / ".stages").exists()


@pytest.mark.usefixtures("hands")
def test_with_replace_it_is_replaced_and_the_lines_name_what_went(signed, symolo, tiny):
    ended = symolo("release", "smoke", "--out", signed, *tiny, "--set=name=other", ONE_ROUTE, "--replace")
    assert ended.code == 0
    lines = ended.err.splitlines()
    lost = "2 runs (CCW/test_1, CW/test_1), 12 images and the signature"
    assert f"--replace: the finished dataset smoke loses {lost}" in lines
    assert "removed: CCW/test_1, which does not belong to the scenario" in lines
    assert "removed: the signature, which is that of other files" in lines
    assert not (signed / SIGNATURE).exists()
    assert not (signed / "CCW").exists()
    assert symolo("verify", signed).code == 0


def test_runs_that_the_scenario_no_longer_has_are_not_removed_unasked(out, symolo, tiny):
    before = state_of(out)
    ended = symolo("release", "smoke", "--out", out, *tiny, ONE_ROUTE)
    assert ended.code == 2
    assert "contains the finished dataset smoke: 1 run (CCW/test_1) and 6 images would be lost" in ended.err
    assert state_of(out) == before


def test_a_dry_run_says_what_a_release_would_take_away_do_and_keep_and_writes_nothing(out, symolo, tiny):
    before = state_of(out)
    ended = symolo("release", "smoke", "--out", out, *tiny, ONE_ROUTE, "--dry-run", "--replace")
    lines = ["would be lost by the next release: 1 run (CCW/test_1) and 6 images"]
    assert (ended.code, ended.out.splitlines()) == (0, [*lines, "would be kept as they are, 1 run (CW/test_1)"])
    assert lines[0] in symolo("status", out, "smoke", *tiny, ONE_ROUTE).out
    ended = symolo("release", "smoke", "--out", out, *tiny, BRIGHT, "--dry-run")
    assert ended.code == 0
    for text in (
        "1 run (CW/test_1): render: look.sun.elevation_deg ",
        "1 run (CCW/test_1): render: look.sun.elevation_deg ",
        "2 runs (CW/test_1, CCW/test_1): release: after its other stages\n",
    ):
        assert f"would be done by the next release, {text}" in ended.out
    assert "kept" not in ended.out
    assert state_of(out) == before


def test_a_dry_run_into_a_new_folder_makes_no_folder(tmp_path, symolo, tiny):
    ended = symolo("release", "smoke", "--out", tmp_path / "new", *tiny, "--dry-run")
    assert ended.code == 0
    assert "2 runs (CW/test_1, CCW/test_1): simulate: it was never finished" in ended.out
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("command", ["verify", "repair"])
def test_a_release_that_was_interrupted_is_named_so(out, symolo, command):
    for name in ("manifest-sha256.txt", "tagmanifest-sha256.txt"):
        (out / name).unlink()
    ended = symolo(command, out)
    assert (ended.code, ended.out) == (2, "")
    (line,) = ended.err.splitlines()
    assert line.endswith(
        f"{out}: the release is not finished; repeat the command that makes it, such as `symolo release`, with the "
        f"same options; `symolo status {out}` shows what is missing"
    )


def test_an_unfinished_release_needs_no_flag(out, symolo, tiny):
    (out / "tagmanifest-sha256.txt").unlink()
    assert symolo("release", "smoke", "--out", out, *tiny, ONE_ROUTE, "--workers=1").code == 0
    assert not (out / "CCW").exists()


@pytest.mark.parametrize("change", [BRIGHT, "--set=description=of something else"])
def test_a_signature_is_not_removed_unasked(signed, symolo, tiny, change):
    before = state_of(signed)
    ended = symolo("release", "smoke", "--out", signed, *tiny, change)
    assert ended.code == 2
    assert "contains the finished dataset smoke: the signature would be lost" in ended.err
    assert state_of(signed) == before


def test_a_signed_release_is_repaired_by_the_same_scenario_and_stays_signed(signed, symolo, tiny):
    (signed / "CW/test_1/data.csv").write_text("damaged")
    ended = symolo("release", "smoke", "--out", signed, *tiny)
    assert (ended.code, "removed" in ended.err) == (0, False)
    assert (signed / SIGNATURE).exists()


@pytest.mark.usefixtures("hands")
def test_a_rerendering_of_another_look_replaces_nothing_unasked(dataset, tmp_path, symolo):
    arguments = ["rerender", dataset / "CW/test_1", "--out", tmp_path / "out", "--set=render.annotations=[]"]
    size = ["--set=render.width_px=32", "--set=render.height_px=24"]
    assert symolo(*arguments, *size, "--look", "lab").code == 0
    before = state_of(tmp_path / "out")
    ended = symolo(*arguments, *size, "--look", "night")
    assert ended.code == 2
    assert "contains the finished dataset smoke-lab, and not smoke-night: 1 run (CW/test_1) and 6 images" in ended.err
    assert state_of(tmp_path / "out") == before
    assert symolo(*arguments, *size, "--look", "night", "--replace").code == 0
