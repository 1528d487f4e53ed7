"""`symolo bag` makes a bag by the rules of RFC 8493, which are written down here once more, apart from the program."""

import hashlib
import re
import shutil

import pytest

from symolo.verification.verify import verify

TAGS = {"bagit.txt", "bag-info.txt", "manifest-sha256.txt"}


def broken_rules(bag):
    """Every MUST of RFC 8493, sections 2.1, 2.2 and 3, that a bag without fetch.txt can break."""
    broken = []
    declaration = rb"BagIt-Version: \d+\.\d+\nTag-File-Character-Encoding: UTF-8\n"
    if not re.fullmatch(declaration, (bag / "bagit.txt").read_bytes()):
        broken.append("2.1.1: bagit.txt is two lines: version and encoding")
    if not (bag / "data").is_dir():
        broken.append("2.1.2: the payload lies in data/")
    payload = {path.relative_to(bag).as_posix() for path in (bag / "data").rglob("*") if path.is_file()}
    manifests = list(bag.glob("manifest-*.txt"))
    if not manifests:
        broken.append("2.1.3: at least one payload manifest")
    for path in manifests:
        if set(checked(bag, path, broken)) != payload:
            broken.append("2.1.3: each payload file once, and no other one")
    for path in bag.glob("tagmanifest-*.txt"):
        listed = set(checked(bag, path, broken))
        if any(name.startswith("data/") for name in listed) or not listed >= TAGS:
            broken.append("2.2.1: a tag manifest lists tag files, all payload manifests among them")
    info = [line.split(": ", 1) for line in (bag / "bag-info.txt").read_text(encoding="utf-8").splitlines()]
    if any(len(pair) != 2 for pair in info):
        return [*broken, "2.2.2: label, colon, value"]
    octets = sum((bag / name).stat().st_size for name in payload)
    if dict(info)["Payload-Oxum"] != f"{octets}.{len(payload)}":
        broken.append("2.2.2: Payload-Oxum")
    return broken


def checked(bag, path, broken):
    """Names in a manifest, whose algorithm its own name tells."""
    algorithm = path.stem.partition("-")[2]
    listed = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if not (match := re.fullmatch(r"([0-9a-f]+)[ \t]+\*?(\S.*)", line)):
            broken.append(f"2.1.3: a line of {path.name} is no checksum, space and name")
            continue
        digest, name = match.groups()
        listed.append(name)
        if not (bag / name).is_file():
            broken.append(f"3: {path.name} lists {name}, which is not there")
        elif hashlib.new(algorithm, (bag / name).read_bytes()).hexdigest() != digest:
            broken.append(f"3: checksum of {name}")
    return listed


@pytest.fixture
def bag(dataset, tmp_path, symolo):
    out = tmp_path / "bag"
    ended = symolo("bag", dataset, "--out", out)
    assert (ended.code, ended.out) == (0, f"{out}: a bag of 33 files\n")
    return out


def test_a_bag_keeps_the_rules_and_its_payload_is_the_dataset(bag, dataset, release_of):
    assert broken_rules(bag) == []
    assert release_of(bag / "data") == release_of(dataset)
    assert list(verify(bag)) == []
    assert list(verify(bag / "data")) == []
    assert [path.name for path in bag.parent.iterdir() if path.name.startswith(".")] == []


@pytest.mark.parametrize(
    "name", ["data/CW/test_1/data.csv", "data/tagmanifest-sha256.txt", *sorted(TAGS), "tagmanifest-sha256.txt"]
)
def test_damage_to_a_bag_is_found_and_named(name, bag):
    with (bag / name).open("ab") as file:
        file.write(b"\n")
    assert broken_rules(bag) != []
    assert {finding.file for finding in verify(bag)} == {name}


def test_a_bag_without_a_file_or_with_one_more_is_found(bag):
    (bag / "data/README.md").unlink()
    (bag / "data/more.txt").write_text("x")
    (bag / "notes.txt").write_text("x")
    assert {finding.file for finding in verify(bag)} == {
        "data/README.md",
        "data/more.txt",
        "notes.txt",
    }


def test_a_checksum_that_was_edited_is_distinguished_from_a_file_that_was(bag):
    """RFC 8493 cannot tell them apart; what the payload gives for the manifest can."""
    path = bag / "tagmanifest-sha256.txt"
    lines = path.read_text().splitlines()
    for i in range(3):
        path.write_text("\n".join(line if i != k else "0" * 64 + line[64:] for k, line in enumerate(lines)) + "\n")
        assert {finding.file for finding in verify(bag)} == {"tagmanifest-sha256.txt"}


def test_a_damaged_dataset_or_a_taken_folder_is_refused(dataset, copy_of, tmp_path, symolo):
    root, out = copy_of(dataset), tmp_path / "bag"
    (root / "CW/test_1/data.csv").write_text("")
    refused = symolo("bag", root, "--out", out)
    assert (refused.code, refused.err.count("\n")) == (2, 1)
    assert "CW/test_1/data.csv" in refused.err
    assert not out.exists()
    taken = symolo("bag", dataset, "--out", root)
    assert (taken.code, taken.err.count("\n")) == (2, 1)


def test_a_bag_that_was_interrupted_is_made_again(dataset, tmp_path, symolo, monkeypatch):
    out = tmp_path / "bag"
    with monkeypatch.context() as patch:
        patch.setattr("symolo.publishing.bagging.manifest", lambda _hashes: (_ for _ in ()).throw(KeyboardInterrupt))
        assert symolo("bag", dataset, "--out", out).code == 130
    assert not out.exists()
    assert symolo("bag", dataset, "--out", out).code == 0
    assert broken_rules(out) == []
    assert [path.name for path in tmp_path.iterdir()] == ["bag"]
    shutil.rmtree(out)
