"""A bucket of an object store (S3 and what speaks like it, Google Cloud Storage), by the library obstore.

The library signs requests, sends large files in parts, and tries again with growing pauses. It takes keys from the
environment alone, and so do we: none is ever an argument, or told in a message.
"""

import contextlib
import mimetypes
import os
import re
from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from types import ModuleType
from typing import Any

from symolo.core.errors import EnvironmentLacking, InputError, one_line
from symolo.core.extras import how_to_install
from symolo.storage.base import CHUNK_BYTES, LocalFile

SHA256 = "sha256"
"""Name of the metadata that holds an object's SHA-256; `x-amz-meta-sha256` on the wire to S3."""
PARTS_AT_ONCE = 2
RETRIES = 12
"""Of each request, with pauses from 0.1 s that double, up to 15 s."""
TIMEOUT = "5m"
"""Of a request with its body: a part of 8 MiB on a slow line takes minutes, and 30 s are the library's default."""

KEYS = {
    "s3": (
        "AWS_ACCESS_KEY_ID",
        "AWS_SKIP_SIGNATURE",
        "AWS_WEB_IDENTITY_TOKEN_FILE",
        "AWS_CONTAINER_CREDENTIALS_RELATIVE_URI",
        "AWS_CONTAINER_CREDENTIALS_FULL_URI",
        "AWS_METADATA_ENDPOINT",
    ),
    "gs": (
        "GOOGLE_APPLICATION_CREDENTIALS",
        "GOOGLE_SERVICE_ACCOUNT",
        "GOOGLE_SERVICE_ACCOUNT_PATH",
        "GOOGLE_SERVICE_ACCOUNT_KEY",
        "GOOGLE_BEARER_TOKEN",
        "GOOGLE_SKIP_SIGNATURE",
    ),
}
"""Variables any one of which says who we are. Without any, the library would ask an address of its own choice."""
KEY_CURES = {
    "s3": "set AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY, or AWS_SKIP_SIGNATURE=true where anybody may read",
    "gs": "set GOOGLE_APPLICATION_CREDENTIALS to the key's file, or GOOGLE_SKIP_SIGNATURE=true where anybody may read",
}


class Bucket:
    """Objects below a prefix of a bucket."""

    def __init__(self, url: str, store: Any) -> None:  # noqa: ANN401 - one of the library's stores
        self.url = url
        self._store = store
        self._obstore = _library()

    @classmethod
    def open(cls, url: str, endpoint: str | None, *, allow_http: bool) -> "Bucket":
        """Of a checked address; nothing is reached yet.

        Args:
            url: `s3://bucket/prefix` or `gs://bucket/prefix`.
            endpoint: Address of a server that speaks S3; Amazon's where None and the environment names none.
            allow_http: Whether requests may go unencrypted.

        Raises:
            EnvironmentLacking: The library is not there, or no variable says who we are.
        """
        stores = _library().store
        kind = url.partition(":")[0]
        if not any(os.environ.get(name) for name in KEYS[kind]):
            raise EnvironmentLacking(f"{url}: the environment holds no key to it; {KEY_CURES[kind]}")
        options = {"timeout": TIMEOUT, **({"allow_http": True} if allow_http else {})}
        chosen = {"endpoint": endpoint} if endpoint else {}
        of_kind = stores.S3Store if kind == "s3" else stores.GCSStore
        with _told(url, kind):
            store = of_kind.from_url(url, client_options=options, retry_config={"max_retries": RETRIES}, **chosen)
        return cls(url, store)

    def held(self) -> AbstractContextManager[None]:
        """Nobody holds a bucket: an object is replaced at once, and two who send the same release send the same."""
        return nullcontext()

    def sweep(self) -> None:
        """Nothing: of a part that was sent no object comes, and the bucket's own rules remove it."""

    def sizes(self) -> dict[str, int]:
        with self._told():
            return {
                one["path"]: one["size"] for part in self._obstore.list(self._store, chunk_size=1000) for one in part
            }

    def digest(self, name: str) -> str:
        with self._told():
            told = self._obstore.get(self._store, name, options={"head": True})
            return str(told.attributes.get(SHA256, ""))

    def put(self, file: LocalFile) -> None:
        kind = mimetypes.MimeTypes().guess_type(file.name)[0] or "application/octet-stream"
        with self._told():
            self._obstore.put(
                self._store,
                file.name,
                file.chunks(),
                attributes={SHA256: file.digest, "Content-Type": kind},
                use_multipart=file.size_bytes > CHUNK_BYTES,
                chunk_size=CHUNK_BYTES,
                max_concurrency=PARTS_AT_ONCE,
            )

    def get(self, name: str) -> bytes | None:
        with self._told():
            try:
                return bytes(self._obstore.get(self._store, name).bytes())
            except FileNotFoundError:
                return None

    def _told(self) -> AbstractContextManager[None]:
        return _told(self.url, self.url.partition(":")[0])


@contextlib.contextmanager
def _told(url: str, kind: str) -> Iterator[None]:
    """The library's errors as ours, each in one line without what the server sent beside its code."""
    errors = _library().exceptions
    try:
        yield
    except FileNotFoundError as error:
        raise EnvironmentLacking(f"{url}: has changed meanwhile: {_short(error)}; run the same command again") from None
    except (errors.BaseError, NotImplementedError, ValueError) as error:
        if "<Code>NoSuchBucket<" in str(error):
            raise InputError("there is no such bucket", where=url, cure="make it by the tools of the store") from None
        refused = isinstance(error, errors.PermissionDeniedError | errors.UnauthenticatedError)
        if refused or re.search(r"status code: 40[13]\b", str(error)):  # a refused listing is of no class of its own
            raise EnvironmentLacking(
                f"{url}: the store does not let us in: {_short(error)}; {KEY_CURES[kind]}"
            ) from None
        cure = "see that the address is right and the network is there, and run the same command again"
        raise EnvironmentLacking(f"{url}: {_short(error)}; {cure}") from None


def _short(error: Exception) -> str:
    """Request and answer, without how long it took and what the server sent, but for its code."""
    text = str(error)
    code = re.search(r"<Code>(\w{1,60})</Code>", text)
    head = re.split(r":\s*<|\s+Debug source", text, maxsplit=1)[0]
    found = re.search(r"Error performing (\w+ \S+) in .*?\s-\s+(.*)", head, re.DOTALL)
    told = f"{found.group(1)}: {found.group(2)}" if found else head
    return one_line(told[:400] + (f": {code.group(1)}" if code else ""))


def _library() -> ModuleType:
    try:
        import obstore  # noqa: PLC0415 - an extra
    except ImportError as error:
        raise EnvironmentLacking(f"obstore cannot be loaded: {error}; {how_to_install('cloud')}") from None
    return obstore
