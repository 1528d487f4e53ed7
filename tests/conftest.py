"""What several packages' tests need of the machine, and a bench of measured data that is made here."""

import os
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hil.tools import HIL_PACKAGES, has_board


def pytest_report_header() -> list[str]:
    """Says that tests are left out for want of a tool, and the line that installs it."""
    left_out = f"tests of the firmware and its board are left out: apt-get install -y {HIL_PACKAGES}"
    return [] if has_board() else [left_out]


LONG = ("tests/pipeline/", "tests/diagnosis/", "tests/blender_scenes/")
"""Folders whose files take longest."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    items.sort(key=lambda item: not item.nodeid.startswith(LONG))  # stable: else as they were found


class _Stillborn(subprocess.Popen):
    """A child that is killed before anything can be said to it."""

    def __init__(self, *arguments, **options):
        super().__init__(*arguments, **options)
        os.kill(self.pid, signal.SIGKILL)
        os.waitid(os.P_PID, self.pid, os.WEXITED | os.WNOWAIT)


@pytest.fixture
def stillborn_children(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every child process of the test is dead before it hears a word."""
    monkeypatch.setattr(subprocess, "Popen", _Stillborn)


BENCH_NOMINAL = """\
kind: motor_steady
motor:
  winding_resistance_ohm: {value: 3.0, tolerance: 0.03}
  torque_constant_N_m_A: {value: 0.3, tolerance: 0.002}
  viscous_friction_N_m_s_rad: {value: 0.002, tolerance: 0.0001}
  coulomb_friction_N_m: {value: 0.02, tolerance: 0.0008}
  supply_voltage_V: 7.4
noise: {current_A: 0.001, omega_rad_s: 0.04}
"""


@pytest.fixture(scope="session")
def motor_bench_case() -> Callable[..., Path]:
    """Writes a case of steady states, forward and back, every fourth row held out, from the closed form.

    `strength` is the real torque constant over the nominal one, `bump_A` a bump of the current at 6 rad/s, of no term.
    """

    def write(folder: Path, strength: float = 1.0, bump_A: float = 0.0, sweeps: int = 2) -> Path:
        noise = np.random.Generator(np.random.PCG64(5))
        resistance, constant, viscous, coulomb = 3.0, 0.3 * strength, 0.002, 0.02
        lines = ["row,sweep,split,t_s,u_cmd_V,current_A,omega_rad_s"]
        for row in range(21 * sweeps):
            sweep, step = divmod(row, 21)
            volts = 0.25 * step * (1 if sweep % 2 == 0 else -1)
            pull = constant * abs(volts) / resistance - coulomb
            speed = np.sign(volts) * max(pull, 0.0) / (constant**2 / resistance + viscous)
            current = (volts - constant * speed) / resistance
            current += bump_A * np.exp(-(((abs(speed) - 6.0) / 1.0) ** 2)) + 0.001 * noise.standard_normal()
            speed += 0.04 * noise.standard_normal()
            split = "holdout" if row % 4 == 3 else "fit"
            lines.append(f"{row + 1},{sweep + 1},{split},{3.0 * row},{volts},{current:.6f},{speed:.5f}")
        folder.mkdir(parents=True)
        (folder / "nominal.yaml").write_text(BENCH_NOMINAL)
        (folder / "data.csv").write_text("\n".join(lines) + "\n")
        return folder

    return write
