"""Logs without a header line, whose columns the user names."""

import numpy as np
import pytest

from logs.trajectories.base import ReadSettings
from logs.trajectories.table import READER
from pipeline.cli import main


@pytest.fixture
def log(columns, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "log.csv"
    rows = zip(*columns.values(), strict=True)
    path.write_text("\n".join(",".join(map(str, row)) for row in rows) + "\n")
    return path


def test_named_columns_make_the_case_that_a_header_makes(log, init, columns, tmp_path):
    init(columns)
    names = ",".join(columns)
    assert main(["case", "init", str(log), "--names", names, "--out", "named"]) == 0
    assert (tmp_path / "named" / "data.csv").read_text() == (tmp_path / "run" / "data.csv").read_text()
    assert main(["case", "init", str(log), "--mapping", "named/mapping.yaml", "--out", "again"]) == 0
    assert (tmp_path / "again" / "data.csv").read_text() == (tmp_path / "run" / "data.csv").read_text()


def test_an_import_takes_the_names_from_the_mapping_file(log, columns, tmp_path):
    mapping = tmp_path / "map.yaml"
    mapping.write_text(
        f"kind: trajectory\nheader: [{', '.join(name.split(' ')[0] for name in columns)}]\ncolumns:\n"
        "  t_s: {column: time_ms, unit: ms}\n  x_m: {column: x_cm, unit: cm}\n  y_m: {column: y_cm, unit: cm}\n"
        "  theta_rad: {column: heading_deg, unit: deg}\n"
    )
    (logged,) = READER.read(log, ReadSettings(mapping=mapping))
    np.testing.assert_allclose(logged.pose[:, 0], 0.01 * np.asarray(columns["x_cm"]))


def test_names_beside_a_mapping_file_and_a_log_without_either_are_refused(log, columns, capsys):
    assert main(["case", "init", str(log)]) == 2
    assert "no header; add a line with the names of the columns" in capsys.readouterr().err
    main(["case", "init", str(log), "--names", ",".join(columns), "--out", "named"])
    assert main(["case", "init", str(log), "--names", "a", "--mapping", "named/mapping.yaml", "--out", "x"]) == 2
    assert "--names: a mapping file has the names of the columns as header" in capsys.readouterr().err
