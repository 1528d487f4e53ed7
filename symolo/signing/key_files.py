"""The two files of a pair of keys: the secret one, which only its owner may read, and the public one."""

import re
from collections.abc import Callable
from pathlib import Path

from symolo.core.errors import InputError
from symolo.core.files.atomic_files import remove_file, write_file
from symolo.core.files.plain_files import FileKind, read_named_file
from symolo.signing.minisign import MAX_BYTES, PublicKey
from symolo.signing.secret_key import SecretKey, SecretKeyFile

PUBLIC_SUFFIX = ".pub"
OWNER_ALONE = 0o600
_BASE64_KEY = re.compile(r"RW[A-Za-z0-9+/]{54}")
"""A public key without its file, as minisign prints it."""


def public_key_path(secret: Path) -> Path:
    """Return where the public key is written that belongs to a new secret key."""
    return secret.with_suffix(PUBLIC_SUFFIX)


def write_new_keys(secret: Path, passphrase: str) -> PublicKey:
    """Make a pair of keys and write both files; the secret key is encrypted unless the passphrase is empty.

    Raises:
        InputError: One of the files is there already; no key is ever replaced.
    """
    public = public_key_path(secret)
    for path in (secret, public):
        if path.exists() or path.is_symlink():
            raise InputError("is there already", where=f"--new-key {path}", cure="name a new file")
    if not secret.absolute().parent.is_dir():
        raise InputError("lies in a folder that is not there", where=f"--new-key {secret}", cure="make the folder")
    if secret == public:
        raise InputError("is the name of a public key", where=f"--new-key {secret}", cure="name it symolo.key")
    key = SecretKey.new()
    write_file(public, key.public.to_text().encode())
    try:
        write_file(secret, key.to_text(passphrase).encode(), OWNER_ALONE)
    except BaseException:
        remove_file(public)  # of a key that nobody has
        raise
    return key.public


def read_public_key(key: str) -> PublicKey:
    """Read the public key from a file, or from the 56 characters that such a file ends with.

    Raises:
        InputError: It is no public key.
    """
    if _BASE64_KEY.fullmatch(key) and not Path(key).exists():
        return PublicKey.from_text(key)
    text = _text_of(Path(key))
    try:
        return PublicKey.from_text(text)
    except ValueError as error:
        cure = "name the public key, such as symolo.pub"
        if _is_read_by(SecretKeyFile.from_text, text):
            raise InputError("is a secret key", where=f"--key {key}", cure=cure) from None
        raise InputError(f"is no public key of minisign: {error}", where=f"--key {key}", cure=cure) from None


def read_secret_key(path: Path, passphrase: Callable[[], str]) -> SecretKey:
    """Read the secret key from its file.

    Args:
        path: The file.
        passphrase: Called for the passphrase, and only if the file is encrypted.

    Raises:
        InputError: It is no secret key, or the passphrase is wrong.
    """
    text, cure = _text_of(path), "name the secret key, such as symolo.key"
    try:
        content = SecretKeyFile.from_text(text)
    except ValueError as error:
        if _is_read_by(PublicKey.from_text, text):
            raise InputError("is a public key", where=f"--key {path}", cure=cure) from None
        raise InputError(f"is no secret key of minisign: {error}", where=f"--key {path}", cure=cure) from None
    try:
        return content.opened(passphrase() if content.encrypted else "")
    except ValueError as error:
        raise InputError(str(error), where=f"--key {path}", cure="try again, or use a copy of the key") from None


def _text_of(path: Path) -> str:
    try:
        if path.is_file() and path.stat().st_size > MAX_BYTES:
            raise InputError("is no key: it is too large", where=f"--key {path}")
        return read_named_file(path, FileKind.DOCUMENT).decode("utf-8")
    except UnicodeDecodeError:
        raise InputError("is no key: it is no text", where=f"--key {path}") from None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", where=f"--key {path}") from None


def _is_read_by(read: Callable[[str], object], text: str) -> bool:
    try:
        read(text)
    except ValueError:
        return False
    return True
