"""Errors that mean that the machine lacks something, as Python, the loader of libraries and OpenCV word them."""

import errno
import os
import tempfile

import cv2
import numpy as np
import pytest

from symolo.core.os_errors import lacking

CURE = "; free some memory, or take fewer --workers or smaller images, and run the same command again"


def chained(cause):
    """What numpy raises where one of its libraries cannot be loaded."""
    try:
        try:
            raise cause
        except ImportError as first:
            raise ImportError(
                "\n\nError importing numpy: you should not try to import numpy from its source"
            ) from first
    except ImportError as error:
        return error


MAPPED = "libopenblas.so: failed to map segment from shared object"


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (MemoryError(), ""),
        (MemoryError("Unable to allocate 1.50 GiB for an array"), ": Unable to allocate 1.50 GiB for an array"),
        (OSError(errno.ENOMEM, os.strerror(errno.ENOMEM)), ": [Errno 12] Cannot allocate memory"),
        (ImportError(MAPPED), f": {MAPPED}"),
        (chained(ImportError(MAPPED)), f": {MAPPED}"),
        (RuntimeError("can't start new thread"), ": can't start new thread"),
        (RuntimeError("std::bad_alloc"), ": std::bad_alloc"),
        (RuntimeError("Error: Out of memory"), ": Error: Out of memory"),
    ],
)
def test_too_little_memory_is_named_with_what_to_do(error, reason):
    assert lacking(error) == f"there is not enough memory{reason}{CURE}"


def test_an_error_that_python_lost_is_memory_where_memory_is_limited(monkeypatch):
    """As CPython 3.11 ends where an allocation fails while it cleans up."""
    lost = SystemError("error return without exception set")
    assert lacking(lost) == ""
    monkeypatch.setattr("resource.getrlimit", lambda _: (2_000_000_000, 2_000_000_000))
    assert lacking(lost) == f"there is not enough memory: error return without exception set{CURE}"


def test_opencv_without_memory_is_recognised():
    """An image of 2^30 rows and as many columns is more than any address space."""
    with pytest.raises(cv2.error) as refused:
        cv2.copyMakeBorder(np.zeros((1, 1), np.uint8), 2**29, 2**29, 2**29, 2**29, cv2.BORDER_CONSTANT)
    assert lacking(refused.value).startswith("there is not enough memory: ")


@pytest.mark.parametrize(
    ("number", "cure"),
    [
        (errno.ENOSPC, "free some space"),
        (errno.EDQUOT, "get a larger quota"),
        (errno.EFBIG, "ulimit -f unlimited"),
        (errno.EAGAIN, "fewer --workers"),
    ],
)
def test_each_limit_has_its_cure(number, cure):
    text = lacking(OSError(number, os.strerror(number), "data.csv"))
    assert text.startswith(f"[Errno {number}] {os.strerror(number)}: 'data.csv'; ")
    assert cure in text


def test_a_machine_without_a_place_for_temporary_files_is_recognised(monkeypatch):
    """As where the disk of all of them is full; in /proc nobody can make a file."""
    monkeypatch.setattr(tempfile, "tempdir", None)
    monkeypatch.setattr(tempfile, "_candidate_tempdir_list", lambda: ["/proc"])
    with pytest.raises(FileNotFoundError) as refused:
        tempfile.gettempdir()
    text = lacking(refused.value)
    assert text.endswith("['/proc']; free some space there or set TMPDIR, and run the same command again")


@pytest.mark.parametrize("error", [ValueError("wrong"), ImportError("No module named x"), FileNotFoundError(2, "x")])
def test_what_is_not_the_machines_is_left_alone(error):
    assert lacking(error) == ""
