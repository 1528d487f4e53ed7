from pathlib import Path

import pytest


@pytest.fixture(autouse=True)
def _benchmarks_on_the_path(monkeypatch):
    """Benchmarks are scripts that import each other as they do when they are run."""
    folder = Path(__file__).parents[2] / "benchmarks"
    monkeypatch.syspath_prepend(str(folder / "photographs"))
    monkeypatch.syspath_prepend(str(folder / "speed"))
