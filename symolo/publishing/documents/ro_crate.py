"""ro-crate-metadata.json: the command that made the dataset, and the files that it made.

A scenario is described as a workflow, of which the release is a run. An import, or a new rendering of trajectories, is
described as a process without a workflow, since the folder contains none that makes the dataset again.

The formats: RO-Crate 1.1 (https://w3id.org/ro/crate/1.1) with the profiles Workflow Run RO-Crate 0.5
(https://w3id.org/ro/wfrun/workflow/0.5) and Workflow RO-Crate 1.0, or Process Run Crate 0.5
(https://w3id.org/ro/wfrun/process/0.5). The package rocrate 0.16 writes ids and times of its
own, so that the same release would not give the same bytes.
"""

from collections.abc import Iterable, Iterator
from typing import Any

from symolo.publishing.about import About, Author
from symolo.publishing.dataset import PackedFile, Published
from symolo.publishing.remaking import SCENARIO, SETTINGS, Remaking

DESCRIPTOR, CARD = "ro-crate-metadata.json", "README.md"
_CONTEXT = ("https://w3id.org/ro/crate/1.1/context", {"sha256": "http://schema.org/sha256"})
"""The context of RO-Crate 1.1 has the terms of schema.org 10, which did not have sha256 yet."""
_CRATE = "https://w3id.org/ro/crate/1.1"
_WORKFLOW_CRATE = "https://w3id.org/workflowhub/workflow-ro-crate/1.0"
_PROCESS = {"https://w3id.org/ro/wfrun/process/0.5": "Process Run Crate"}
_WORKFLOW = {
    **_PROCESS,
    "https://w3id.org/ro/wfrun/workflow/0.5": "Workflow Run Crate",
    _WORKFLOW_CRATE: "Workflow RO-Crate",
}
_BIOSCHEMAS = "https://bioschemas.org/profiles"
_RUN, _SEED, _SEED_VALUE, _LANGUAGE = "#run", "#seed", "#seed-value", "#scenario-language"
_ADDRESS = "https://pypi.org/project/{}/"


def ro_crate(data: Published) -> dict[str, Any]:
    """Return the content of the file."""
    return {"@context": list(_CONTEXT), "@graph": list(_entities(data))}


def _entities(data: Published) -> Iterator[dict[str, Any]]:
    about, licence, made = data.about, data.licence, data.remaking
    files = [*data.shards, *(file for file, _ in data.described_tables)]
    authors = [_author(author, number) for number, author in enumerate(about.authors, start=1)]
    profiles = _WORKFLOW if made.is_workflow else _PROCESS
    yield {
        "@id": DESCRIPTOR,
        "@type": "CreativeWork",
        "about": {"@id": "./"},
        "conformsTo": _ids([_CRATE, _WORKFLOW_CRATE] if made.is_workflow else [_CRATE]),
    }
    yield _dataset(data, [*profiles], [file.name for file in files], [author["@id"] for author in authors])
    yield from _workflow(data) if made.is_workflow else _inputs(made)
    yield {
        "@id": _RUN,
        "@type": "CreateAction",
        "name": made.command,
        "description": made.action,
        "instrument": {"@id": SCENARIO if made.is_workflow else _address("symolo")},
        "agent": {"@id": authors[0]["@id"]},
        "endTime": about.published,
        "object": {"@id": _SEED_VALUE} if made.is_workflow else _ids(_source_ids(made)),
        "result": _ids(file.name for file in files),
        "actionStatus": "http://schema.org/CompletedActionStatus",
    }
    yield from (_file(shard, "application/x-tar", f"the release, below {data.name}/") for shard in data.shards)
    yield from (_file(file, "text/csv", text) for file, text in data.described_tables)
    yield {
        "@id": CARD,
        "@type": "File",
        "name": CARD,
        "about": {"@id": "./"},
        "encodingFormat": "text/markdown",
    }
    yield from authors
    yield from _organisations(about)
    if licence.url:
        yield {"@id": licence.url, "@type": "CreativeWork", "name": licence.name, "identifier": licence.spdx}
    for name, version in sorted(({"symolo": ""} | data.metadata.made_with).items()):
        yield _program(name, version)
    for address, name in profiles.items():
        yield {"@id": address, "@type": "CreativeWork", "name": name, "version": address.rpartition("/")[2]}


def _dataset(data: Published, profiles: list[str], files: list[str], authors: list[str]) -> dict[str, Any]:
    """Return the folder itself; `profiles`, `files` and `authors` are ids of other entities."""
    about, licence, made = data.about, data.licence, data.remaking
    dataset = {
        "@id": "./",
        "@type": "Dataset",
        "conformsTo": _ids(profiles),
        "name": about.title,
        "description": data.description,
        "datePublished": about.published,
        "version": about.version,
        "keywords": ", ".join(data.keywords),
        "license": {"@id": licence.url} if licence.url else licence.name,
        "author": _ids(authors),
        "publisher": {"@id": "#publisher"},
        "hasPart": _ids([made.settings_file, CARD, *files]),
        "mentions": {"@id": _RUN},
    }
    dataset |= {"mainEntity": {"@id": SCENARIO}} if made.is_workflow else {}
    return dataset | ({"identifier": about.address} if about.address else {})


def _organisations(about: About) -> Iterator[dict[str, Any]]:
    for number, author in enumerate(about.authors, start=1):
        if author.affiliation:
            yield {"@id": f"#affiliation-{number}", "@type": "Organization", "name": author.affiliation}
    yield {"@id": "#publisher", "@type": "Organization", "name": about.publisher}


def _source_ids(made: Remaking) -> list[str]:
    return [f"#source-{number}" for number in range(1, len(made.sources) + 1)]


def _inputs(made: Remaking) -> Iterator[dict[str, Any]]:
    """Yield the file with the settings, and the logs and releases, which are not in the folder."""
    yield {
        "@id": SETTINGS,
        "@type": "File",
        "name": SETTINGS,
        "description": made.settings_meaning,
        "encodingFormat": "application/yaml",
    }
    for name, source in zip(_source_ids(made), made.sources, strict=True):
        yield {"@id": name, "@type": "CreativeWork", "name": source.name, "description": source.text} | (
            {"sha256": source.sha256} if source.sha256 else {}
        )


def _workflow(data: Published) -> Iterator[dict[str, Any]]:
    """Yield the scenario, the language in which it is written, and its seed."""
    made_with = data.metadata.made_with
    yield {
        "@id": SCENARIO,
        "@type": ["File", "SoftwareSourceCode", "ComputationalWorkflow"],
        "conformsTo": {"@id": f"{_BIOSCHEMAS}/ComputationalWorkflow/1.0-RELEASE"},
        "name": data.name,
        "description": data.metadata.description or data.name,
        "version": data.about.version,
        "encodingFormat": "application/yaml",
        "programmingLanguage": {"@id": _LANGUAGE},
        "softwareRequirements": _ids(_address(name) for name in sorted(made_with)),
        "input": {"@id": _SEED},
    }
    yield {
        "@id": _LANGUAGE,
        "@type": "ComputerLanguage",
        "name": "symolo scenario",
        "version": made_with.get("symolo", ""),
        "url": {"@id": _address("symolo")},
        "identifier": {"@id": _address("symolo")},
    }
    yield {
        "@id": _SEED,
        "@type": "FormalParameter",
        "conformsTo": {"@id": f"{_BIOSCHEMAS}/FormalParameter/1.0-RELEASE"},
        "name": "seed",
        "description": "Number from which every random value of the dataset is drawn",
        "additionalType": "Integer",
        "valueRequired": "True",
        "workExample": {"@id": _SEED_VALUE},
    }
    yield {
        "@id": _SEED_VALUE,
        "@type": "PropertyValue",
        "name": "seed",
        "value": str(data.metadata.seed),
        "exampleOfWork": {"@id": _SEED},
    }


def _file(file: PackedFile, encoding: str, description: str) -> dict[str, Any]:
    return {
        "@id": file.name,
        "@type": "File",
        "name": file.name,
        "description": description,
        "encodingFormat": encoding,
        "contentSize": str(file.size),
        "sha256": file.sha256,
    }


def _author(author: Author, number: int) -> dict[str, Any]:
    return {
        "@id": author.orcid_url if author.orcid else f"#author-{number}",
        "@type": "Person" if author.given else "Organization",
        "name": author.name,
    } | ({"affiliation": {"@id": f"#affiliation-{number}"}} if author.affiliation else {})


def _program(name: str, version: str) -> dict[str, Any]:
    address = _address(name)
    return {
        "@id": address,
        "@type": "SoftwareApplication",
        "name": name,
        "softwareVersion": version,
        "url": {"@id": address},
    }


def _address(program: str) -> str:
    return "https://www.python.org/" if program == "python" else _ADDRESS.format(program)


def _ids(names: Iterable[str]) -> dict[str, str] | list[dict[str, str]]:
    """Return references; the format recommends a single one without a list."""
    references = [{"@id": name} for name in names]
    return references[0] if len(references) == 1 else references
