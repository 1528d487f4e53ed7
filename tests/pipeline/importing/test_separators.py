"""Tables with each separator and each ending that the manual names."""

import math

import numpy as np
import pytest

import symolo as symolo_reader
from pipeline.cli import main

HEADER = ("stamp_us", "cnt_l", "cnt_r", "x_m", "y_m", "yaw_deg", "sonar")
MAPPING = """\
kind: drive_log
columns:
  t_s: {column: stamp_us, unit: us}
  x_m: {column: x_m}
  y_m: {column: y_m}
  theta_rad: {column: yaw_deg, unit: degrees}
"""


def rows():
    return [(50_000 * i, 2 * i, 3 * i, 0.01 * i, 0.1, 20.0, -1) for i in range(40)]


def written(path, separator):
    lines = [separator.join(HEADER)]
    for row in rows():
        cells = [f"{cell:g}" if isinstance(cell, int) else f"{cell:.4f}" for cell in row]
        lines.append(separator.join(cell.replace(".", ",") if separator == ";" else cell for cell in cells))
    path.write_text("\n".join(lines) + "\n")
    return path


def check(root):
    (run,) = symolo_reader.load(root)
    np.testing.assert_allclose(run.table.pose[:, 0], [row[3] for row in rows()], atol=1e-6)
    np.testing.assert_allclose(run.table.pose[:, 2], math.radians(20.0), atol=2e-6)
    np.testing.assert_array_equal(run.table.t_ms, 50 * np.arange(40))


@pytest.mark.parametrize("ending", ["csv", "tsv", "txt", "log", "dat", "TSV"])
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_table_is_recognised_by_its_separator(separator, ending, tmp_path):
    log = written(tmp_path / f"log.{ending}", separator)
    assert main(["import", str(log), "--out", str(tmp_path / "data")]) == 0
    check(tmp_path / "data")


@pytest.mark.parametrize("name", ["log.tsv", "log", "log.measured"])
def test_a_mapping_file_makes_a_table_of_any_file(name, tmp_path):
    log, mapping = written(tmp_path / name, "\t"), tmp_path / "mapping.yaml"
    mapping.write_text(MAPPING)
    assert main(["import", str(log), "--map", str(mapping), "--out", str(tmp_path / "data")]) == 0
    check(tmp_path / "data")
