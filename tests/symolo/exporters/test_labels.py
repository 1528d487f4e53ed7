"""Who has only an export can read its label images: categories, instances of each run and encodings are in it."""

import json

import pytest

from symolo.exporters.shared import labels
from tests.symolo.exporters.conftest import CATEGORIES, INSTANCES

SEMANTIC_SEED = 2


@pytest.fixture
def annotated(random_release, exported, tmp_path):
    release = random_release(SEMANTIC_SEED, annotated=True)
    return release, exported(release.root, tmp_path / "out", "huggingface", "webdataset")


def test_labels_of_huggingface_and_webdataset_name_each_id(annotated):
    release, out = annotated
    text = (out / "huggingface/labels.json").read_bytes()
    assert text == (out / "webdataset/labels.json").read_bytes()
    content = json.loads(text)
    assert content["categories"] == [{"id": number, "name": name} for number, name in enumerate(CATEGORIES)]
    assert list(content["runs"]) == sorted(truth.name for truth in release.runs)
    for of_run in content["runs"].values():
        assert {one["id"]: (one["name"], one["category_id"]) for one in of_run["instances"]} == INSTANCES
        assert of_run["encodings"].keys() == {"depth", "instance", "semantic", "normals", "flow", "free_floor"}


def test_the_card_of_huggingface_states_categories_instances_and_encodings(annotated):
    release, out = annotated
    card = (out / "huggingface/README.md").read_text()
    for number, name in enumerate(CATEGORIES):
        assert f"\n| {number} | {name} |\n" in card
    for truth in release.runs:
        assert f"\n| {truth.name} | 1 floor, 2 line_0, 3 A1, 4 O1, 5 A10 |\n" in card
    for kind, law in (("flow", "32768 + 64 du"), ("normals", "32768 + 32767 n"), ("depth", "in 0.1 mm")):
        (row,) = [line for line in card.splitlines() if line.startswith(f"| images | {kind} |")]
        assert law in row
    assert "boxes" not in card


def test_a_card_lists_the_instances_of_the_first_runs_only(random_release, exported, tmp_path, monkeypatch):
    monkeypatch.setattr(labels, "MAX_LISTED_RUNS", 1)
    release = random_release(SEMANTIC_SEED, annotated=True)
    card = (exported(release.root, tmp_path / "out", "huggingface") / "huggingface/README.md").read_text()
    assert card.count("1 floor, 2 line_0") == 1
    assert f"labels.json has those of all {len(release.runs)} runs." in card


def test_without_label_images_there_is_no_such_file(random_release, exported, tmp_path):
    out = exported(random_release(1).root, tmp_path / "out", "huggingface", "webdataset")
    assert list(out.rglob("labels.json")) == []
    assert "Label images" not in (out / "huggingface/README.md").read_text()
