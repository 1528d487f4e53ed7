"""Keys and signatures in the formats of minisign; what is expected is in RFC 8032 and in files of minisign 0.11."""

import errno
import time
from pathlib import Path

import pytest

from symolo.core.errors import InputError
from symolo.core.files.atomic_files import write_file
from symolo.signing.ed25519 import is_signature, public_key, sign
from symolo.signing.key_files import read_public_key, read_secret_key, write_new_keys
from symolo.signing.minisign import PublicKey, Signature, name_of
from symolo.signing.secret_key import SecretKey, SecretKeyFile, scrypt_parameters

MADE = Path(__file__).parent / "made_by_minisign"
DATA = (MADE / "list.txt").read_bytes()
PUBLIC = PublicKey.from_text((MADE / "plain.pub").read_text())


def signature(name="list.txt.minisig"):
    return Signature.from_bytes((MADE / name).read_bytes())


def secret_key():
    return SecretKeyFile.from_text((MADE / "plain.key").read_text()).opened("")


def test_ed25519_is_that_of_rfc_8032():
    """Section 7.1, test 2."""
    seed = bytes.fromhex("4ccd089b28ff96da9db6c346ec114e0f5b8a319f35aba624da8cf6ed4fb8a6fb")
    public = bytes.fromhex("3d4017c3e843895a92b70aa74d1b7ebc9c982ccf2ec4968cc0cd55f12af4660c")
    signed = bytes.fromhex(
        "92a009a9f0d4cab8720e820b5f642540a2b27b5416503f8fb3762223ebdb69da"
        "085ac1e43e15996e458f3613d0f11d8c387b2eaeb4302aeeb00d291612bb0c00"
    )
    assert public_key(seed) == public
    assert sign(seed, b"\x72") == signed
    assert is_signature(public, signed, b"\x72")
    assert not is_signature(public, signed, b"\x73")
    assert not is_signature(bytes(31) + b"\x80", signed, b"\x72"), "no point of the curve"


def test_a_public_key_is_read_and_written_as_minisign_writes_it():
    assert PUBLIC.name == "5A234EBCF96E609A", "the number that minisign prints"
    assert PUBLIC.to_text() == (MADE / "plain.pub").read_text()
    assert read_public_key(str(MADE / "plain.pub")) == PUBLIC
    assert read_public_key((MADE / "plain.pub").read_text().splitlines()[1]) == PUBLIC


@pytest.mark.parametrize("name", ["list.txt.minisig", "unhashed.minisig"])
def test_what_minisign_has_signed_is_recognised(name):
    assert signature(name).problem(PUBLIC, DATA) == ""
    assert "was not made by the key" not in signature(name).problem(PUBLIC, DATA + b"\n")
    assert "is by this key, but of other content" in signature(name).problem(PUBLIC, DATA + b"\n")


def test_our_signature_has_the_bytes_of_minisign():
    """Ed25519 leaves nothing to chance, so the same key, data and comment have one signature."""
    made = signature()
    ours = secret_key().sign(DATA, made.comment)
    assert ours == made
    assert ours.to_bytes("signature from minisign secret key") == (MADE / "list.txt.minisig").read_bytes()


def test_the_trusted_comment_is_part_of_what_is_signed():
    made = (MADE / "list.txt.minisig").read_text().replace("version:1.0.0", "version:2.0.0")
    problem = Signature.from_bytes(made.encode()).problem(PUBLIC, DATA)
    assert problem == "was changed: its trusted comment is not the one that was signed"


def test_another_key_is_named_by_its_number():
    other = SecretKey.new()
    assert signature().problem(other.public, DATA) == (
        f"was made by the key 5A234EBCF96E609A, not by the key {other.public.name}"
    )
    same_number = PublicKey(PUBLIC.key_id, other.public.key)
    assert signature().problem(same_number, DATA).startswith("was not made by the key 5A234EBCF96E609A")


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        (lambda text: text[:0], "it has four lines, this has 0"),
        (lambda text: text[: len(text) // 2], "it has four lines, this has 2"),
        (lambda text: text[:-10], "line 4: its Base64"),
        (lambda text: text + "more\n", "it has four lines, this has 5"),
        (lambda text: text.replace("trusted comment: d", "comment: d"), "line 3 does not begin with"),
        (lambda text: text.replace("RUS", "!US", 1), "line 2: its Base64 cannot be read"),
        (lambda text: text.replace("RUS", "RWS", 1).replace("RWS", "AAS", 1), "line 2 is of another algorithm"),
    ],
)
def test_a_broken_signature_file_is_described(change, problem):
    text = (MADE / "list.txt.minisig").read_text()
    with pytest.raises(ValueError, match=problem):
        Signature.from_bytes(change(text).encode())


def test_line_ends_of_windows_change_nothing():
    text = (MADE / "list.txt.minisig").read_bytes().replace(b"\n", b"\r\n")
    assert Signature.from_bytes(text).problem(PUBLIC, DATA) == ""


def test_an_encrypted_secret_key_of_minisign_is_opened_by_its_passphrase():
    """It takes scrypt with 1 GiB of memory, so that a wrong passphrase is left to a key that takes less, below."""
    content = SecretKeyFile.from_text((MADE / "encrypted.key").read_text())
    assert content.opened("correct horse").public == PublicKey.from_text((MADE / "encrypted.pub").read_text())


@pytest.mark.parametrize(
    ("operations", "memory_bytes", "parameters"),
    [
        (1 << 25, 1 << 30, (1 << 20, 8, 1)),
        (1 << 19, 1 << 24, (1 << 14, 8, 1)),
    ],
)
def test_scrypt_is_asked_for_what_libsodium_documents(operations, memory_bytes, parameters):
    """Its limits `sensitive` and `interactive` are those of Percival's paper: N of 2^20 and 2^14, r of 8, p of 1."""
    assert scrypt_parameters(operations, memory_bytes) == parameters


def test_an_encrypted_key_comes_back(tmp_path):
    key = SecretKey.new()
    small = key.to_text("pass word", 1 << 19, 1 << 24)
    assert SecretKeyFile.from_text(small).opened("pass word") == key
    assert key.seed.hex() not in small
    (tmp_path / "small.key").write_text(small)
    assert read_secret_key(tmp_path / "small.key", lambda: "pass word") == key
    with pytest.raises(InputError, match="the passphrase is wrong"):
        read_secret_key(tmp_path / "small.key", lambda: "password")


def test_a_key_file_that_asks_for_too_much_memory_is_refused():
    greedy = SecretKeyFile(encrypted=True, salt=bytes(32), operations=1 << 60, memory_bytes=1 << 60, secret=bytes(104))
    with pytest.raises(ValueError, match="GiB of memory"):
        greedy.opened("x")


def test_a_disk_that_is_full_before_the_second_key_leaves_none(tmp_path, monkeypatch):
    written = []

    def write(path, data, *mode):
        if written:
            raise OSError(errno.ENOSPC, "No space left on device", str(path))
        written.append(path)
        write_file(path, data, *mode)

    with monkeypatch.context() as patch:
        patch.setattr("symolo.signing.key_files.write_file", write)
        with pytest.raises(OSError, match="No space"):
            write_new_keys(tmp_path / "a.key", "")
    assert len(written) == 1
    assert list(tmp_path.iterdir()) == []
    write_new_keys(tmp_path / "a.key", "")


def test_new_keys_are_written_once_and_the_secret_one_is_for_its_owner(tmp_path):
    secret = tmp_path / "symolo.key"
    public = write_new_keys(secret, "")
    assert read_public_key(str(tmp_path / "symolo.pub")) == public
    assert read_secret_key(secret, str).public == public
    with pytest.raises(InputError, match="is there already"):
        write_new_keys(secret, "")


def test_one_key_in_the_place_of_the_other_is_named():
    with pytest.raises(InputError, match="is a secret key; name the public key"):
        read_public_key(str(MADE / "plain.key"))
    with pytest.raises(InputError, match="is a public key; name the secret key"):
        read_secret_key(MADE / "plain.pub", str)
    with pytest.raises(InputError, match="is no public key of minisign: its first line does not begin with"):
        read_public_key(str(MADE / "list.txt"))


def test_a_missing_key_is_named(tmp_path):
    with pytest.raises(InputError, match="cannot be read: No such file"):
        read_public_key(str(tmp_path / "none.pub"))


def test_the_number_of_a_key_has_no_leading_zeros():
    """minisign 0.11 prints this number for these bytes, as `minisign -R` shows."""
    assert name_of(bytes([1, 2, 3, 4, 5, 6, 7, 0])) == "7060504030201"


@pytest.mark.parametrize(("operations", "memory_bytes"), [(1 << 28, 1 << 30), (1 << 36, 1 << 24), (1 << 60, 1 << 20)])
def test_a_key_file_that_asks_for_hours_is_refused_before_them(operations, memory_bytes):
    slow = SecretKeyFile(
        encrypted=True, salt=bytes(32), operations=operations, memory_bytes=memory_bytes, secret=bytes(104)
    )
    begin = time.process_time()
    with pytest.raises(ValueError, match="times as long to check as usual"):
        slow.opened("password")
    assert time.process_time() - begin < 1.0
