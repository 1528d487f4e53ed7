"""Readers of what a dataset says about itself, as `readers.py` has them: documents, and the records of own code."""

import hashlib
import io
import json
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr
from pathlib import Path
from typing import Any

from configs.user_files import ROBOT_FILES
from pipeline.assembly.description import markdown
from pipeline.code_files import code_file_lines, extracted
from pipeline.run_folder.status import status
from pipeline.run_folder.stored_spec import read_spec, spec_problem
from symolo.core.errors import FaultList
from symolo.core.progress import LineReport
from symolo.dataset.layout import SIDE, SPEC, STAGES
from symolo.publishing.about import About
from symolo.publishing.documents.provenance import provenance
from symolo.publishing.pack import pack, plan
from symolo.reader.dataset import load
from symolo.report.media import Media
from symolo.report.page import page
from symolo.report.statistics.facts import release_facts
from symolo.verification.verify import verify
from tests.fuzz.folders import Folder, files, sealed, valid_copy
from tests.fuzz.guard import Read

RUN = "CW/test_1"
SPECIFICATION = f"{RUN}/{SIDE}/{SPEC}"
ABOUT = {"title": "A drive", "authors": [{"family": "Doe"}], "published": "2026-01-01", "publisher": "Zenodo"}
NO_MEDIA = Media((), 0, {}, {}, {}, b"", b"", 0)
"""Plots take seconds each, and show nothing of a document."""
EXECUTED = "SYMOLO_CODE_OF_A_DATASET"
"""Environment variable that the code in the records sets."""
CODE = f'import os\n\nos.environ["{EXECUTED}"] = "executed"\nraise SystemExit\n'


def documents() -> list[bytes]:
    names = (b"@metadata.json\n", f"@{SPECIFICATION}\n".encode())
    return [data for data in files("dataset") if data.startswith(names)]


def documents_reader(place: Path) -> Read:
    """Make the pages and descriptions of a dataset that follow from its documents, in every format."""
    folder = Folder.from_path(valid_copy("dataset", place))
    about = About.model_validate(ABOUT)

    def read(data: bytes) -> None:
        faults = FaultList()
        with folder.replaced(data) as path, sealed(folder.root, path), redirect_stderr(io.StringIO()):
            dataset = load(folder.root)
            assert dataset.metadata is not None
            with faults.noted():
                markdown(dataset.metadata, read_spec(folder.root / SPECIFICATION))
            with faults.noted():
                provenance(folder.root, dataset.metadata)
            with faults.noted():
                page(release_facts(dataset, dataset.metadata, 1, LineReport()), NO_MEDIA)
            with faults.noted(), _new(place / "packed") as out:
                pack(plan(folder.root, about, 1_000_000), out, LineReport())
        faults.check()

    return read


def code_records() -> list[bytes]:
    """Return the documents of a dataset with an own sensor and an own effect, with the text of their files."""
    return [_with_code(data) for data in documents()]


def _with_code(data: bytes) -> bytes:
    line, _, content = data.partition(b"\n")
    tree = json.loads(content)
    robot = tree["scenario"]["robot"] if "scenario" in tree and "robot" not in tree else tree["robot"]
    robot["sensors"] = {"front": {"kind": "feeler", "period_s": 0.05, "delay_s": 0.0, "gain": 2}}
    robot["effects"] = {"leaky_shunt": {"share": 0.05}}
    robot["sensor_files"], robot["effect_files"] = [_record("feeler")], [_record("leaky_shunt")]
    if "sensors" in tree or "columns" in tree:
        tree["sensors"] = {"front": {"kind": "feeler", "meaning": "distance"}}
        column = {"decimals": 3, "meaning": "time of the sample since the start of the run", "name": "t", "unit": "ms"}
        tree["columns"][f"{SIDE}/front.csv"] = [column, {**column, "name": "distance", "unit": "m"}]
    return line + b"\n" + json.dumps(tree).encode()


def _record(name: str) -> dict[str, str]:
    return {"name": name, "file": f"{name}.py", "sha256": hashlib.sha256(CODE.encode()).hexdigest(), "text": CODE}


def code_reader(place: Path) -> Read:
    """Read a dataset, and a run that was only simulated, with such records: nothing of them is executed or loaded.

    The SHA-256 of a changed text is made to fit.
    """
    root = valid_copy("dataset", place)
    for data in code_records():
        line, _, content = data.partition(b"\n")
        (root / line.removeprefix(b"@").decode()).write_bytes(content)
    folder = Folder.from_path(root)
    simulated = place / "simulated"
    stage = simulated / STAGES / "simulate" / RUN
    shutil.copytree(root / STAGES / "simulate" / RUN, stage)

    def read(data: bytes) -> None:
        faults = FaultList()
        with folder.replaced(data) as path:
            path.write_bytes(_with_fitting_hashes(path.read_bytes()))
            shutil.copy(root / SPECIFICATION, stage / SPEC)
            with sealed(root, path):
                list(map(str, verify(root, spec_problem)))
                status(root)
                for source in (root, simulated):
                    list(code_file_lines(source))
                    for kind in ROBOT_FILES:
                        with faults.noted(), _new(place / "inner" / "out") as out:
                            extracted(source, out, kind)
        assert EXECUTED not in os.environ
        assert not any(kind.family.files for kind in ROBOT_FILES)
        faults.check()

    return read


def _with_fitting_hashes(data: bytes) -> bytes:
    def fitted(tree: dict[str, Any]) -> dict[str, Any]:
        if isinstance(text := tree.get("text"), str) and "sha256" in tree:
            tree["sha256"] = hashlib.sha256(text.encode(errors="surrogatepass")).hexdigest()
        return tree

    try:
        return json.dumps(json.loads(data, object_hook=fitted)).encode(errors="surrogatepass")
    except (ValueError, RecursionError):
        return data


@contextmanager
def _new(out: Path) -> Iterator[Path]:
    """Yield the path of a folder that a reader may make, and nothing beside it."""
    out.parent.mkdir(exist_ok=True)
    before = set(out.parent.iterdir())
    try:
        yield out
    finally:
        made = set(out.parent.iterdir()) - before
        shutil.rmtree(out, ignore_errors=True)
        assert made <= {out}
