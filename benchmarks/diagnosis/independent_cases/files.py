"""Files of a case: CSV with fixed decimals and empty cells, nominal.yaml, truth.json."""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from benchmarks.diagnosis.independent_cases.setting import CaseFiles, Table


def _cells(values: Iterable[Any], form: str) -> list[str]:
    """Return the values in that %-format; missing ones become empty cells."""
    return ["" if isinstance(value, float) and np.isnan(value) else form % value for value in values]


def _table_text(table: Table) -> str:
    """Return the text of a CSV file."""
    columns = [_cells(values, form) for values, form in table.values()]
    lines = [",".join(table), *(",".join(row) for row in zip(*columns, strict=True))]
    return "\n".join(lines) + "\n"


class _Dumper(yaml.SafeDumper):
    """Writes block mappings, but lists of numbers on one line."""

    def represent_list(self, data: Any) -> yaml.Node:  # noqa: ANN401 - as the base class
        """Return a list on one line."""
        return self.represent_sequence("tag:yaml.org,2002:seq", data, flow_style=True)


_Dumper.add_representer(list, _Dumper.represent_list)


def _plain(value: object) -> Any:  # noqa: ANN401 - what JSON and YAML may hold
    """Return the value with the types of NumPy turned into Python's."""
    if isinstance(value, dict):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    return value.item() if isinstance(value, np.generic) else value


def write_case(folder: Path, files: CaseFiles) -> None:
    """Write nominal.yaml and the CSV files of a case into the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    nominal = yaml.dump(_plain(files.nominal), Dumper=_Dumper, sort_keys=False, allow_unicode=True)
    (folder / "nominal.yaml").write_text(nominal, encoding="utf-8")
    for name, table in files.tables.items():
        (folder / name).write_text(_table_text(table), encoding="utf-8")


def write_truth(path: Path, truth: dict[str, Any]) -> None:
    """Add the truth of a case to truth.json, or replace it there."""
    others = json.loads(path.read_text(encoding="utf-8")) if path.exists() else []
    merged = [t for t in others if t["case"] != truth["case"]] + [_plain(truth)]
    text = json.dumps(sorted(merged, key=lambda t: t["case"]), indent=1) + "\n"
    path.write_text(text, encoding="utf-8")
