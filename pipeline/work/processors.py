"""The class of the processor, which decides the low bits of floating-point results, and the threads on it."""

import os
import platform
import re
import sys
from pathlib import Path
from types import MappingProxyType

_LEVELS = (
    ("x86-64-v4", "avx512f avx512bw avx512cd avx512dq avx512vl"),
    ("x86-64-v3", "avx avx2 bmi1 bmi2 f16c fma abm movbe xsave"),
    ("x86-64-v2", "cx16 lahf_lm popcnt sse4_1 sse4_2 ssse3"),
)
"""Levels of the x86-64 psABI with the flags of Linux that each adds to the levels below it."""

_VARIABLES = ("OPENBLAS_CORETYPE",)
"""Environment variables that make NumPy use code for another processor."""

ONE_THREAD = MappingProxyType({"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"})
"""Sums of a linear algebra that shares its work among threads depend on their number, and workers fill the cores.
On a busy machine, threads also wait for each other at each of many small products."""


def use_one_thread() -> bool:
    """Let linear algebra use one thread, and return whether it does; it reads the environment when it is loaded."""
    if "numpy" not in sys.modules:
        os.environ.update(ONE_THREAD)
    return ONE_THREAD.items() <= os.environ.items()


def cpu_class() -> str:
    """Return the class of this machine's processor, such as `x86-64-v3 AuthenticAMD family 25`, and such variables."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
    except OSError:
        text = ""
    variables = [f"{name}={os.environ[name]}" for name in _VARIABLES if os.environ.get(name)]
    return " ".join([class_of(text, platform.machine()), *variables])


def class_of(cpuinfo: str, machine: str) -> str:
    """Return the class of the processor that a text in the form of /proc/cpuinfo describes.

    NumPy, OpenBLAS, Embree, Open Image Denoise and Cycles choose their code by instruction set when they are loaded;
    approximate reciprocals (`rcpps`, `rsqrtps`) differ between makers, OpenBLAS's kernels between families.
    """
    field = {name.strip(): value.strip() for name, value in re.findall(r"^([^:\n]+):(.*)$", cpuinfo, re.MULTILINE)}
    if "flags" in field:
        maker, family = field.get("vendor_id", "unknown"), field.get("cpu family", "?")
        return f"{_level(set(field['flags'].split()))} {maker} family {family}"
    if "CPU implementer" in field:
        vectors = "sve" if "sve" in field.get("Features", "").split() else "neon"
        return f"{machine} {vectors} implementer {field['CPU implementer']} part {field.get('CPU part', '?')}"
    return machine or "unknown"


def _level(flags: set[str]) -> str:
    held = "x86-64-v1"
    for level, needed in reversed(_LEVELS):
        if not flags.issuperset(needed.split()):
            break
        held = level
    return held
