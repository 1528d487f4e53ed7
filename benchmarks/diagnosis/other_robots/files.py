"""Files of a case: data.csv, nominal.yaml and its entry in truth.json."""

import csv
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from benchmarks.diagnosis.other_robots.draws import significant
from benchmarks.diagnosis.other_robots.hidden import Entries

Truth = dict[str, Any]


@dataclass
class Case:
    """The content of the files of a case."""

    nominal: dict[str, Any]
    header: list[str]
    rows: list[list[str]]
    truth: Truth


def tolerance_entry(value: float, relative: float) -> dict[str, float]:
    """Return a value with its tolerance as nominal.yaml has it."""
    rounded = significant(value)
    return {"value": rounded, "tolerance": significant(abs(rounded) * relative)}


def truth_entry(
    kind: str, category: str, entries: Entries, disturbances: dict[str, Any], setting: dict[str, Any]
) -> Truth:
    """Return the entry of truth.json without the name of the case."""
    return {
        "kind": kind,
        "category": category,
        "effects": entries.effects,
        "outside": entries.outside,
        "near_rivals": entries.near_rivals,
        "disturbances": disturbances,
        "setting": setting,
    }


def write_case(folder: Path, case: Case) -> None:
    """Write nominal.yaml and data.csv into the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "nominal.yaml").write_text(yaml.safe_dump(case.nominal, sort_keys=False), encoding="utf-8")
    with (folder / "data.csv").open("w", newline="", encoding="utf-8") as handle:
        writer = csv.writer(handle, lineterminator="\n")
        writer.writerow(case.header)
        writer.writerows(case.rows)


def write_truth(path: Path, truth: Truth) -> None:
    """Add the truth of a case to truth.json, or replace it there."""
    others = json.loads(path.read_text(encoding="utf-8")) if path.exists() else []
    merged = [*(each for each in others if each["case"] != truth["case"]), truth]
    text = json.dumps(sorted(merged, key=lambda each: each["case"]), indent=1, default=float)
    path.write_text(text + "\n", encoding="utf-8")
