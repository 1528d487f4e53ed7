"""Addresses of stores: the store that a URL names."""

import os
import re
from pathlib import Path

from symolo.core.errors import InputError
from symolo.core.files.paths import check_path
from symolo.storage.base import Store
from symolo.storage.bucket import Bucket
from symolo.storage.folder import Folder

ALLOWED = "s3://BUCKET/PREFIX, gs://BUCKET/PREFIX or file:///FOLDER"
BUCKET = re.compile(r"(?:s3|gs)://[a-z0-9][a-z0-9._-]{1,220}[a-z0-9](?:/[A-Za-z0-9._=+-]+)*/?")
ENDPOINT = re.compile(r"https?://[A-Za-z0-9.-]+(?::\d{1,5})?/?")
ENDPOINTS = ("AWS_ENDPOINT_URL_S3", "AWS_ENDPOINT_URL", "AWS_ENDPOINT")
"""Environment variables from which the library takes the endpoint."""


def store_of(url: str, endpoint: str | None = None, *, allow_http: bool = False) -> Store:
    """Return the store of an address; no request is sent yet.

    Args:
        url: An address in one of the forms of `ALLOWED`.
        endpoint: Address of a server that speaks S3; None for that of the environment.
        allow_http: Whether requests may go unencrypted.

    Raises:
        InputError: The address has another form, or may hold a secret; then the message does not repeat it.
        EnvironmentLacking: obstore is not installed, or the environment holds no key.
    """
    _check_secrets("URL", url)
    if url.startswith("file://"):
        path = Path(url.removeprefix("file://"))
        if not path.is_absolute() or ".." in path.parts or "%" in url:
            allowed = "file:// and an absolute path without .. and %, such as file:///mnt/data"
            raise InputError("URL", got=url, allowed=allowed)
        check_path(path, "URL")
        if path.exists() and not path.is_dir():
            raise InputError("is not a folder", where=url)
        return Folder(url.rstrip("/"), path)
    if not BUCKET.fullmatch(url) or {".", ".."} & {*url.split("/")[3:]}:
        raise InputError("URL", got=url, allowed=ALLOWED)
    if endpoint is not None and not url.startswith("s3://"):
        raise InputError("--endpoint", got=endpoint, cure="leave it out: only s3:// has an endpoint")
    named = {"--endpoint": endpoint} if endpoint is not None else {name: os.environ.get(name) for name in ENDPOINTS}
    for where, address in named.items():
        if address and url.startswith("s3://"):
            _check_endpoint(where, address, allow_http=allow_http)
    return Bucket.open(url.rstrip("/"), endpoint, allow_http=allow_http)


def _check_secrets(where: str, text: str) -> None:
    if re.search(r"[@?#]", text):
        what = "contains a name, a key or a query, which could end up in a log"
        raise InputError(what, where=where, cure="give keys only in environment variables, see docs/storage.md")


def _check_endpoint(where: str, endpoint: str, *, allow_http: bool) -> None:
    _check_secrets(where, endpoint)
    if not ENDPOINT.fullmatch(endpoint):
        raise InputError(where, got=endpoint, allowed="https://HOST or https://HOST:PORT")
    if endpoint.startswith("http:") and not allow_http:
        cure = "use https://, or give --allow-http if the connection is safe"
        raise InputError("sends everything unencrypted", where=f"{where} {endpoint}", cure=cure)
