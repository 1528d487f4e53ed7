"""The record of what a diagnosis was made from, which a user may have edited."""

import json

import pytest

from pipeline.diagnosing.made_from import MADE_FROM, read_made_from
from symolo.core.errors import InputError


@pytest.fixture
def record(tmp_path):
    """Write a record and read it."""

    def written(**content):
        (tmp_path / MADE_FROM).write_text(json.dumps(content))
        return read_made_from(tmp_path)

    return written


def test_a_record_names_its_cases(record, tmp_path):
    made_from = record(cases=[str(tmp_path), "table-1"], held_out=["2"])
    assert made_from.paths[0] == tmp_path
    assert [str(path) for path in made_from.settings.together] == ["table-1"]


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ({"cases": []}, "cannot be read"),
        ({"cases": ["table-1"], "nominal": "no robot"}, "cannot be read"),
        ({"cases": ["table-1"], "nominal": '{"drive": 1}'}, "cannot be read"),
        ({"cases": ["/" + 300 * "a"]}, "File name too long"),
        ({"cases": ["/a\0b"]}, "null character"),
        ({"cases": ["/nowhere"]}, "no longer there"),
    ],
)
def test_a_record_of_no_case_or_robot_is_refused(content, reason, record):
    with pytest.raises(InputError, match=f"{MADE_FROM}.*{reason}") as raised:
        record(**content)
    assert len(str(raised.value).splitlines()) == 1
