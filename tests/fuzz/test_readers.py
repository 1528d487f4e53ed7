"""Changed files of every kind are read or refused: in one line, within 2 s and 500 MB.

This is the short form, of inputs that once failed and a few changed ones. `benchmarks/fuzz.py --seconds N` runs for
longer.
"""

import random
import threading
import zlib

import pytest

from pipeline.run_folder.stored_spec import spec_problem
from symolo.verification.verify import verify
from tests.fuzz.dataset_documents import EXECUTED
from tests.fuzz.folders import valid_copy
from tests.fuzz.guard import TooSlowError, limits, outcome_of
from tests.fuzz.mutations import mutated
from tests.fuzz.readers import LONG, READERS

COUNTS = {
    "scenario": 12,
    "dataset": 15,
    "bag": 15,
    "logs": 60,
    "panorama": 100,
    "image": 100,
    "download": 100,
    "mesh": 80,
    "drawing": 60,
    "documents": 20,
    "code": 40,
    "named": 12,
    "photographs": 20,
    "import": 25,
    "case": 60,
    "diagnoses": 60,
}
"""Changed inputs by reader; 200 of those that are not named here, which are quicker."""
FORM = "the form of a dataset has changed: make the valid files again, with tests/fuzz/make_datasets.py"


@pytest.mark.parametrize("reader", READERS.values(), ids=READERS)
def test_changed_files_are_read_or_refused(reader, tmp_path):
    read = reader.opened(tmp_path)
    valid = reader.valid()
    inputs = [*valid, *reader.failed_once]
    draw = random.Random(zlib.crc32(reader.name.encode()))  # noqa: S311 - changes of inputs, not secrets
    changed = [mutated(draw.choice(inputs), inputs, draw) for _ in range(COUNTS.get(reader.name, 200))]
    with limits():
        outcomes = [outcome_of(read, data, reader.refusals) for data in (*inputs, *changed)]
    assert {outcome.problem for outcome in outcomes} == {""}
    # Were a valid file refused, every changed one would be refused for the same reason.
    assert {outcome.refusal for outcome in outcomes[: len(valid)]} == {""}


def test_code_of_a_dataset_that_is_executed_is_noticed(tmp_path, monkeypatch):
    reader = READERS["code"]
    read = reader.opened(tmp_path)
    monkeypatch.setattr("tests.fuzz.dataset_documents.status", lambda _root: monkeypatch.setenv(EXECUTED, "executed"))
    with limits():
        assert outcome_of(read, reader.valid()[0], reader.refusals).problem.startswith("AssertionError")


@pytest.mark.parametrize(("name", "data"), LONG.values(), ids=LONG)
def test_long_files_are_read_or_refused(name, data, tmp_path):
    reader = READERS[name]
    read = reader.opened(tmp_path)
    with limits():
        assert outcome_of(read, data, reader.refusals).problem == ""


@pytest.mark.parametrize("name", ["dataset", "bag"])
def test_the_valid_datasets_have_no_fault(name, tmp_path):
    assert [str(finding) for finding in verify(valid_copy(name, tmp_path), spec_problem)] == [], FORM


def test_what_takes_too_long_too_much_or_is_no_refusal_is_noticed(monkeypatch):
    monkeypatch.setattr("tests.fuzz.guard.SECONDS", 0.5)

    def forever(_data):
        while True:
            pass

    def hungry(data):
        return bytearray(len(data) << 30)

    def wrong(data):
        return data[1]

    def lines(_data):
        raise ValueError("two\nlines")

    with limits():
        problems = [outcome_of(read, b"a", (ValueError,)).problem for read in (forever, hungry, wrong, lines)]
    assert [text.partition(" outside")[0] for text in problems] == [
        "more than 0.5 s",
        "more than 500 MB",
        "IndexError",
        "ValueError: more than a line",
    ]
    assert not issubclass(TooSlowError, Exception)


def test_memory_that_the_process_took_before_an_input_does_not_count():
    with limits():
        before = bytearray(400 << 20)  # zeros by the system, which cost no time
        outcome = outcome_of(lambda _: bytearray(len(before)), b"", ())
    assert outcome.problem == ""


def test_threads_that_end_meanwhile_do_not_matter():
    over = threading.Event()

    def short_threads():
        while not over.is_set():
            thread = threading.Thread(target=int)
            thread.start()
            thread.join()

    starter = threading.Thread(target=short_threads)
    starter.start()
    try:
        with limits():
            outcomes = [outcome_of(bytes, b"", ()) for _ in range(200)]
    finally:
        over.set()
        starter.join()
    assert {outcome.problem for outcome in outcomes} == {""}
