"""`symolo report` refuses what it cannot do before it writes."""

from pathlib import Path


def one_line(ended) -> str:
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    return ended.err


def test_what_cannot_be_done_is_refused_and_nothing_is_written(painted, copy_of, tmp_path, symolo):
    root, out = painted(), tmp_path / "report.html"
    damaged = copy_of(root)
    (damaged / "CW/test_1/data.csv").write_text("")
    for folder, place, what in (
        (damaged, out, "CW/test_1/data.csv: was changed: its SHA-256 is not that of manifest-sha256.txt"),
        (damaged, out, "symolo repair"),
        (root / "CW/test_1", out, "is a single run, which has no checksums"),
        (tmp_path, out, "neither a release nor a run"),
        (root, root / "report.html", "lies within the release"),
        (root, root / "CW/report.html", "lies within the release"),
        (root, tmp_path / "report.pdf", "a file name ending in .html in a folder that exists"),
        (root, tmp_path / "none/report.html", "a file name ending in .html in a folder that exists"),
    ):
        assert what in one_line(symolo("report", folder, "--out", place))
    assert "no run matches: got 'X*'" in one_line(symolo("report", root, "--out", out, "--runs", "X*"))
    assert [path.name for path in tmp_path.iterdir()] == ["copy"]
    assert not list(root.rglob("*.html"))


def test_only_the_runs_that_were_asked_for(painted, tmp_path, symolo):
    out = tmp_path / "report.html"
    assert symolo("report", painted(), "--out", out, "--runs", "CCW/*", "--detail", "0").code == 0
    html = out.read_text()
    assert "This page shows only these runs, out of 3 in the release." in html
    assert "CW/test_2" not in html.partition('id="provenance"')[0].replace("CCW/", "")


def test_without_out_the_page_is_named_after_the_dataset(painted, tmp_path, symolo, monkeypatch):
    root = painted()
    name = f"{root.name}-report.html"
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("symolo.report.build.release_report", lambda *_: b"page")
    assert symolo("report", root).out.startswith(f"{name}: 3 runs, ")
    assert Path(name).read_bytes() == b"page"
    Path(name).unlink()
    Path(name).mkdir()
    assert f"--out: got '{name}'" in one_line(symolo("report", root))


def test_what_ends_midway_leaves_the_page_that_was_there(painted, tmp_path, symolo, monkeypatch):
    out = tmp_path / "report.html"
    out.write_text("before")
    monkeypatch.setattr(
        "symolo.report.statistics.facts.image_numbers", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt)
    )
    assert symolo("report", painted(), "--out", out).code == 130
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]
    assert out.read_text() == "before"


def test_its_help_gives_an_example(symolo):
    assert "Example: symolo report data --out report.html" in " ".join(symolo("report", "--help").out.split())
