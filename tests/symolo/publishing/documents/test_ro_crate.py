"""ro-crate-metadata.json by the rules of its profiles; `.ci/crate` asks their own validator, which needs a network."""

import hashlib
import json
from pathlib import Path

import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.cli import main

RELEASE = Path(__file__).parents[3] / "fuzz/corpus/dataset/valid"
"""A small one that was made from a scenario."""


@pytest.fixture(scope="module")
def graph(packed):
    crate = json.loads((packed.out / "ro-crate-metadata.json").read_bytes())
    # The context of RO-Crate 1.1 has the terms of schema.org 10, which did not have sha256 yet.
    assert crate["@context"] == ["https://w3id.org/ro/crate/1.1/context", {"sha256": "http://schema.org/sha256"}]
    entities = crate["@graph"]
    assert len({entity["@id"] for entity in entities}) == len(entities)
    return {entity["@id"]: entity for entity in entities}


def ids(value):
    return [one["@id"] for one in (value if isinstance(value, list) else [value])]


def test_every_entity_that_is_referred_to_is_there(graph):
    elsewhere = ("https://w3id.org/ro/crate/1.1", "https://bioschemas.org/profiles/")
    for entity in graph.values():
        for value in entity.values():
            for one in value if isinstance(value, list) else [value]:
                if isinstance(one, dict):
                    assert one["@id"] in graph or one["@id"].startswith(elsewhere) or one["@id"] == entity.get("url")


def test_its_files_are_those_of_the_folder_with_their_checksums(graph, packed):
    files = {name: entity for name, entity in graph.items() if "File" in entity["@type"]}
    documents = {"CITATION.cff", "croissant.json", "datacite.json", "SHA256SUMS", "ro-crate-metadata.json"}
    assert files.keys() == {path.name for path in packed.out.iterdir()} - documents
    for name, entity in files.items():
        if "sha256" in entity:
            content = (packed.out / name).read_bytes()
            assert (entity["sha256"], entity["contentSize"]) == (hashlib.sha256(content).hexdigest(), str(len(content)))
    assert set(ids(graph["./"]["hasPart"])) == files.keys()


def test_its_run_names_the_workflow_what_went_in_and_what_came_out(graph):
    """What Workflow Run Crate 0.5 requires of the main entity, the action and the parameter."""
    (workflow,), (action,) = ids(graph["./"]["mainEntity"]), ids(graph["./"]["mentions"])
    assert set(graph[workflow]["@type"]) == {"File", "SoftwareSourceCode", "ComputationalWorkflow"}
    assert graph[ids(graph[workflow]["programmingLanguage"])[0]]["@type"] == "ComputerLanguage"
    assert ids(graph[action]["instrument"]) == [workflow]
    (parameter,), (value,) = ids(graph[workflow]["input"]), ids(graph[action]["object"])
    assert ids(graph[parameter]["workExample"]) == [value]
    assert ids(graph[value]["exampleOfWork"]) == [parameter]
    results = ids(graph[action]["result"])
    assert {"rows.csv"} < set(results)
    assert all("sha256" in graph[name] for name in results)


def test_its_profiles_are_named_with_their_versions(graph):
    assert set(ids(graph["./"]["conformsTo"])) == {
        "https://w3id.org/ro/wfrun/process/0.5",
        "https://w3id.org/ro/wfrun/workflow/0.5",
        "https://w3id.org/workflowhub/workflow-ro-crate/1.0",
    }


def test_its_scenario_draws_the_runs_of_the_release_again(about, tmp_path):
    assert main(["pack", str(RELEASE), "--about", str(about), "--out", str(tmp_path / "upload")]) == 0
    scenario = load_scenario(str(tmp_path / "upload/scenario.yaml"))
    (run,) = json.loads((RELEASE / "metadata.json").read_bytes())["runs"]
    assert run["run"] == "CW/test_1"
    assert run["drawn"]
    assert draw_run(scenario, "CW", 1).drawn == run["drawn"]
