"""The motors of motors.c, compiled with the system's compiler when they are first used."""

import ctypes
import shutil
import subprocess
import tempfile
from functools import lru_cache
from pathlib import Path

import numpy as np

from benchmarks.diagnosis.other_robots.draws import Array

COMPILERS = ("cc", "gcc", "clang")
WHEEL_DT_S = 0.05
"""Time between the rows of a drive."""
WHEEL_SUBSTEPS = 20


class NoCompilerError(RuntimeError):
    """There is no C compiler, or it fails."""


@lru_cache(maxsize=1)
def _library() -> ctypes.CDLL:
    """Compile motors.c into a temporary folder and load it."""
    compiler = next((path for path in map(shutil.which, COMPILERS) if path), None)
    if compiler is None:
        raise NoCompilerError(
            f"motor_step and drive_log need a C compiler ({', '.join(COMPILERS)}), and none is installed"
        )
    source = Path(__file__).with_name("motors.c")
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "motors.so"
        options = ["-O2", "-ffp-contract=off", "-shared", "-fPIC"]
        try:
            subprocess.run([compiler, *options, str(source), "-o", str(target), "-lm"], check=True)
        except (OSError, subprocess.CalledProcessError) as error:
            raise NoCompilerError(f"{compiler} cannot compile {source.name}: {error}") from error
        return ctypes.CDLL(str(target))


def _pointer(values: Array) -> ctypes.c_void_p:
    """Return the address of an array of contiguous doubles."""
    if values.dtype != np.float64 or not values.flags.c_contiguous:
        raise ValueError("motors.c reads contiguous arrays of float64")
    return values.ctypes.data_as(ctypes.c_void_p)


def simulate_trials(
    parameters: Array, commands: Array, starts: Array, *, session: float, substeps: int, dt: float
) -> tuple[Array, Array]:
    """Return current and motor-side speed of one motor, (variants, trials, samples) each."""
    trials, samples = commands.shape
    variants = len(parameters)
    current = np.empty((variants, trials, samples))
    speed = np.empty_like(current)
    inputs = [np.ascontiguousarray(values, float) for values in (commands, starts, parameters)]
    _library().simulate_trials(
        *map(ctypes.c_int, (variants, trials, samples, substeps)),
        ctypes.c_double(dt),
        _pointer(inputs[0]),
        _pointer(inputs[1]),
        ctypes.c_double(session),
        _pointer(inputs[2]),
        _pointer(current),
        _pointer(speed),
    )
    return current, speed


def advance_wheels(
    parameters: Array,
    inputs: tuple[Array, Array, Array, Array],
    state: Array,
    angles: Array,
    rows: tuple[int, int, int],
) -> None:
    """Advance both wheels of all variants over some rows.

    Args:
        parameters: A row per variant, in the order of motors.c.
        inputs: Voltages (2, rows), session times (rows), outside torques (2, rows) and extra friction (2, rows).
        state: Speeds and angles of both wheels per variant, which are updated.
        angles: Angles at the ends of the rows, (variants, 2, rows), which are written.
        rows: First row, last row (not included), and the first row of the trial.
    """
    first, last, start = rows
    sizes = (len(parameters), first, last, start, inputs[0].shape[1], WHEEL_SUBSTEPS)
    pointers = map(_pointer, (*inputs, parameters, state, angles))
    _library().advance_wheels(*map(ctypes.c_int, sizes), ctypes.c_double(WHEEL_DT_S), *pointers)
