"""Damaged files of every kind: whatever was done to them, they are read or refused with the place of each fault."""

import re

import numpy as np
import pytest

from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.measured.overview import overview
from symolo.core.errors import InputError

KINDS = ("motor_steady", "motor_step", "tof_bench", "drive_log")
PIECES = (b",", b"\n", b"\r", b"nan", b"-", b"1e999", b"", b"\x00", b"\xff", b'"', b";", b"0", b"9" * 400, b"fit", b" ")
MUTANTS = 60


def damaged(data: bytes, rng: np.random.Generator) -> bytes:
    """Up to three cuts, insertions and doubled stretches."""
    for _ in range(int(rng.integers(1, 4))):
        a, b = sorted(int(k) for k in rng.integers(0, len(data) + 1, 2))
        b = min(b, a + 12)
        data = (
            data[:a] + PIECES[int(rng.integers(len(PIECES)))] + data[b:],
            data[:b] + data[a:],
            data[:a],
            data[:a] + PIECES[int(rng.integers(len(PIECES)))] + data[a:],
        )[int(rng.integers(4))]
    return data


@pytest.mark.parametrize("file", ["data.csv", "nominal.yaml"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_damaged_case_is_read_or_refused_with_the_place_of_each_fault(case, kind, file):
    rng = np.random.Generator(np.random.PCG64(KINDS.index(kind)))
    folder = case(kind)
    good = (folder / file).read_bytes()
    refused = []
    for _ in range(MUTANTS):
        (folder / file).write_bytes(damaged(good, rng))
        try:
            lines = overview(read_measurement(folder, IMPORTERS))
        except InputError as error:
            refused.append(str(error))
        else:
            assert lines
    assert len(refused) > MUTANTS // 3
    lines = [line for text in refused for line in text.splitlines() if not re.fullmatch(r"\d+ faults:", line)]
    assert [line for line in lines if kind not in line] == []
