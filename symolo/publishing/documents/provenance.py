"""Provenance of a release: a statement of in-toto (v1) with the predicate of SLSA provenance (v1).

It says nothing that metadata.json and bag-info.txt do not hold, so the same release gives the same bytes. Tools that
know nothing of symolo read it.
"""

import hashlib
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from symolo.core.files.file_hashes import canonical_json, sha256_of
from symolo.dataset.bag import read_cpu_classes
from symolo.dataset.documents.contents import Contents
from symolo.dataset.documents.metadata import Metadata
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST

STATEMENT_TYPE, PREDICATE_TYPE = "https://in-toto.io/Statement/v1", "https://slsa.dev/provenance/v1"
BUILD_TYPE = "pkg:pypi/symolo#docs/integrity.md"
"""The page that says what the parameters mean."""
BUILDER = "pkg:pypi/symolo"
SUBJECTS = (TAG_MANIFEST, MANIFEST)
"""Files that stand for the release, since they hold the SHA-256 of every other one."""


def provenance(root: Path, metadata: Metadata) -> bytes:
    """Return the statement about a release."""
    programs = dict(metadata.made_with)
    version = {"symolo": programs.pop("symolo", "")}
    statement = {
        "_type": STATEMENT_TYPE,
        "subject": [{"name": name, "digest": {"sha256": sha256_of(root / name)}} for name in SUBJECTS],
        "predicateType": PREDICATE_TYPE,
        "predicate": {
            "buildDefinition": {
                "buildType": BUILD_TYPE,
                "externalParameters": {"scenario": metadata.scenario},
                "internalParameters": {
                    "cpuClasses": list(read_cpu_classes(root)),
                    "renderDevices": list(Contents.from_metadata(metadata).render_devices),
                },
                "resolvedDependencies": [*_packages(programs), *_files(metadata.scenario)],
            },
            "runDetails": {"builder": {"id": BUILDER, "version": version}},
        },
    }
    return canonical_json(statement)


def subject_problem(data: bytes, root: Path) -> str:
    """Return why a statement is not about this release, in words; empty where it is."""
    try:
        subjects = json.loads(data)["subject"]
        stated = {subject["name"]: subject["digest"]["sha256"] for subject in subjects}
    except (ValueError, LookupError, TypeError, RecursionError):
        return "is no statement of in-toto"
    wrong = [name for name in SUBJECTS if stated.get(name) != _digest(root / name)]
    return f"is about another release: it states another SHA-256 of {wrong[0]}" if wrong else ""


def _digest(path: Path) -> str:
    try:
        return sha256_of(path)
    except OSError:
        return ""


def _packages(programs: Mapping[str, str]) -> Iterator[dict[str, Any]]:
    """Yield the programs that made the data, by package URL."""
    for name, version in sorted(programs.items()):
        kind = "generic" if name == "python" else "pypi"
        yield {"name": name, "uri": f"pkg:{kind}/{name}@{version}"}


def _files(scenario: object) -> Iterator[dict[str, Any]]:
    """Yield the scenario, and each file of the user that it names, by SHA-256."""
    digest = hashlib.sha256(canonical_json(scenario)).hexdigest()
    yield {"name": "scenario", "digest": {"sha256": digest}, "mediaType": "application/json"}
    files = sorted({(name, digest) for name, digest in _named_files(scenario)})
    yield from ({"name": name, "digest": {"sha256": digest}} for name, digest in files)


def _named_files(tree: object) -> Iterator[tuple[str, str]]:
    if isinstance(tree, Mapping):
        if isinstance(tree.get("name"), str) and isinstance(tree.get("sha256"), str):
            yield tree["name"], tree["sha256"]
        for value in tree.values():
            yield from _named_files(value)
    elif isinstance(tree, list):
        for value in tree:
            yield from _named_files(value)
