"""A drive by closed forms, and `symolo case init` on a table."""

import numpy as np
import pytest
import yaml

from pipeline.cli import main
from tests.diagnosis.new_case.drives import DT, csv_text, drive_rows


@pytest.fixture(scope="module")
def columns():
    return drive_rows(DT * np.arange(600))


@pytest.fixture
def init(tmp_path, monkeypatch, capsys):
    """Run `symolo case init` on a table in an empty folder, and return code, output, messages and nominal.yaml."""
    monkeypatch.chdir(tmp_path)

    def run(columns, *arguments):
        (tmp_path / "run.csv").write_text(csv_text(columns))
        code = main(["case", "init", "run.csv", *arguments])
        printed = capsys.readouterr()
        nominal = tmp_path / "run" / "nominal.yaml"
        return code, printed.out, printed.err, yaml.safe_load(nominal.read_text()) if nominal.is_file() else {}

    return run
