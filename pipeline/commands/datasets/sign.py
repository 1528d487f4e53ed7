"""The command `symolo sign`: keys, and signatures of releases."""

import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import checked_input, if_given

PASSPHRASE_VARIABLE = "SYMOLO_PASSPHRASE"  # noqa: S105 - the name of a variable


def _checked_new_key(path: Path) -> Path:
    from symolo.core.files.paths import check_new_path
    from symolo.dataset.folder_kind import check_outside

    check_new_path(path, "--new-key")
    check_outside(path, f"--new-key {path}")
    return path


def sign(
    folder: Annotated[
        Path | None,
        typer.Argument(
            metavar="DIR", callback=if_given(checked_input), help="Dataset: the folder that holds metadata.json."
        ),
    ] = None,
    *,
    key: Annotated[
        Path | None,
        typer.Option(
            "--key", metavar="FILE", callback=if_given(checked_input), help="Secret key, made by minisign or --new-key."
        ),
    ] = None,
    release_version: Annotated[
        str, typer.Option("--release-version", metavar="X.Y.Z", help="Version that the signature states.")
    ] = "1.0.0",
    time: Annotated[
        str | None,
        typer.Option(
            "--time",
            metavar="TIME",
            help="Time that the signature states, such as 2026-11-23T16:00:00Z; by default SOURCE_DATE_EPOCH or now.",
        ),
    ] = None,
    provenance: Annotated[
        bool,
        typer.Option(
            "--provenance", help="Also write and sign provenance.intoto.json, which states how the data were made."
        ),
    ] = False,
    new_key: Annotated[
        Path | None,
        typer.Option(
            "--new-key",
            metavar="FILE",
            callback=if_given(_checked_new_key),
            help="Make a pair of keys and sign nothing: FILE is the secret key, FILE with suffix .pub the public key.",
        ),
    ] = None,
    passphrase_file: Annotated[
        Path | None,
        typer.Option(
            "--passphrase-file",
            metavar="FILE",
            callback=if_given(checked_input),
            help="File whose first line is the passphrase of the key; by default SYMOLO_PASSPHRASE, or a prompt.",
        ),
    ] = None,
    no_passphrase: Annotated[
        bool, typer.Option("--no-passphrase", help="With --new-key: do not encrypt the secret key.")
    ] = False,
) -> None:
    """Sign a dataset, so that `symolo verify --key` and minisign detect a forged one.

    The signature is tagmanifest-sha256.txt.minisig, in the format of minisign (Ed25519). A dataset with a fault is
    refused. No other file of the dataset changes.

    Example: symolo sign --new-key symolo.key

    Example: symolo sign data --key symolo.key --release-version 1.0.0
    """
    from symolo.core.errors import InputError

    if new_key is not None:
        if folder is not None or key is not None:
            raise InputError("--new-key", cure="give it alone: first make the keys, then sign with the secret one")
        _make_keys(new_key, passphrase_file, encrypted=not no_passphrase)
        return
    if folder is None or key is None:
        raise InputError("name a dataset and --key FILE, or --new-key FILE", cure="see `symolo sign --help`")
    if no_passphrase:
        raise InputError("--no-passphrase", cure="give it with --new-key")
    _sign(folder, key, passphrase_file, release_version, time, with_provenance=provenance)


def _sign(
    folder: Path, key: Path, passphrase_file: Path | None, version: str, time: str | None, *, with_provenance: bool
) -> None:
    import re

    from pipeline.run_folder.stored_spec import spec_problem
    from symolo.core.errors import InputError
    from symolo.core.files.paths import check_folder
    from symolo.dataset.folder_kind import NAME_DATASET
    from symolo.dataset.manifest import PROVENANCE, SIGNATURE
    from symolo.publishing.signing import SignedFacts, sign_release, signing_time
    from symolo.signing.key_files import read_secret_key

    if not re.fullmatch(r"\d+\.\d+\.\d+", version):
        raise InputError("--release-version", got=version, allowed="a version such as 1.0.0")
    facts = SignedFacts(version, signing_time(time))
    check_folder(folder, NAME_DATASET)
    secret = read_secret_key(key, lambda: _passphrase(passphrase_file, new=False))
    comment = sign_release(folder, secret, facts, spec_problem, with_provenance=with_provenance)
    if with_provenance:
        typer.echo(f"{folder / PROVENANCE}: signed by the key {secret.public.name}")
    typer.echo(f"{folder / SIGNATURE}: signed by the key {secret.public.name} ({comment})")


def _make_keys(secret: Path, passphrase_file: Path | None, *, encrypted: bool) -> None:
    from symolo.signing.key_files import public_key_path, write_new_keys

    public = write_new_keys(secret, _passphrase(passphrase_file, new=True) if encrypted else "")
    typer.echo(f"{secret}: the secret key {public.name}; keep it secret, and keep a copy of it")
    typer.echo(f"{public_key_path(secret)}: the public key; publish it, but not in the same place as your datasets")


def _passphrase(file: Path | None, *, new: bool) -> str:
    """Return the passphrase from a file, the environment or the terminal. Others could see it on a command line.

    Raises:
        InputError: There is none.
    """
    from symolo.core.errors import InputError

    if file is not None:
        try:
            lines = file.read_text(encoding="utf-8").splitlines()
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"cannot be read: {error}", where=f"--passphrase-file {file}") from None
        passphrase, where = (lines[0] if lines else ""), f"--passphrase-file {file}"
    elif PASSPHRASE_VARIABLE in os.environ:
        passphrase, where = os.environ[PASSPHRASE_VARIABLE], PASSPHRASE_VARIABLE
    elif sys.stdin.isatty():
        passphrase, where = (
            typer.prompt("Passphrase of the key", hide_input=True, confirmation_prompt=new),
            "passphrase",
        )
    else:
        cure = f"give it with --passphrase-file FILE or {PASSPHRASE_VARIABLE}"
        cure += ", or give --no-passphrase" if new else ""
        raise InputError("the key has a passphrase, and there is no terminal to ask for it", cure=cure)
    if not passphrase:
        raise InputError(
            "is empty", where=where, cure="give --no-passphrase for a key without a passphrase" if new else ""
        )
    return passphrase
