"""What is uploaded is read back with tar, sha256sum, pandas and the readers of each format."""

import json
import shutil
import subprocess
import tarfile
from collections import defaultdict

import numpy as np
import pandas as pd
import pytest
import yaml
from markdown_it import MarkdownIt

from pipeline.cli import main
from symolo.verification.verify import verify


def files_of(folder) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def shards_of(folder) -> dict[str, list[str]]:
    found = {}
    for path in sorted(folder.glob("*.tar")):
        with tarfile.open(path) as tar:
            found[path.name] = tar.getnames()
    return found


@pytest.fixture(scope="module")
def datacite():
    """Return the validator of DataCite's schema."""
    from datacite import schema45  # noqa: PLC0415 - takes half a second, which a process without these tests saves

    return schema45.validator


def test_what_tar_unpacks_is_the_release_and_is_verified_as_it_is(packed, tmp_path):
    for shard in sorted(packed.out.glob("*.tar")):
        subprocess.run(["tar", "xf", shard], cwd=tmp_path, check=True)  # noqa: S607
    (folder,) = tmp_path.iterdir()
    assert folder.name == "smoke"
    assert files_of(folder) == files_of(packed.release)
    findings = [(finding.file, finding.what) for finding in verify(folder)]
    assert findings == [(finding.file, finding.what) for finding in verify(packed.release)]
    assert not {"manifest-sha256.txt", "tagmanifest-sha256.txt"} & {file for file, _ in findings}


def test_every_file_has_its_checksum(packed):
    listed = subprocess.run(
        ["sha256sum", "--strict", "-c", "SHA256SUMS"],  # noqa: S607
        cwd=packed.out,
        check=True,
        capture_output=True,
        text=True,
    )
    checked = {line.partition(":")[0] for line in listed.stdout.splitlines()}
    assert checked == {path.name for path in packed.out.iterdir()} - {"SHA256SUMS"}


def test_a_run_lies_in_one_shard_and_no_shard_is_larger_than_asked_for(packed):
    places = defaultdict(set)
    for shard, names in shards_of(packed.out).items():
        assert (packed.out / shard).stat().st_size <= packed.shard_bytes
        for name in names:
            places["/".join(name.split("/")[1:-1][:2])].add(shard)
    assert places["CW/test_1"] != places["CCW/test_1"]
    assert {run: len(shards) for run, shards in places.items()} == {"": 1, "CW/test_1": 1, "CCW/test_1": 1}


def test_a_run_larger_than_a_shard_is_parted_by_files(packed, tmp_path):
    out = tmp_path / "small"
    arguments = ["--about", str(packed.about), "--out", str(out), "--shard-gb", "0.00001"]
    assert main(["pack", str(packed.release), *arguments]) == 0
    shards = shards_of(out)
    assert len(shards) > 2
    for shard, names in shards.items():
        assert (out / shard).stat().st_size <= 10_240 or len(names) == 1
    packed_names = sorted(name for names in shards.values() for name in names)
    assert packed_names == sorted(f"smoke/{name}" for name in files_of(packed.release))


def test_the_same_release_gives_the_same_bytes_on_another_day(packed, tmp_path):
    copy = tmp_path / "elsewhere"
    shutil.copytree(packed.release, copy, copy_function=shutil.copyfile)
    out = tmp_path / "again"
    arguments = ["--about", str(packed.about), "--out", str(out), "--shard-gb", packed.shard_gb]
    assert main(["pack", str(copy), *arguments]) == 0
    assert files_of(out) == files_of(packed.out)


def test_a_shard_has_no_owner_and_no_day(packed):
    for path in packed.out.glob("*.tar"):
        with tarfile.open(path) as tar:
            heads = {(info.uid, info.gid, info.uname, info.gname, info.mtime, info.mode) for info in tar}
        assert heads == {(0, 0, "", "", 0, 0o644)}


def test_a_table_holds_the_rows_of_all_runs(packed):
    rows = pd.read_csv(packed.out / "rows.csv")
    wheels = pd.read_csv(packed.out / "wheels.csv")
    assert list(dict.fromkeys(rows["run"])) == [run.name for run in packed.truth]
    for run in packed.truth:
        assert np.array_equal(rows[rows["run"] == run.name].drop(columns="run").to_numpy(), run.table)
        assert np.array_equal(wheels[wheels["run"] == run.name].drop(columns="run").to_numpy(), run.wheels)


def test_datacite_takes_its_record(packed, datacite):
    record = json.loads((packed.out / "datacite.json").read_bytes())
    datacite.validate(record)
    assert record["creators"][0]["nameIdentifiers"][0]["nameIdentifier"] == "https://orcid.org/0000-0002-1825-0097"
    assert record["rightsList"][0]["rightsIdentifier"] == "CC-BY-4.0"
    assert record["doi"] == "10.5281/zenodo.1234567"


def test_the_citation_has_what_its_format_requires(packed):
    cited = yaml.safe_load((packed.out / "CITATION.cff").read_text())
    assert {"cff-version", "message", "title", "authors"} <= set(cited)
    assert (cited["cff-version"], cited["type"], cited["license"]) == ("1.2.0", "dataset", "CC-BY-4.0")
    assert cited["date-released"] == "2026-11-22"
    assert [set(author) & {"family-names", "name"} for author in cited["authors"]] == [{"family-names"}, {"name"}]


def test_the_card_has_front_matter_and_names_every_file(packed):
    _, front, body = (packed.out / "README.md").read_text().split("---\n", 2)
    front_matter = yaml.safe_load(front)
    assert (front_matter["license"], front_matter["pretty_name"]) == ("cc-by-4.0", "Two drives: noise & nothing")
    tables = {config["data_files"] for config in front_matter["configs"]}
    assert tables == {path.name for path in packed.out.glob("*.csv")}
    for path in packed.out.iterdir():
        assert path.name == "README.md" or path.name in body
    assert f"| {next(packed.out.glob('*.csv')).stat().st_size / 1000:.1f} kB |" in body


def test_the_names_of_authors_are_text_and_their_identifiers_are_links(packed):
    """By an independent implementation of CommonMark."""
    _, _, body = (packed.out / "README.md").read_text().split("---\n", 2)
    page = MarkdownIt().render(body)
    assert "A [laboratory](https://example.org)." in page
    assert 'Carberry, Josiah (<a href="https://orcid.org/0000-0002-1825-0097">0000-0002-1825-0097</a>)' in page
    assert '<a href="https://creativecommons.org/licenses/by/4.0/">' in page


def test_a_dry_run_lists_what_is_written_and_writes_nothing(packed, tmp_path, capsys):
    out = tmp_path / "nothing"
    arguments = [
        "--about",
        str(packed.about),
        "--out",
        str(out),
        "--shard-gb",
        packed.shard_gb,
        "--dry-run",
    ]
    assert main(["pack", str(packed.release), *arguments]) == 0
    assert not out.exists()
    printed = capsys.readouterr().out
    for path in (*packed.out.glob("*.tar"), *packed.out.glob("*.csv")):
        assert path.name in printed
        assert f"{path.stat().st_size / 1e6:.3f} MB" in printed


@pytest.mark.parametrize("name", ["=1+1", "+1", "-1", "@A1", "a b", "a,b"])
def test_a_route_whose_name_a_spreadsheet_would_calculate_is_refused(name, packed, tmp_path, sign, capsys):
    """The name of the run is a cell of every table; a formula in it would run where the table is opened."""
    copy = tmp_path / "own"
    shutil.copytree(packed.release, copy)
    (copy / "CW").rename(copy / name)
    text = (copy / "metadata.json").read_text()
    (copy / "metadata.json").write_text(text.replace('"CW/', f'"{name}/'))
    sign(copy)
    assert main(["pack", str(copy), "--about", str(packed.about), "--out", str(tmp_path / "upload")]) == 2
    assert f"run: got '{name}/test_1', allowed: two names" in capsys.readouterr().err


def test_a_licence_that_is_not_listed_goes_by_its_name(packed, tmp_path, sign, datacite):
    copy = tmp_path / "own"
    shutil.copytree(packed.release, copy)
    metadata = json.loads((copy / "metadata.json").read_bytes())
    (copy / "metadata.json").write_text(json.dumps(metadata | {"licence": "Our terms"}))
    sign(copy)
    out = tmp_path / "upload"
    assert main(["pack", str(copy), "--about", str(packed.about), "--out", str(out)]) == 0
    front = yaml.safe_load((out / "README.md").read_text().split("---\n")[1])
    assert (front["license"], front["license_name"]) == ("other", "Our terms")
    assert "license" not in yaml.safe_load((out / "CITATION.cff").read_text())
    record = json.loads((out / "datacite.json").read_bytes())
    datacite.validate(record)
    assert record["rightsList"] == [{"rights": "Our terms"}]


@pytest.mark.parametrize(
    ("line", "changed", "message"),
    [
        ("0000-0002-1825-0097", "0000-0002-1825-0098", "whose last sign is 7"),
        ("2026-11-22", "2026-02-30", "a day of the calendar"),
        ("publisher:", "publishr:", "did you mean publisher"),
        ("publisher: Zenodo", "", "publisher"),
        ("doi: ", "doi: https://doi.org/", "doi"),
        ("doi: ", "keywords: []\ndoi: ", "keywords"),
    ],
)
def test_what_is_wrong_about_it_is_reported_before_anything_is_written(
    packed, tmp_path, capsys, line, changed, message
):
    (tmp_path / "about.yaml").write_text(packed.about.read_text().replace(line, changed))
    out = tmp_path / "upload"
    assert main(["pack", str(packed.release), "--about", str(tmp_path / "about.yaml"), "--out", str(out)]) == 2
    printed = capsys.readouterr().err
    assert (printed.count("\n"), message in printed) == (1, True), printed
    assert not out.exists()


def test_all_that_is_wrong_about_it_is_reported_together_and_counted_rightly(packed, tmp_path, capsys):
    text = packed.about.read_text().replace("1825-0097", "1825-0098").replace("2026-11-22", "22 November")
    (tmp_path / "about.yaml").write_text(text + "keyword: robot\n")
    command = ["pack", str(packed.release), "--about", str(tmp_path / "about.yaml"), "--out", str(tmp_path / "upload")]
    assert main(command) == 2
    first, *faults = capsys.readouterr().err.splitlines()
    assert first.endswith("3 faults:")
    assert ["whose last sign is 7" in faults[0], "published: got '22 Nov" in faults[1]] == [True, True]
    assert "keyword: unknown key" in faults[2]
    assert len(faults) == 3


def test_a_damaged_release_is_not_packed(packed, tmp_path, capsys):
    damaged = tmp_path / "damaged"
    shutil.copytree(packed.release, damaged)
    (damaged / "CW/test_1/data.csv").write_text("t\n0\n")
    out = tmp_path / "upload"
    assert main(["pack", str(damaged), "--about", str(packed.about), "--out", str(out)]) == 2
    assert "is not as it was released" in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"name": "../../elsewhere"}, "name: got '../../elsewhere', allowed: up to 64 letters"),
        ({"columns": {"side/../../secret.csv": []}}, "names a table side/../../secret.csv that no run has"),
        ({"columns": {"data.csv": []}}, "metadata.json names other columns"),
    ],
)
def test_a_strangers_release_does_not_say_where_files_go(packed, tmp_path, capsys, sign, change, message):
    copy = tmp_path / "own"
    shutil.copytree(packed.release, copy)
    metadata = json.loads((copy / "metadata.json").read_bytes())
    (copy / "metadata.json").write_text(json.dumps(metadata | change))
    sign(copy)
    assert main(["pack", str(copy), "--about", str(packed.about), "--out", str(tmp_path / "upload")]) == 2
    assert message in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["own"]


def test_a_full_disk_is_reported_before_work_starts(packed, tmp_path, capsys, monkeypatch):
    usage = shutil.disk_usage(tmp_path)._replace(free=1_000_000)
    monkeypatch.setattr("symolo.core.files.disk_space.shutil.disk_usage", lambda _: usage)
    out = tmp_path / "upload"
    assert main(["pack", str(packed.release), "--about", str(packed.about), "--out", str(out)]) == 5
    assert "are needed and 1 MB are free" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_file_that_changes_meanwhile_leaves_no_half_of_an_upload(packed, tmp_path, capsys, monkeypatch):
    copy = tmp_path / "own"
    shutil.copytree(packed.release, copy)
    monkeypatch.setattr("symolo.publishing.pack.check_disk", lambda *_: (copy / "README.md").write_text("other\n"))
    out = tmp_path / "upload"
    assert main(["pack", str(copy), "--about", str(packed.about), "--out", str(out)]) == 5
    assert "README.md is no longer what was written" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["own"]
