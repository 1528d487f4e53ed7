"""Which store a URL names."""

import re
from pathlib import Path

from configs.errors import InputError
from pipeline.storage.base import Store
from pipeline.storage.bucket import Bucket
from pipeline.storage.folder import Folder

ALLOWED = "s3://BUCKET/PREFIX, gs://BUCKET/PREFIX or file:///FOLDER"
BUCKET = re.compile(r"(?:s3|gs)://[a-z0-9][a-z0-9._-]{1,220}[a-z0-9](?:/[A-Za-z0-9._=+-]+)*/?")
ENDPOINT = re.compile(r"(https?)://[A-Za-z0-9.-]+(?::\d{1,5})?/?")


def store_of(url: str, endpoint: str | None = None, *, allow_http: bool = False) -> Store:
    """The store of an address; nothing is reached yet.

    Args:
        url: As `ALLOWED` says.
        endpoint: Of a server that speaks S3.
        allow_http: Whether requests may go unencrypted.

    Raises:
        InputError: It is none, or holds what may be a secret; then it is not repeated.
        EnvironmentLacking: As `Bucket.open`.
    """
    for where, text in (("URL", url), ("--endpoint", endpoint or "")):
        if re.search(r"[@?#]", text):
            what = "holds a name, a key or a query, which a log would keep"
            raise InputError(what, where=where, cure="name keys by the environment alone, see docs/storage.md")
    if url.startswith("file://"):
        return _folder(url)
    parts = url.split("/")[3:]
    if not BUCKET.fullmatch(url) or {".", ".."} & {*parts}:
        raise InputError("URL", got=url, allowed=ALLOWED)
    if endpoint is not None:
        _check_endpoint(url, endpoint, allow_http=allow_http)
    return Bucket.open(url.rstrip("/"), endpoint, allow_http=allow_http)


def _folder(url: str) -> Folder:
    path = Path(url.removeprefix("file://"))
    if not path.is_absolute() or ".." in path.parts or "%" in url:
        raise InputError("URL", got=url, allowed="file:// and a whole path without .. and %, such as file:///mnt/data")
    if path.exists() and not path.is_dir():
        raise InputError("is no folder", where=url)
    return Folder(url.rstrip("/"), path)


def _check_endpoint(url: str, endpoint: str, *, allow_http: bool) -> None:
    found = ENDPOINT.fullmatch(endpoint)
    if not found:
        raise InputError("--endpoint", got=endpoint, allowed="https://HOST or https://HOST:PORT")
    if not url.startswith("s3://"):
        raise InputError("--endpoint", got=endpoint, cure="leave it out: it is of s3:// alone")
    if found.group(1) == "http" and not allow_http:
        cure = "name it by https://, or say --allow-http where the line is safe"
        raise InputError("sends everything unencrypted", where=f"--endpoint {endpoint}", cure=cure)
