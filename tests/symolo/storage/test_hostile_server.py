"""A server that speaks S3 and means harm, on this machine: a download ends in one line and leaves nothing behind.

It needs no package, but a network of this machine, which the other tests do without.
"""

import contextlib
import os
import resource
import subprocess
import sys
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import pytest

from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST

pytestmark = pytest.mark.cloud

FILE = "CW/test_1/images/000001.jpg"
HUGE = 1 << 45
SECONDS = 40.0
BYTES = 600 << 20
PROGRAM = (
    "import sys, symolo.storage.bucket as bucket\n"
    "bucket.TIMEOUT, bucket.RETRIES, bucket.LIST_S, bucket.MAX_OBJECTS = '3s', 1, 4.0, 20_000\n"
    "from pipeline.cli import main\n"
    "sys.exit(main())\n"
)
"""With times that a test can wait for, in place of minutes."""


def page(sizes, next_page=""):
    """A page of a listing, as the reference of Amazon's S3 has it (ListObjectsV2)."""
    entries = "".join(
        f"<Contents><Key>data/{name}</Key><LastModified>2026-01-01T00:00:00.000Z</LastModified><ETag>e</ETag>"
        f"<Size>{size}</Size></Contents>"
        for name, size in sizes.items()
    )
    more = f"<IsTruncated>true</IsTruncated><NextContinuationToken>{next_page}</NextContinuationToken>"
    more = more if next_page else "<IsTruncated>false</IsTruncated>"
    return f"<ListBucketResult><Name>bucket</Name><KeyCount>{len(sizes)}</KeyCount>{more}{entries}</ListBucketResult>"


class Server(ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, objects):
        super().__init__(("127.0.0.1", 0), Handler)
        self.objects, self.kind, self.pages = objects, "", 0
        threading.Thread(target=self.serve_forever, daemon=True).start()


class Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server: Any

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - as the class above calls it
        pass

    def do_GET(self):
        self.close_connection = True
        with contextlib.suppress(BrokenPipeError, ConnectionResetError):
            self.listing() if "?" in self.path else self.file(self.path.split("/data/", 1)[1])

    def answer(self, data=b"", length=None, status=200, **headers):
        self.send_response(status)
        standard = {"ETag": "e", "Last-Modified": "Thu, 01 Jan 2026 00:00:00 GMT"}
        if length != "none":
            standard["Content-Length"] = str(len(data) if length is None else length)
        for name, value in {**standard, **headers}.items():
            self.send_header(name.replace("_", "-"), value)
        self.end_headers()
        self.wfile.write(data)

    def forever(self, data=bytes(1 << 20), pause_s=0.0):
        while True:
            self.wfile.write(data)
            time.sleep(pause_s)

    def listing(self):
        kind, self.server.pages = self.server.kind, self.server.pages + 1
        sizes, number = {name: len(data) for name, data in self.server.objects.items()}, self.server.pages
        if kind == "a listing without end":
            self.answer(page({f"{number}/{k}": 1 for k in range(1000)}, f"t{number}").encode())
        elif kind == "a listing of nothing without end":
            self.answer(page({}, f"t{number}").encode())
        elif kind == "a slow listing":
            self.answer(length=1000)
            self.forever(b"<", 0.5)
        else:
            self.answer(page({**sizes, **({FILE: HUGE} if kind == "a size of terabytes" else {})}).encode())

    def file(self, name):
        kind, data = self.server.kind, self.server.objects[name]
        if name != (MANIFEST if "list of checksums" in kind else FILE):
            self.answer(data)
        elif "without end" in kind:
            self.answer(length=HUGE)
            self.forever()
        elif kind == "a body of unknown length":
            self.answer(length="none", Transfer_Encoding="chunked")
            self.forever(b"100000\r\n" + bytes(1 << 20) + b"\r\n")
        elif kind == "a shorter body":
            self.answer(data[:-1])
        elif kind == "a longer body":
            self.answer(data + b"x")
        elif kind == "a body that is cut off":
            self.answer(data[:5], len(data))
        elif kind == "a slow body":
            self.answer(length=len(data))
            self.forever(b"a", 0.5)
        elif kind == "endless headers":
            self.wfile.write(b"HTTP/1.1 200 OK\r\n")
            self.forever(b"X-A: " + b"a" * 1000 + b"\r\n")
        elif kind.startswith("a redirect to "):
            self.answer(status=302, Location={"a file": "file:///etc/passwd", "itself": self.path}[kind[14:]])
        else:
            self.answer(data)


WRONG = "does not match manifest-sha256.txt"
KINDS = {
    "a file without end": (2, "is no file of a release"),
    "a list of checksums without end": (2, "is no file of a release"),
    "a body of unknown length": (5, "Content-Length"),
    "a shorter body": (2, WRONG),
    "a longer body": (2, WRONG),
    "a body that is cut off": (5, "run the same command again"),
    "a slow body": (5, "run the same command again"),
    "endless headers": (5, "run the same command again"),
    "a redirect to a file": (5, "302 Found"),
    "a redirect to itself": (5, "run the same command again"),
    "a size of terabytes": (5, "MB are needed"),
    "a listing without end": (2, "holds more than 20000 objects"),
    "a listing of nothing without end": (5, "has listed nothing more for 4 s"),
    "a slow listing": (5, "run the same command again"),
}


@pytest.fixture
def fetched(release, tmp_path):
    """Downloads from a server of some kind; returns exit code and messages."""
    root = release()
    names = [FILE, "README.md", MANIFEST, TAG_MANIFEST, "metadata.json", "bag-info.txt"]
    names += [path.relative_to(root).as_posix() for path in root.rglob("*") if path.is_file()]
    server = Server({name: (root / name).read_bytes() for name in names})

    def fetch(kind):
        server.kind = kind
        address = ["s3://bucket/data", "--endpoint", f"http://127.0.0.1:{server.server_port}", "--allow-http"]
        environment = {**os.environ, "AWS_SKIP_SIGNATURE": "true", "AWS_REGION": "nowhere"}
        command = [sys.executable, "-c", PROGRAM, "download", *address, "--out", str(tmp_path / "out")]
        ended = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=SECONDS, check=False)
        return ended.returncode, ended.stderr

    yield fetch
    server.shutdown()
    server.server_close()


@pytest.mark.parametrize("kind", KINDS)
def test_what_such_a_server_sends_is_refused_in_one_line(kind, fetched, tmp_path):
    code, messages = fetched(kind)
    lines = [line for line in messages.splitlines() if line.startswith("symolo: ")]
    expected, words = KINDS[kind]
    assert (code, len(lines)) == (expected, 1), messages
    assert words in lines[0]
    assert "Traceback" not in messages
    assert not (tmp_path / "out").exists()
    assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024 < BYTES


def test_the_same_server_without_a_fault_is_downloaded_from(fetched, tmp_path):
    assert fetched("")[0] == 0
    assert (tmp_path / "out" / FILE).is_file()
