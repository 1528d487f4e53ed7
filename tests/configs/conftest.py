from pathlib import Path

import pytest

SCENARIO = """\
name: trial
seed: 7
routes:
  - {name: CW, start: {x_m: 0.55, y_m: -0.20, yaw_deg: -90}, runs: 2}
  - {name: CCW, start: {x_m: 0.55, y_m: -0.20, yaw_deg: 90}, runs: 1}
stop: {lap: false, time_limit_s: 6}
arena: symolo
robot: nominal
look: classroom
"""


@pytest.fixture
def scenario_text() -> str:
    """A good scenario of nine lines."""
    return SCENARIO


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working directory, with the good scenario in it, so that messages show bare file names."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "trial.yaml").write_text(SCENARIO)
    return tmp_path
