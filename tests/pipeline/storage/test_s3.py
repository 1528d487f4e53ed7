"""Upload and download by a server that speaks S3 on this machine: killed at random instants, refused, and in parts.

pip install "moto[server]", which no environment of ours has: it brings thirty packages and other versions of some.
"""

import json
import logging
import re
import signal
import threading
import time
from collections import Counter

import numpy as np
import pytest

from pipeline.storage.side_by_side import AT_ONCE

pytestmark = pytest.mark.cloud

KILLS, ROUNDS = 50, 10
SLOW_S = 0.05
"""Of each put, as on a line of some length, so that there is an upload to kill."""
SECRET = "s3cr3t-k3y"  # noqa: S105 - of nobody

LOG = logging.getLogger(__name__)


class Watched:
    """A WSGI application that notes each put when it begins and when it is stored."""

    def __init__(self, application):
        self._application, self._lock = application, threading.Lock()
        self.begun: Counter[str] = Counter()
        self.stored: Counter[str] = Counter()
        self.refusing = 0

    def __call__(self, environ, start_response):
        path, is_put = environ["PATH_INFO"], environ["REQUEST_METHOD"] == "PUT" and environ["PATH_INFO"].count("/") > 1
        if not is_put:
            return self._application(environ, start_response)
        with self._lock:
            self.begun[path] += 1
            refused, self.refusing = self.refusing > 0, max(0, self.refusing - 1)
        if refused:
            start_response("503 Slow Down", [("Content-Length", "0")])
            return [b""]
        time.sleep(SLOW_S)
        answer = list(self._application(environ, start_response))
        with self._lock:
            self.stored[path] += 1
        return answer

    def quiet(self, still_s=0.3):
        """Wait until what a killed process had sent is worked off."""
        before = None
        while before != self.begun.total() or self.begun != self.stored:
            before = self.begun.total()
            time.sleep(still_s)


@pytest.fixture(scope="module")
def server():
    pytest.importorskip("moto.server")
    from moto.moto_server.werkzeug_app import DomainDispatcherApplication, create_backend_app  # noqa: PLC0415 - see the top
    from werkzeug.serving import make_server  # noqa: PLC0415

    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    watched = Watched(DomainDispatcherApplication(create_backend_app))
    serving = make_server("127.0.0.1", 0, watched, threaded=True)
    thread = threading.Thread(target=serving.serve_forever, daemon=True)
    thread.start()
    yield watched, f"http://127.0.0.1:{serving.port}"
    serving.shutdown()
    thread.join()


@pytest.fixture
def at(server, monkeypatch):
    """The options that lead to the server, with a bucket that anybody may write to."""
    boto3 = pytest.importorskip("boto3")
    for name, value in (("ACCESS_KEY_ID", "name"), ("SECRET_ACCESS_KEY", SECRET), ("REGION", "us-east-1")):
        monkeypatch.setenv(f"AWS_{name}", value)
    boto3.client("s3", endpoint_url=server[1], region_name="us-east-1").create_bucket(Bucket="bucket")
    return ["--endpoint", server[1], "--allow-http"]


@pytest.fixture
def read_back(server):
    """All objects below a prefix, as Amazon's own library reads them."""
    boto3 = pytest.importorskip("boto3")

    def read(prefix):
        client = boto3.client("s3", endpoint_url=server[1], region_name="us-east-1")
        found = client.get_paginator("list_objects_v2").paginate(Bucket="bucket", Prefix=f"{prefix}/")
        keys = [one["Key"] for page in found for one in page.get("Contents", [])]
        return {key[len(prefix) + 1 :]: client.get_object(Bucket="bucket", Key=key)["Body"].read() for key in keys}

    return read


def _many(count):
    return {f"CW/test_{i % 3}/images/{i:06d}.jpg": bytes([i % 251]) * (1000 + i) for i in range(count)}


def test_killed_at_fifty_random_instants_it_sends_nothing_twice_but_what_was_in_flight(
    server, at, release, release_of, read_back, symolo, tmp_path
):
    root, chance, watched = release(**_many(390)), np.random.Generator(np.random.PCG64(5)), server[0]
    content, figures = release_of(root), []
    whole_s = SLOW_S * len(content) / AT_ONCE
    for number in range(ROUNDS):
        prefix, in_flight = f"round_{number}", Counter()
        kills = finished = 0
        while kills < KILLS // ROUNDS:
            before = watched.begun.total()
            process = symolo.start("upload", root, f"s3://bucket/{prefix}", *at)
            while watched.begun.total() == before and process.poll() is None:
                time.sleep(0.001)
            time.sleep(chance.uniform(0.0, whole_s / (KILLS // ROUNDS)))
            finished += process.poll() is not None
            answered = watched.stored.copy()
            process.send_signal(signal.SIGKILL)
            process.communicate()
            kills += 1
            watched.quiet()
            in_flight += watched.stored - answered
        assert finished == 0, "it was too quick to be killed"
        assert "tagmanifest-sha256.txt" not in read_back(prefix)
        assert symolo("upload", root, f"s3://bucket/{prefix}", *at).code == 0
        assert read_back(prefix) == content
        puts = {path: times for path, times in watched.stored.items() if path.startswith(f"/bucket/{prefix}/")}
        again = {path: times - 1 for path, times in puts.items() if times > 1}
        assert all(in_flight[path] >= times for path, times in again.items())
        figures.append({"kills": kills, "objects": len(content), "puts": sum(puts.values()), "twice": len(again)})
        assert symolo("upload", root, f"s3://bucket/{prefix}", *at, "--check").code == 0
    out = tmp_path / "out"
    assert symolo("download", "s3://bucket/round_0", "--out", out, *at).code == 0
    assert release_of(out) == content
    LOG.info(json.dumps(figures))  # --log-cli-level=INFO shows them
    assert sum(figure["kills"] for figure in figures) == KILLS


def test_a_large_file_goes_in_parts_and_comes_back(server, at, release, release_of, read_back, symolo, tmp_path):
    large = np.random.Generator(np.random.PCG64(7)).bytes(20_000_003)
    root, out = release(**{"CW/test_1/large.bin": large}), tmp_path / "out"
    assert symolo("upload", root, "s3://bucket/large", *at).code == 0
    assert server[0].stored["/bucket/large/CW/test_1/large.bin"] == 3  # of 8 MiB and the rest
    assert read_back("large") == release_of(root)
    assert symolo("upload", root, "s3://bucket/large", *at, "--check").code == 0
    assert symolo("download", "s3://bucket/large", "--out", out, *at).code == 0
    assert release_of(out) == release_of(root)


def test_a_server_that_is_busy_is_asked_again(server, at, release, release_of, read_back, symolo):
    root = release()
    server[0].refusing = 20
    assert symolo("upload", root, "s3://bucket/busy", *at).code == 0
    assert server[0].refusing == 0
    assert read_back("busy") == release_of(root)


def test_a_picture_is_a_picture_and_bears_its_checksum(server, at, release, symolo):
    boto3 = pytest.importorskip("boto3")
    root = release()
    assert symolo("upload", root, "s3://bucket/kinds", *at).code == 0
    client = boto3.client("s3", endpoint_url=server[1], region_name="us-east-1")
    told = client.head_object(Bucket="bucket", Key="kinds/CW/test_1/images/000001.jpg")
    assert told["ContentType"] == "image/jpeg"
    listed = (root / "manifest-sha256.txt").read_text()
    assert f"{told['Metadata']['sha256']}  CW/test_1/images/000001.jpg\n" in listed


def test_a_bucket_that_is_not_there_is_told(at, release, symolo):
    ended = symolo("upload", release(), "s3://nobodys/data", *at)
    assert (ended.code, ended.err) == (
        2,
        "symolo: s3://nobodys/data: there is no such bucket; make it by the tools of the store\n",
    )


def test_a_key_that_is_wrong_is_not_told(server, at, release, symolo, monkeypatch):
    refusal = b"<Error><Code>SignatureDoesNotMatch</Code><AWSAccessKeyId>name</AWSAccessKeyId></Error>"

    def refuse(_environ, start_response):
        start_response("403 Forbidden", [("Content-Length", str(len(refusal)))])
        return [refusal]

    monkeypatch.setattr(server[0], "_application", refuse)
    ended = symolo("upload", release(), "s3://bucket/x", *at)
    assert (ended.code, ended.err.count("\n")) == (5, 1)
    assert "does not let us in" in ended.err
    assert "SignatureDoesNotMatch" in ended.err
    assert not re.search(f"{SECRET}|AWSAccessKeyId", ended.err)
