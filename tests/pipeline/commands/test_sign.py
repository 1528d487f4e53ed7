"""`symolo sign` and `symolo verify --key`, on releases that are signed, forged or changed, and beside minisign."""

import hashlib
import io
import json
import subprocess
from pathlib import Path

import pytest

from symolo.dataset.manifest import SEALS
from symolo.signing.minisign import PublicKey
from symolo.signing.secret_key import SecretKey

KEYS = Path(__file__).parents[2] / "symolo/signing/made_by_minisign"
SIGNATURE, STATEMENT = "tagmanifest-sha256.txt.minisig", "provenance.intoto.json"
TIME = "2026-11-23T16:00:00Z"
COMMENT = f"dataset:smoke version:1.0.0 time:{TIME} file:tagmanifest-sha256.txt"


@pytest.fixture
def signed(dataset, copy_of, symolo):
    """A release without stages, signed by a key of minisign."""
    root = copy_of(dataset)
    ended = symolo("sign", root, "--key", KEYS / "plain.key", "--time", TIME, "--provenance")
    assert ended.code == 0, ended.err
    return root


def verified(symolo, root, key=KEYS / "plain.pub"):
    return symolo("verify", root, "--key", key)


def minisign(*arguments, answers=""):
    command = ["minisign", *map(str, arguments)]
    return subprocess.run(command, input=answers, capture_output=True, text=True, check=False)


def test_a_signed_release_is_verified_by_the_public_key(signed, symolo):
    ended = verified(symolo, signed)
    assert ended.out == f"{signed}: no fault, signed by the key 5A234EBCF96E609A ({COMMENT})\n"
    assert (ended.code, ended.err) == (0, "")
    characters = (KEYS / "plain.pub").read_text().splitlines()[1]
    assert verified(symolo, signed, characters).out == ended.out


def test_no_other_file_changes_and_the_same_time_gives_the_same_bytes(signed, dataset, symolo, release_of):
    first = release_of(signed)
    assert {name: first[name] for name in first.keys() - {*SEALS}} == release_of(dataset)
    assert symolo("sign", signed, "--key", KEYS / "plain.key", "--time", TIME).code == 0
    assert release_of(signed) == first, "the statement that is there is signed again"


def test_the_time_may_come_from_the_environment(signed, symolo, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1000000000")
    ended = symolo("sign", signed, "--key", KEYS / "plain.key", "--release-version", "2.1.0")
    assert "version:2.1.0 time:2001-09-09T01:46:40Z" in ended.out
    assert "version:2.1.0 time:2001-09-09T01:46:40Z" in verified(symolo, signed).out


def test_a_forged_release_whose_lists_fit_is_found_by_the_key_alone(signed, symolo, sign):
    images = signed / "CW/test_1/images"
    (images / "000001.jpg").write_bytes((images / "000002.jpg").read_bytes())
    sign(signed)  # writes lists of checksums that fit
    plain = symolo("verify", signed)
    assert (plain.code, plain.out) == (0, f"{signed}: no fault\n")
    ended = verified(symolo, signed)
    assert ended.code == 4
    assert ended.out.splitlines() == [
        f"{SIGNATURE}: is by this key, but of other content; it was made for `{COMMENT}`",
        f"{STATEMENT}: is about another release: it states another SHA-256 of tagmanifest-sha256.txt",
    ]


def test_the_signature_of_another_release_is_refused(signed, dataset, symolo, tmp_path, sign, copy_of):
    other = signed.rename(tmp_path / "other")
    (other / "README.md").write_bytes(b"another one\n")
    sign(other)
    assert symolo("sign", other, "--key", KEYS / "plain.key").code == 0
    root = copy_of(dataset)
    (root / SIGNATURE).write_bytes((other / SIGNATURE).read_bytes())
    ended = verified(symolo, root)
    assert ended.code == 4
    assert f"{SIGNATURE}: is by this key, but of other content; it was made for `dataset:smoke version" in ended.out


CHANGES = {
    "missing": (lambda path: path.unlink(), "is missing: tagmanifest-sha256.txt is not signed"),
    "truncated": (lambda path: path.write_bytes(path.read_bytes()[:200]), "is no signature of minisign: it has four"),
    "empty": (lambda path: path.write_bytes(b""), "is no signature of minisign: it has four lines, this has 0"),
    "comment": (
        lambda path: path.write_text(path.read_text().replace("version:1.0.0", "version:9.0.0")),
        "was changed: its trusted comment is not the one that was signed",
    ),
    "large": (lambda path: path.write_bytes(bytes(20_000)), "is no signature"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_a_signature_that_was_changed_is_one_clear_line(signed, symolo, change):
    alter, message = CHANGES[change]
    alter(signed / SIGNATURE)
    ended = verified(symolo, signed)
    assert ended.code == 4
    (line,) = ended.out.splitlines()
    assert line.startswith(f"{SIGNATURE}: {message}")
    assert ended.err == f"{signed}: 1 fault\n"
    assert symolo("verify", signed).code == 0, "without a key nobody asks for a signature"


def test_another_key_is_named(signed, symolo, tmp_path):
    assert symolo("sign", "--new-key", tmp_path / "other.key", "--no-passphrase").code == 0
    ended = verified(symolo, signed, tmp_path / "other.pub")
    assert ended.code == 4
    assert f"{SIGNATURE}: was made by the key 5A234EBCF96E609A, not by the key " in ended.out


def test_a_key_that_only_bears_the_number_of_another_one_is_not_believed(signed, symolo):
    """The number is in every signature, so anybody may make a key that bears it."""
    public = PublicKey.from_text((KEYS / "plain.pub").read_text())
    forger = SecretKey(public.key_id, SecretKey.new().seed)
    data = (signed / "tagmanifest-sha256.txt").read_bytes()
    (signed / SIGNATURE).write_bytes(forger.sign(data, COMMENT).to_bytes(""))
    ended = verified(symolo, signed)
    assert ended.code == 4
    assert ended.out == f"{SIGNATURE}: was not made by the key 5A234EBCF96E609A, or was changed\n"


@pytest.mark.parametrize("damage", ["CW/test_1/data.csv", "manifest-sha256.txt"])
def test_a_damaged_release_is_not_signed(dataset, copy_of, symolo, damage):
    root = copy_of(dataset)
    (root / damage).write_bytes((root / damage).read_bytes()[:-3])
    ended = symolo("sign", root, "--key", KEYS / "plain.key")
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith(f"symolo: {root}: is not signed, since it has faults: {damage}: ")
    assert not (root / SIGNATURE).exists()


def test_every_other_command_takes_a_signed_release(signed, symolo, tmp_path, release_of):
    content, bag, store = release_of(signed), tmp_path / "bag", (tmp_path / "store").as_uri()
    assert symolo("repair", signed).out == f"{signed}: 0 faults repaired, every file is as it was released\n"
    assert release_of(signed) == content
    assert symolo("export", signed, "--format", "tum", "--out", tmp_path / "exported").code == 0
    assert symolo("bag", signed, "--out", bag).code == 0
    assert verified(symolo, bag).out.startswith(f"{bag}: no fault, signed by the key 5A234EBCF96E609A")
    assert symolo("upload", signed, store).code == 0
    assert symolo("upload", signed, store, "--check").code == 0
    assert symolo("download", store, "--out", tmp_path / "fetched").code == 0
    assert release_of(tmp_path / "fetched") == content
    assert symolo("compare", signed, tmp_path / "fetched").code == 0


def test_a_signature_is_no_difference_between_two_datasets(signed, dataset, symolo):
    ended = symolo("compare", signed, dataset)
    assert ended.code == 0
    assert ended.out.startswith("identical: ")


def test_a_new_signature_replaces_that_in_a_store_and_an_old_copy_leaves_it(signed, dataset, symolo, tmp_path):
    store = (tmp_path / "store").as_uri()
    assert symolo("upload", dataset, store).code == 0
    assert symolo("upload", signed, store).out.startswith(f"{store}: 3 files sent")
    assert symolo("sign", signed, "--key", KEYS / "plain.key", "--release-version", "1.0.1").code == 0
    assert symolo("upload", signed, store).out.startswith(f"{store}: 2 files sent")
    assert symolo("upload", dataset, store).out.startswith(f"{store}: 0 files sent")
    assert symolo("download", store, "--out", tmp_path / "fetched").code == 0
    assert "version:1.0.1" in verified(symolo, tmp_path / "fetched").out


def test_a_release_that_becomes_another_one_loses_its_signature(dataset, copy_of, symolo, tiny):
    root = copy_of(dataset, stages=True)
    assert symolo("sign", root, "--key", KEYS / "plain.key", "--provenance").code == 0
    assert symolo("release", "smoke", "--out", root, *tiny).code == 0
    assert (root / SIGNATURE).exists(), "the same release keeps it"
    assert symolo("release", "smoke", "--out", root, *tiny, "--set", "description=another", "--replace").code == 0
    assert not any((root / name).exists() for name in SEALS)
    assert symolo("verify", root).code == 0


def test_the_statement_of_provenance_has_the_fields_of_in_toto_and_slsa(signed):
    """Names and values of the specifications in-toto Statement v1 and SLSA Provenance v1."""
    statement = json.loads((signed / STATEMENT).read_bytes())
    assert statement.keys() == {"_type", "subject", "predicateType", "predicate"}
    assert statement["_type"] == "https://in-toto.io/Statement/v1"
    assert statement["predicateType"] == "https://slsa.dev/provenance/v1"
    lists = ("tagmanifest-sha256.txt", "manifest-sha256.txt")
    digests = {name: {"sha256": hashlib.sha256((signed / name).read_bytes()).hexdigest()} for name in lists}
    assert {subject["name"]: subject["digest"] for subject in statement["subject"]} == digests
    predicate, metadata = statement["predicate"], json.loads((signed / "metadata.json").read_bytes())
    assert predicate.keys() == {"buildDefinition", "runDetails"}
    build = predicate["buildDefinition"]
    assert build.keys() == {"buildType", "externalParameters", "internalParameters", "resolvedDependencies"}
    assert build["externalParameters"] == {"scenario": metadata["scenario"]}
    uris = {one["name"]: one.get("uri") for one in build["resolvedDependencies"]}
    assert uris["bpy"] == f"pkg:pypi/bpy@{metadata['made_with']['bpy']}"
    assert all(one.keys() & {"uri", "digest", "content"} for one in build["resolvedDependencies"])
    assert predicate["runDetails"]["builder"].keys() == {"id", "version"}


def test_a_statement_that_was_changed_is_found(signed, symolo):
    text = (signed / STATEMENT).read_text()
    (signed / STATEMENT).write_text(text.replace('"CPU"', '"GPU"'))
    ended = verified(symolo, signed)
    assert ended.out.startswith(f"{STATEMENT}.minisig: is by this key, but of other content; it was made for `dataset:")
    (signed / STATEMENT).unlink()
    assert f"{STATEMENT}.minisig: signs {STATEMENT}, which is missing" in verified(symolo, signed).out


def test_a_passphrase_comes_from_a_file_or_the_environment(dataset, copy_of, symolo, tmp_path, monkeypatch):
    text = SecretKey.new().to_text("pass word", 1 << 19, 1 << 24)
    (tmp_path / "mine.key").write_text(text)
    (tmp_path / "words.txt").write_text("pass word\n")
    root = copy_of(dataset)
    assert symolo("sign", root, "--key", tmp_path / "mine.key", "--passphrase-file", tmp_path / "words.txt").code == 0
    monkeypatch.setenv("SYMOLO_PASSPHRASE", "wrong")
    ended = symolo("sign", root, "--key", tmp_path / "mine.key")
    assert (ended.code, "the passphrase is wrong" in ended.err) == (2, True)
    monkeypatch.delenv("SYMOLO_PASSPHRASE")
    monkeypatch.setattr("sys.stdin", io.StringIO())
    ended = symolo("sign", root, "--key", tmp_path / "mine.key")
    assert ended.err.startswith("symolo: the key has a passphrase, and there is no terminal to ask for it; ")


def test_what_cannot_be_meant_is_refused(dataset, symolo, tmp_path):
    for arguments, message in (
        (["sign"], "name a dataset and --key FILE"),
        (["sign", dataset], "name a dataset and --key FILE"),
        (["sign", dataset, "--new-key", tmp_path / "a.key"], "--new-key; give it alone"),
        (["sign", "--new-key", dataset / "a.key"], "lies within the release"),
        (["sign", tmp_path, "--key", KEYS / "plain.key", "--release-version", "one"], "--release-version: got 'one'"),
        (["sign", tmp_path, "--key", KEYS / "plain.key", "--time", "today"], "--time: got 'today'"),
        (["sign", tmp_path / "none", "--key", KEYS / "plain.key"], "no such folder"),
        (["verify", dataset, "--key", tmp_path / "none.pub"], "none.pub: cannot be read"),
    ):
        ended = symolo(*arguments)
        assert (ended.code, message in ended.err) == (2, True), ended.err
    assert not (dataset / "a.key").exists()


@pytest.mark.minisign
def test_minisign_verifies_what_we_sign(signed):
    for name in ("tagmanifest-sha256.txt", STATEMENT):
        ended = minisign("-V", "-H", "-p", KEYS / "plain.pub", "-m", signed / name)
        assert "Signature and comment signature verified" in ended.stdout, ended.stderr
        assert f"dataset:smoke version:1.0.0 time:{TIME} file:{name}" in ended.stdout


@pytest.mark.minisign
def test_we_verify_what_minisign_signs(signed, symolo, tmp_path):
    secret, public = tmp_path / "m.key", tmp_path / "m.pub"
    assert minisign("-G", "-W", "-s", secret, "-p", public).returncode == 0
    for name in ("tagmanifest-sha256.txt", STATEMENT):
        assert minisign("-S", "-W", "-s", secret, "-m", signed / name).returncode == 0
    ended = verified(symolo, signed, public)
    assert ended.code == 0, ended.out
    assert "file:tagmanifest-sha256.txt hashed)" in ended.out


@pytest.mark.minisign
def test_minisign_opens_the_keys_that_we_make(symolo, tmp_path):
    """`-R` writes the public key that belongs to a secret one; the passphrase takes scrypt with 1 GiB of memory."""
    (tmp_path / "words.txt").write_text("pass word\n")
    made = tmp_path / "ours.key"
    ended = symolo("sign", "--new-key", made, "--passphrase-file", tmp_path / "words.txt")
    assert ended.code == 0, ended.err
    assert minisign("-R", "-s", made, "-p", tmp_path / "again.pub", answers="pass word\n").returncode == 0
    assert (tmp_path / "again.pub").read_text() == (tmp_path / "ours.pub").read_text()
