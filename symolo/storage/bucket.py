"""A bucket of an object store (S3 and what speaks like it, Google Cloud Storage), by the library obstore.

The library signs requests, sends large files in parts, and tries again with growing pauses. It takes keys from the
environment only, and so do we: a key is never an argument and never part of a message.
"""

import asyncio
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
from symolo.core.files.plain_files import FileKind
from symolo.storage.base import CHUNK_BYTES, LocalFile

SHA256 = "sha256"
"""Name of the metadata that holds an object's SHA-256; `x-amz-meta-sha256` on the wire to S3."""
PARTS_AT_ONCE = 2
RETRIES = 12
"""Number of retries of a request, with pauses that double from 0.1 s up to 15 s."""
TIMEOUT = "5m"
"""Longest time of a request with its body; a part of 8 MiB takes minutes on a slow line, the default is 30 s."""

LIST_S = 600.0
"""Longest time for a thousand entries of a listing; each answer is limited by `TIMEOUT`, but a row of them is not."""
MAX_OBJECTS = 3_000_000
"""Largest number of files of a release. A list of checksums of the largest size that is read names about as many."""
MAX_OBJECT_BYTES = FileKind.ANY.max_bytes

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
"""Variables of which at least one must be set; otherwise the library would request keys from an address of its own."""
KEY_CURES = {
    "s3": "set AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY, or AWS_SKIP_SIGNATURE=true if the store is public",
    "gs": "set GOOGLE_APPLICATION_CREDENTIALS to a key file, or GOOGLE_SKIP_SIGNATURE=true if the store is public",
}


class Bucket:
    """Objects below a prefix of a bucket."""

    def __init__(self, url: str, store: Any) -> None:  # noqa: ANN401 - one of the library's stores
        self.url = url
        self._store = store
        self._obstore = _library()

    @classmethod
    def open(cls, url: str, endpoint: str | None, *, allow_http: bool) -> "Bucket":
        """Return the bucket of a checked address; no request is sent yet.

        Args:
            url: `s3://bucket/prefix` or `gs://bucket/prefix`.
            endpoint: Address of a server that speaks S3; None for that of the environment, or Amazon's.
            allow_http: Whether requests may go unencrypted.

        Raises:
            EnvironmentLacking: The library is not installed, or no variable holds a key.
        """
        stores = _library().store
        kind = url.partition(":")[0]
        if not any(os.environ.get(name) for name in KEYS[kind]):
            raise EnvironmentLacking(f"{url}: no environment variable has a key for it; {KEY_CURES[kind]}")
        options = {"timeout": TIMEOUT, **({"allow_http": True} if allow_http else {})}
        chosen = {"endpoint": endpoint} if endpoint else {}
        store_class = stores.S3Store if kind == "s3" else stores.GCSStore
        with _plain_errors(url):
            store = store_class.from_url(url, client_options=options, retry_config={"max_retries": RETRIES}, **chosen)
        return cls(url, store)

    def locked(self) -> AbstractContextManager[None]:
        """Return a context without a lock: an object is replaced at once, and two senders send the same bytes."""
        return nullcontext()

    def sweep(self) -> None:
        """Do nothing: parts of an unfinished upload are no object, and the rules of the bucket remove them."""

    def sizes(self) -> dict[str, int]:
        with _plain_errors(self.url):
            return asyncio.run(self._listed())

    async def _listed(self) -> dict[str, int]:
        """Return the sizes; a server that lists without end is given up, and the wait for it can be interrupted."""
        sizes: dict[str, int] = {}
        parts = aiter(self._obstore.list(self._store, chunk_size=1000))
        while (part := await asyncio.wait_for(anext(parts, None), LIST_S)) is not None:
            sizes |= {entry["path"]: entry["size"] for entry in part}
            if len(sizes) > MAX_OBJECTS:
                what = f"holds more than {MAX_OBJECTS} objects, as no release does"
                raise InputError(what, where=self.url, cure="name the place of one release")
        return sizes

    def digest(self, name: str) -> str:
        with _plain_errors(self.url):
            head = self._obstore.get(self._store, name, options={"head": True})
            return str(head.attributes.get(SHA256, ""))

    def put(self, file: LocalFile) -> None:
        # Python's own table; that of the module `mimetypes` would also read files of the machine.
        media_type = mimetypes.MimeTypes().guess_type(file.name)[0] or "application/octet-stream"
        with _plain_errors(self.url):
            self._obstore.put(
                self._store,
                file.name,
                file.chunks(),
                attributes={SHA256: file.digest, "Content-Type": media_type},
                use_multipart=file.size_bytes > CHUNK_BYTES,
                chunk_size=CHUNK_BYTES,
                max_concurrency=PARTS_AT_ONCE,
            )

    def get(self, name: str) -> bytes | None:
        with _plain_errors(self.url):
            try:
                answer = self._obstore.get(self._store, name)
                # The library allocates the announced size at once, and ends the process where it gets no memory.
                if answer.meta["size"] > MAX_OBJECT_BYTES:
                    allowed = f"at most {MAX_OBJECT_BYTES} bytes"
                    raise InputError(
                        "is no file of a release", where=f"{self.url}: {name}", got=answer.meta["size"], allowed=allowed
                    )
                return bytes(answer.bytes())
            except FileNotFoundError:
                return None


@contextlib.contextmanager
def _plain_errors(url: str) -> Iterator[None]:
    """Raise errors of the library as errors of ours, in one line with the code that the server sent and no more."""
    errors, key_cure = _library().exceptions, KEY_CURES[url.partition(":")[0]]
    try:
        yield
    except FileNotFoundError as error:
        raise EnvironmentLacking(f"{url}: has changed meanwhile: {_short(error)}; run the same command again") from None
    except asyncio.TimeoutError:
        cure = "see that the address is that of a store"
        raise EnvironmentLacking(f"{url}: has listed nothing more for {LIST_S:g} s; {cure}") from None
    except (errors.BaseError, NotImplementedError, ValueError) as error:
        if "<Code>NoSuchBucket<" in str(error):
            raise InputError("there is no such bucket", where=url, cure="make it with the tools of the store") from None
        refused = isinstance(error, errors.PermissionDeniedError | errors.UnauthenticatedError)
        if refused or re.search(r"status code: 40[13]\b", str(error)):  # a refused listing is of no class of its own
            raise EnvironmentLacking(f"{url}: the store refuses access: {_short(error)}; {key_cure}") from None
        cure = "check the address and the network, and run the same command again"
        raise EnvironmentLacking(f"{url}: {_short(error)}; {cure}") from None


def _short(error: Exception) -> str:
    """Return request, answer and the server's code, without the time it took and the page that the server sent."""
    text = str(error)
    code = re.search(r"<Code>(\w{1,60})</Code>", text)
    head = re.split(r":\s*<|\s+Debug source", text, maxsplit=1)[0]
    request = re.search(r"Error performing (\w+ \S+) in .*?\s-\s+(.*)", head, re.DOTALL)
    message = f"{request.group(1)}: {request.group(2)}" if request else head
    return one_line(message[:400] + (f": {code.group(1)}" if code else ""))


def _library() -> ModuleType:
    try:
        import obstore  # noqa: PLC0415 - an extra
    except ImportError as error:
        raise EnvironmentLacking(f"obstore cannot be loaded: {error}; {how_to_install('cloud')}") from None
    return obstore
