"""What a worker says of the errors of its unit."""

import sys

import pytest

from pipeline.work.units import SimulateUnit
from pipeline.work.worker_main import do


@pytest.fixture
def unit(tmp_path):
    return SimulateUnit(name="CW/test_1", spec="{}", folder=str(tmp_path / "run"), key="1")


def test_an_engine_that_is_not_installed_is_no_bug(unit, monkeypatch):
    for module in [name for name in sys.modules if name.startswith(("pipeline.stages.", "physics.bullet"))]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, "pybullet", None)
    failed = do(unit, lambda *_: None)
    assert failed.error == "environment"
    assert "the package pybullet is missing; install symolo with the extra `generate`" in failed.text
