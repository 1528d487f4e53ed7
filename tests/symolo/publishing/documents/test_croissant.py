"""croissant.json is read by mlcroissant, MLCommons' own reader."""

import io
import json
import shutil

import numpy as np
import pytest
from PIL import Image

from pipeline.cli import main

pytestmark = [
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),  # of rdflib, at mlcroissant's way to call it
    pytest.mark.filterwarnings("ignore:unclosed file:ResourceWarning"),  # of mlcroissant, which closes no image
]


@pytest.fixture(scope="module")
def croissant(packed, tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CROISSANT_CACHE", str(tmp_path_factory.mktemp("croissant")))
        import mlcroissant  # noqa: PLC0415 - it reads at import where to unpack

        yield mlcroissant.Dataset(packed.out / "croissant.json")


def test_mlcroissant_finds_nothing_to_say(croissant):
    assert not croissant.metadata.issues.errors
    assert not croissant.metadata.issues.warnings
    assert croissant.metadata.license == ["https://creativecommons.org/licenses/by/4.0/"]


def test_rows_are_those_of_the_release_with_their_types(croissant, packed):
    records = list(croissant.records("rows"))
    table = np.concatenate([run.table for run in packed.truth])
    names = [name for run in packed.truth for name in [run.name] * len(run.table)]
    assert [record["rows/run"].decode() for record in records] == names
    assert [record["rows/x"] for record in records] == table[:, 1].tolist()
    assert [record["rows/img"] for record in records] == table[:, 18].tolist()
    assert (type(records[0]["rows/t"]), type(records[0]["rows/x"])) == (int, float)


def test_the_poses_of_the_camera_are_records_too(croissant, packed):
    records = list(croissant.records("camera"))
    expected = np.concatenate([run.X_WC[:, 0, 3] for run in packed.truth])
    assert [record["camera/p_x"] for record in records] == expected.tolist()


def test_images_have_their_run_their_number_and_their_pixels(croissant, packed):
    """From several shards."""
    expected = {(run.name, i): data for run in packed.truth for i, data in enumerate(run.pictures, start=1)}
    found = {}
    for record in croissant.records("images"):
        found[record["images/run"].decode(), record["images/img"]] = np.asarray(record["images/image"])
    assert found.keys() == expected.keys()
    for key, data in expected.items():
        assert np.array_equal(found[key], np.asarray(Image.open(io.BytesIO(data))))


def test_it_states_how_the_data_came_about_and_what_varies(croissant, packed):
    """In the terms of Croissant RAI 1.0, read from metadata.json."""
    metadata = json.loads((packed.release / "metadata.json").read_bytes())
    described = croissant.metadata
    assert described.conforms_to == ["http://mlcommons.org/croissant/1.1", "http://mlcommons.org/croissant/RAI/1.0"]
    assert f"seed {metadata['seed']}" in described.data_collection
    assert "2 runs" in described.data_collection
    assert described.data_collection_type == ["Software Collection"]
    drawn = [run["drawn"] for run in metadata["runs"]]
    numbers = [name for name, value in drawn[0].items() if isinstance(value, float)]
    assert numbers
    for name in numbers:
        (line,) = [line for line in described.data_biases if line.startswith(f"{name}: ")]
        low, high = (pick(values[name] for values in drawn) for pick in (min, max))
        assert line == f"{name}: {low:.6g} to {high:.6g}"
    assert described.personal_sensitive_information == ["None: no person was recorded."]
    assert "without a person" in described.data_annotation_protocol[0]


@pytest.mark.parametrize("by", ["runs", "images"])
def test_splits_are_record_sets_to_which_the_images_refer(by, random_release, about, sign, tmp_path, monkeypatch):
    """In the way of section "Splits" of the specification of Croissant 1.1."""
    truth = random_release(2, annotated=True)
    root = shutil.copytree(truth.root, tmp_path / "release")
    runs = [run.name for run in truth.runs]
    numbers = {run.name: list(range(1, len(run.pictures) + 1)) for run in truth.runs}
    listed = {"train": runs[:1], "test": runs[1:]}
    divided = {
        "train": {run: n[::2] for run, n in numbers.items()},
        "test": {run: n[1::2] for run, n in numbers.items()},
    }
    record = (
        {"by": "image", "seed": 1, "images": divided} if by == "images" else {"by": "run", "seed": 1, "runs": listed}
    )
    metadata = json.loads((root / "metadata.json").read_text())
    (root / "metadata.json").write_text(json.dumps({**metadata, "splits": record}))
    sign(root)
    out = tmp_path / "upload"
    assert main(["pack", str(root), "--about", str(about), "--out", str(out)]) == 0
    monkeypatch.setenv("CROISSANT_CACHE", str(tmp_path / "cache"))
    import mlcroissant  # noqa: PLC0415 - it reads at import where to unpack

    dataset = mlcroissant.Dataset(out / "croissant.json")
    assert not dataset.metadata.issues.errors
    assert not dataset.metadata.issues.warnings
    (splits,) = [one for one in json.loads((out / "croissant.json").read_text())["recordSet"] if one["@id"] == "splits"]
    assert splits["dataType"] == "cr:Split"
    assert splits["data"] == [
        {"splits/name": "train", "splits/url": "cr:TrainingSplit"},
        {"splits/name": "test", "splits/url": "cr:TestSplit"},
    ]
    got = {
        (record["images/run"].decode(), record["images/img"]): record["images/split"].decode()
        for record in dataset.records("images")
    }
    expected = {
        (run, number): ("train" if run in listed["train"] else "test")
        if by == "runs"
        else ("train" if number in divided["train"][run] else "test")
        for run in runs
        for number in numbers[run]
    }
    assert got == expected
