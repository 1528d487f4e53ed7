"""The JSON Schema of metadata.json, as an independent validator reads it."""

import json

import jsonschema
import pytest

from pipeline.cli import main


@pytest.fixture
def validator(capsys):
    assert main(["schema", "--of", "metadata"]) == 0
    schema = json.loads(capsys.readouterr().out)
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


@pytest.fixture
def metadata(packed):
    return json.loads((packed.release / "metadata.json").read_bytes())


def test_a_released_description_fits_its_schema(validator, metadata):
    validator.validate(metadata)


@pytest.mark.parametrize(
    ("change", "place"),
    [
        (lambda document: document["runs"][0].pop("rows"), ["runs", 0]),
        (lambda document: document["runs"][0].update(rows="ten"), ["runs", 0, "rows"]),
        (lambda document: document.update(runs=[]), ["runs"]),
        (lambda document: document.update(colour="red"), []),
        (lambda document: document["states"].update(first="line following"), ["states"]),
        (lambda document: document["runs"][0]["start"].update(x_m="here"), ["runs", 0, "start", "x_m"]),
        (lambda document: document["runs"][0]["rates"].update(camera_hz=-1), ["runs", 0, "rates"]),
    ],
)
def test_what_is_no_such_description_is_found_in_its_place(validator, metadata, change, place):
    change(metadata)
    assert [list(error.absolute_path) for error in validator.iter_errors(metadata)] == [place]


def test_the_schema_says_what_its_fields_are(validator):
    runs = validator.schema["$defs"]["RunRecord"]["properties"]
    assert runs["drawn"]["description"] == "Every value drawn for this run by its field path."
