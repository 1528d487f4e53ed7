"""Readers of small files that a command names, as `readers.py` has them: estimates, facts, splits, keys, recordings."""

import json
from datetime import date
from functools import cache
from pathlib import Path

import numpy as np
import yaml

from diagnosis.validation.range_sensor.recordings.scan import read_scan
from diagnosis.validation.range_sensor.recordings.static import read_rest_recording
from pipeline.commands.splits import split_line, with_splits
from pipeline.diagnosing.diagnose import read_case, robot_of
from pipeline.diagnosing.made_from import MADE_FROM, read_made_from
from symolo.evaluation.align import Align
from symolo.evaluation.estimate_file import read_estimate
from symolo.evaluation.evaluate import evaluate_against
from symolo.publishing.about import read_about
from symolo.reader.dataset import load
from symolo.signing.key_files import read_public_key, read_secret_key
from symolo.signing.secret_key import SecretKey
from tests.fuzz.folders import Folder, files, valid_copy
from tests.fuzz.guard import Read
from tests.logs.test_trajectory_readers import POSE, T_S, X_WR, lines, tum

PASSPHRASE = "open"  # noqa: S105 - of keys that sign nothing
TODAY = date(2026, 1, 1)


def estimates() -> list[bytes]:
    """Return the poses of a circle as tables, with and without covariances, and as lines of TUM."""
    degrees = np.column_stack((T_S, POSE[:, :2], np.degrees(POSE[:, 2])))
    variances = np.tile([1e-4, 1e-4, 0.1, 1e-5], (len(T_S), 1))
    milliseconds = np.column_stack((1000 * T_S, POSE))
    tables = {
        "mine.csv": ("t_s,x_m,y_m,heading_deg", degrees),
        "sure.csv": (
            "t_s,x_m,y_m,heading_deg,var_x_m2,var_y_m2,var_heading_deg2,cov_x_y_m2",
            np.hstack((degrees, variances)),
        ),
        "milliseconds.csv": ("heading_rad,t_ms,y_m,x_m", milliseconds[:, [3, 0, 2, 1]]),
    }
    texts = {name: f"{header}\n{lines(*table.T, separator=',')}" for name, (header, table) in tables.items()}
    return [f"@{name}\n{text}".encode() for name, text in {**texts, "mine.tum": tum(X_WR)}.items()]


def estimates_reader(place: Path) -> Read:
    """Read estimates and judge them by the true poses, with each alignment."""
    folder = _folder(place, estimates())

    def read(data: bytes) -> None:
        with folder.replaced(data) as path:
            trajectory = read_estimate(path)
            for align in Align:
                evaluate_against(T_S, POSE, trajectory, align=align)

    return read


def abouts() -> list[bytes]:
    author = {"family": "Doe", "given": "Jo", "orcid": "0000-0002-1825-0097", "affiliation": "A University"}
    about = {"title": "A drive", "authors": [author], "published": "2026-01-01", "publisher": "Zenodo"}
    return [yaml.safe_dump(about, sort_keys=False).encode()]


def about_reader(place: Path) -> Read:
    file = place / "about.yaml"

    def read(data: bytes) -> None:
        file.write_bytes(data)
        about = read_about(file)
        _ = [*about.doubts(TODAY)], about.address, about.citation

    return read


def splits() -> list[bytes]:
    return [
        b"by: image\nshares: {train: 0.5, test: 0.5}\nseed: 4\n",
        b'splits:\n  runs:\n    train: ["CW/*"]\n',
    ]


def splits_reader(place: Path) -> Read:
    """Divide a dataset of one run as a file says."""
    dataset, file = load(valid_copy("dataset", place)), place / "splits.yaml"

    def read(data: bytes) -> None:
        file.write_bytes(data)
        split_line(with_splits(dataset, str(file)))

    return read


@cache
def keys() -> list[bytes]:
    """Return a public key and secret keys, with a passphrase that takes little memory to check and without one."""
    key = SecretKey.new()
    secret = [key.to_text(passphrase, operations=1 << 15, memory_bytes=1 << 22) for passphrase in ("", PASSPHRASE)]
    texts = {"public": key.public.to_text(), "secret": secret[0], "encrypted": secret[1]}
    return [f"@{name}.key\n{text}".encode() for name, text in texts.items()]


def keys_reader(place: Path) -> Read:
    folder = _folder(place, keys())

    def read(data: bytes) -> None:
        with folder.replaced(data) as path:
            if path.stem == "public":
                read_public_key(str(path))
            else:
                read_secret_key(path, lambda: PASSPHRASE).sign(b"data", "a comment")

    return read


def recordings() -> list[bytes]:
    return [data for data in files("logs") if data.startswith((b"@scan.csv\n", b"@static.csv\n"))]


def recordings_reader(place: Path) -> Read:
    folder = _folder(place, recordings())

    def read(data: bytes) -> None:
        with folder.replaced(data) as path:
            _ = read_scan(path).settled_mm if path.stem == "scan" else read_rest_recording(path)

    return read


def diagnoses() -> list[bytes]:
    """Return the records of two diagnoses; the paths of the cases depend on the folder, so `CASES` stands for it."""
    alone = {"cases": ["CASES/motor_steady_002"], "nominal": ""}
    together = {"cases": ["CASES/drive_log_002", "CASES/drive_log_002"], "importer": "drive_log"}
    return [json.dumps(record).encode() for record in (alone, together)]


def diagnoses_reader(place: Path) -> Read:
    """Read the record of a diagnosis and the first cases of which it was made, as `symolo next` reads all of them."""
    cases = valid_copy("logs", place)

    def read(data: bytes) -> None:
        (place / MADE_FROM).write_bytes(data.replace(b"CASES", str(cases).encode()))
        made_from = read_made_from(place)
        settings = made_from.settings
        robot_of(settings)
        read_case(made_from.paths[0], settings.model_copy(update={"together": settings.together[:2]}))

    return read


def _folder(place: Path, named: list[bytes]) -> Folder:
    """Write files, whose names are in their first lines, into a folder."""
    for data in named:
        line, _, content = data.partition(b"\n")
        (place / line.removeprefix(b"@").decode()).write_bytes(content)
    return Folder.from_path(place)
