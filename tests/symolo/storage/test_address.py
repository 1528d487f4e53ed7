"""What an address may be, and what is said where something is lacking; keys are never told."""

import sys

import pytest

from symolo.storage import address, bucket

SECRET = "s3cr3t-k3y"  # noqa: S105 - of nobody


@pytest.fixture(autouse=True)
def nothing_in_the_environment(monkeypatch):
    for names in bucket.KEYS.values():
        for name in names:
            monkeypatch.delenv(name, raising=False)
    for name in address.ENDPOINTS:
        monkeypatch.delenv(name, raising=False)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["s3:/bucket"], "URL: got 's3:/bucket', allowed: s3://BUCKET/PREFIX, gs://BUCKET/PREFIX or file:///FOLDER"),
        (["s3://"], "URL: got 's3://'"),
        (["s3://bucket/../other"], "URL: got"),
        (["s3://bucket//x"], "URL: got"),
        (["https://bucket/x"], "URL: got 'https://bucket/x'"),
        (["data"], "URL: got 'data'"),
        (["file://data"], "URL: got 'file://data', allowed: file:// and an absolute path"),
        (["s3://bucket/x", "--endpoint", "localhost:9000"], "--endpoint: got 'localhost:9000', allowed: https://HOST"),
        (["s3://bucket/x", "--endpoint", "http://localhost:9000"], "sends everything unencrypted; use https://"),
        (["gs://bucket/x", "--endpoint", "https://localhost"], "leave it out: only s3:// has an endpoint"),
    ],
)
def test_what_is_no_address_is_refused(symolo, tmp_path, arguments, message):
    ended = symolo("download", *arguments, "--out", tmp_path / "out")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert message in ended.err


@pytest.mark.parametrize(
    "arguments",
    [
        [f"s3://name:{SECRET}@bucket/x"],
        [f"s3://bucket/x?key={SECRET}"],
        ["s3://bucket/x", "--endpoint", f"https://name:{SECRET}@host"],
    ],
)
def test_a_key_in_an_address_is_refused_and_not_repeated(symolo, tmp_path, arguments):
    ended = symolo("download", *arguments, "--out", tmp_path / "out")
    assert ended.code == 2
    assert "only in environment variables" in ended.err
    assert SECRET not in ended.err + ended.out


@pytest.mark.parametrize("variable", address.ENDPOINTS)
@pytest.mark.parametrize(
    ("server", "message"),
    [
        ("http://localhost:9000", "sends everything unencrypted"),
        (f"https://name:{SECRET}@host", "contains a name, a key"),
    ],
)
def test_a_server_that_the_environment_names_is_held_to_the_same(
    symolo, tmp_path, monkeypatch, variable, server, message
):
    monkeypatch.setenv(variable, server)
    ended = symolo("download", "s3://bucket/x", "--out", tmp_path / "out")
    assert ended.code == 2
    assert variable in ended.err
    assert message in ended.err
    assert SECRET not in ended.err


@pytest.mark.parametrize(("kind", "variable"), [("s3", "AWS_ACCESS_KEY_ID"), ("gs", "GOOGLE_APPLICATION_CREDENTIALS")])
def test_without_a_key_nothing_is_reached(symolo, tmp_path, kind, variable):
    """The library would ask an address of its own choice, that of the cloud's machines."""
    ended = symolo("download", f"{kind}://bucket/x", "--out", tmp_path / "out")
    assert (ended.code, ended.err.count("\n")) == (5, 1)
    assert f"no environment variable has a key for it; set {variable}" in ended.err


def test_without_the_library_the_extra_is_named(symolo, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "obstore", None)
    ended = symolo("download", "s3://bucket/x", "--out", tmp_path / "out")
    assert ended.code == 5
    assert "pip install 'symolo[cloud]'" in ended.err


def test_a_server_that_is_not_there_is_reported_in_a_line_without_the_key(symolo, tmp_path, monkeypatch):
    monkeypatch.setattr(bucket, "RETRIES", 1)
    monkeypatch.setenv("AWS_ACCESS_KEY_ID", "name")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", SECRET)
    server = ["--endpoint", "http://127.0.0.1:1", "--allow-http"]
    ended = symolo("download", "s3://bucket/x", "--out", tmp_path / "out", *server)
    assert (ended.code, ended.err.count("\n")) == (5, 1)
    assert "check the address and the network" in ended.err
    assert SECRET not in ended.err
    assert not (tmp_path / "out").exists()
