"""Upload and download by a server that speaks S3 on this machine: killed at random instants, refused, and in parts.

pip install "moto[server]", which is in no lock file of ours, for it brings some forty packages.
"""

import logging
import re
import signal
import threading
import time
from collections import Counter

import numpy as np
import pytest

from symolo.storage.side_by_side import AT_ONCE

pytestmark = pytest.mark.cloud

SLOW_S = 0.05
"""Of each request, as on a line of some length, so that there is something to kill."""
SECRET = "s3cr3t-k3y"  # noqa: S105 - of nobody

LOG = logging.getLogger(__name__)


class Watched:
    """A WSGI application that notes each request for an object when it begins and when it has been done.

    While it is `dropping` it does every second one of them not at all, as where a client died before all was sent.
    """

    def __init__(self, application):
        self._application, self._lock = application, threading.Lock()
        self.method, self.suffix = "PUT", ""
        """Of the requests that are noted."""
        self.begun: Counter[str] = Counter()
        self.done: Counter[str] = Counter()
        self.dropped: Counter[str] = Counter()
        self.dropping = False
        self.refusing = 0
        """How many more are told that the server is busy."""

    def __call__(self, environ, start_response):
        path = environ["PATH_INFO"]
        if environ["REQUEST_METHOD"] != self.method or path.count("/") < 2 or not path.endswith(self.suffix):
            return self._application(environ, start_response)
        with self._lock:
            self.begun[path] += 1
            refused, self.refusing = self.refusing > 0, max(0, self.refusing - 1)
        if refused:
            return _busy(start_response)
        time.sleep(SLOW_S)
        with self._lock:
            drops = self.dropping and (self.begun.total() - self.done.total() - self.dropped.total()) % 2 == 0
            self.dropped[path] += drops
        if drops:
            return _busy(start_response)
        answer = list(self._application(environ, start_response))
        with self._lock:
            self.done[path] += 1
        return answer

    def killed(self, process):
        """Kill a client at this instant; how often each object was in flight then, once all of that is worked off."""
        answered, self.dropping = self.done + self.dropped, True
        process.send_signal(signal.SIGKILL)
        process.communicate()
        before = None
        while before != self.begun.total() or self.begun != self.done + self.dropped:
            before = self.begun.total()
            time.sleep(0.3)
        self.dropping = False
        return self.begun - answered

    def note_only(self, method, suffix=""):
        """Forget what was noted, and note such requests from now on."""
        self.method, self.suffix = method, suffix
        for counter in (self.begun, self.done, self.dropped):
            counter.clear()


def _busy(start_response):
    start_response("503 Slow Down", [("Content-Length", "0")])
    return [b""]


@pytest.fixture(scope="module")
def server():
    from moto.moto_server.werkzeug_app import (  # pyright: ignore[reportMissingImports]  # noqa: PLC0415 - see the top
        DomainDispatcherApplication,
        create_backend_app,
    )
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
    import boto3  # pyright: ignore[reportMissingImports]  # noqa: PLC0415 - see the top

    for name, value in (("ACCESS_KEY_ID", "name"), ("SECRET_ACCESS_KEY", SECRET), ("REGION", "us-east-1")):
        monkeypatch.setenv(f"AWS_{name}", value)
    server[0].note_only("PUT")
    boto3.client("s3", endpoint_url=server[1], region_name="us-east-1").create_bucket(Bucket="bucket")
    return ["--endpoint", server[1], "--allow-http"]


@pytest.fixture
def read_back(server):
    """All objects below a prefix, as Amazon's own library reads them."""
    import boto3  # pyright: ignore[reportMissingImports]  # noqa: PLC0415 - see the top

    def read(prefix):
        client = boto3.client("s3", endpoint_url=server[1], region_name="us-east-1")
        pages = client.get_paginator("list_objects_v2").paginate(Bucket="bucket", Prefix=f"{prefix}/")
        keys = [one["Key"] for page in pages for one in page.get("Contents", [])]
        return {key[len(prefix) + 1 :]: client.get_object(Bucket="bucket", Key=key)["Body"].read() for key in keys}

    return read


def _many(count):
    return {f"CW/test_{i % 3}/images/{i:06d}.jpg": bytes([i % 251]) * (1000 + i) for i in range(count)}


@pytest.fixture
def kill_often(server, symolo):
    """Starts a command and kills it again and again, at random instants after its first request for an object.

    Together the instants lie within `span_s`. Gives how often each object was in flight at a kill.
    """

    def kill(chance, kills, span_s, *command):
        watched, in_flight = server[0], Counter()
        for _ in range(kills):
            before = watched.begun.total()
            process = symolo.start(*command)
            while watched.begun.total() == before and process.poll() is None:
                time.sleep(0.001)
            time.sleep(chance.uniform(0.0, span_s / kills))
            assert process.poll() is None, "it was too quick to be killed"
            in_flight += watched.killed(process)
        return in_flight

    return kill


def test_uploads_killed_at_fifty_random_instants_send_nothing_twice_but_what_was_in_flight(
    server, at, release, release_of, read_back, symolo, kill_often
):
    root, chance, watched = release(**_many(390)), np.random.Generator(np.random.PCG64(5)), server[0]
    content, kills = release_of(root), 0
    for number in range(10):
        prefix, command = f"round_{number}", ("upload", root, f"s3://bucket/round_{number}", *at)
        in_flight = kill_often(chance, 5, SLOW_S * len(content) / AT_ONCE, *command)
        kills += 5
        assert "tagmanifest-sha256.txt" not in read_back(prefix)
        assert symolo(*command).code == 0
        assert read_back(prefix) == content
        assert symolo(*command, "--check").code == 0
        sent = Counter({path: times for path, times in watched.begun.items() if f"/{prefix}/" in path})
        again = sent - Counter(sent.keys())
        assert not again - in_flight
        LOG.info("%d objects, %d puts, %d in flight at kills", len(sent), sent.total(), in_flight.total())
    assert kills == 50


def test_a_download_that_is_killed_fetches_nothing_twice_but_what_was_in_flight(
    server, at, release, release_of, symolo, kill_often, tmp_path
):
    root, out, watched = release(**_many(390)), tmp_path / "out", server[0]
    assert symolo("upload", root, "s3://bucket/whole", *at).code == 0
    watched.note_only("GET", ".jpg")
    command, kills = ("download", "s3://bucket/whole", "--out", out, *at), 10
    kill_often(np.random.Generator(np.random.PCG64(6)), kills, SLOW_S * 399 / AT_ONCE, *command)
    assert not out.exists()
    assert symolo(*command).code == 0
    assert release_of(out) == release_of(root)
    gets = watched.begun.total()
    LOG.info("%d images, %d gets, %d kills", len(watched.begun), gets, kills)
    assert gets - len(watched.begun) <= kills * AT_ONCE  # answered, and not yet on the disk, is in flight too


def test_a_release_that_is_killed_while_it_is_made_and_sent_goes_on_with_both(
    server, at, release_of, read_back, symolo, tmp_path, tiny
):
    out, watched = tmp_path / "out", server[0]
    command = ["release", "smoke", "--out", out, *tiny, "--set=render.annotations=[instance]", "--workers=1"]
    command += ["--upload", "s3://bucket/made", *at]
    process = symolo.start(*command)
    while watched.begun.total() < 5 and process.poll() is None:
        time.sleep(0.001)
    in_flight = watched.killed(process)
    there = read_back("made")
    assert {name.partition("/")[0] for name in there} == {"CW"}
    assert not (out / "metadata.json").exists()  # the other run was still to be made
    assert symolo(*command).code == 0
    assert read_back("made") == release_of(out)
    assert there.items() <= release_of(out).items()
    assert symolo("upload", out, "s3://bucket/made", *at, "--check").code == 0
    assert not (watched.begun - Counter(watched.begun.keys())) - in_flight
    LOG.info("%d objects, %d puts, %d in flight", len(watched.begun), watched.begun.total(), in_flight.total())


def test_an_interrupt_ends_with_what_is_in_flight(server, at, release, symolo):
    root, watched = release(**_many(390)), server[0]
    process = symolo.start("upload", root, "s3://bucket/interrupted", *at)
    while watched.begun.total() == 0:
        time.sleep(0.001)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 130
    assert "interrupted" in err
    assert "Traceback" not in err
    sent = watched.begun.total()
    assert sent < 200
    again = symolo("upload", root, "s3://bucket/interrupted", *at)
    assert f"{400 - 1 - sent} files sent" in again.out


def test_a_large_file_goes_in_parts_and_comes_back(server, at, release, release_of, read_back, symolo, tmp_path):
    large = np.random.Generator(np.random.PCG64(7)).bytes(20_000_003)
    root, out = release(**{"CW/test_1/large.bin": large}), tmp_path / "out"
    assert symolo("upload", root, "s3://bucket/large", *at).code == 0
    assert server[0].done["/bucket/large/CW/test_1/large.bin"] == 3  # of 8 MiB and the rest
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
    import boto3  # pyright: ignore[reportMissingImports]  # noqa: PLC0415 - see the top

    root = release()
    assert symolo("upload", root, "s3://bucket/kinds", *at).code == 0
    client = boto3.client("s3", endpoint_url=server[1], region_name="us-east-1")
    head = client.head_object(Bucket="bucket", Key="kinds/CW/test_1/images/000001.jpg")
    assert head["ContentType"] == "image/jpeg"
    listed = (root / "manifest-sha256.txt").read_text()
    assert f"{head['Metadata']['sha256']}  CW/test_1/images/000001.jpg\n" in listed


def test_a_bucket_that_is_not_there_is_reported(at, release, symolo):
    ended = symolo("upload", release(), "s3://nobodys/data", *at)
    assert (ended.code, ended.err) == (
        2,
        "symolo: s3://nobodys/data: there is no such bucket; make it with the tools of the store\n",
    )


def test_a_key_that_is_wrong_is_not_reported(server, at, release, symolo, monkeypatch):
    refusal = b"<Error><Code>SignatureDoesNotMatch</Code><AWSAccessKeyId>name</AWSAccessKeyId></Error>"

    def refuse(_environ, start_response):
        start_response("403 Forbidden", [("Content-Length", str(len(refusal)))])
        return [refusal]

    monkeypatch.setattr(server[0], "_application", refuse)
    ended = symolo("upload", release(), "s3://bucket/x", *at)
    assert (ended.code, ended.err.count("\n")) == (5, 1)
    assert "refuses access" in ended.err
    assert "SignatureDoesNotMatch" in ended.err
    assert not re.search(f"{SECRET}|AWSAccessKeyId", ended.err)
