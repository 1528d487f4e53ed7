"""Messages about the file with the facts about a publication."""

from datetime import date

import pytest

from symolo.core.errors import InputError
from symolo.publishing.about import read_about

ABOUT = """title: A labelled robot
authors:
  - {family: Newcomer, orcid: 0000-0002-1825-0097}
published: "2026-11-22"
publisher: Zenodo
"""


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("keywords: robots, vision", r"keywords: got 'robots, vision', allowed: a list; write \[robots, vision\]"),
        ("keywords: robots", r"keywords: got 'robots', allowed: a list; write \[robots\]"),
        ("version: 1", r'version: got 1, allowed: a version such as 1\.0\.0; write it as text: version: "1\.0\.0"'),
        (
            "version: 1.2",
            r'version: got 1\.2, allowed: a version such as 1\.0\.0; write it as text: version: "1\.2\.0"',
        ),
        ("description: 5", r'description: got 5, allowed: text; write it as text: description: "5"'),
        ("licence: MIT", r"licence: unknown key.*; the licence is that of the scenario: write it there"),
    ],
)
def test_a_value_of_another_kind_is_named_with_what_to_write(line, message, tmp_path):
    path = tmp_path / "about.yaml"
    path.write_text(f"{ABOUT}{line}\n")
    with pytest.raises(InputError, match=message):
        read_about(path)


def test_authors_that_are_no_list_are_named_with_an_example(tmp_path):
    path = tmp_path / "about.yaml"
    start = ABOUT.index("authors")
    path.write_text(f"{ABOUT[:start]}authors: Eight Newcomer\n{ABOUT[ABOUT.index('published') :]}")
    with pytest.raises(
        InputError, match=r"authors: got 'Eight Newcomer', allowed: a list; write \[\{family: Eight Newco"
    ):
        read_about(path)


@pytest.mark.parametrize(
    ("published", "publisher", "doubts"),
    [
        ("2026-11-22", "Zenodo", []),
        ("2027-11-28", "University of Somewhere", []),
        ("2031-11-28", "Zenodo", ["published: 2031-11-28 is more than a year ahead"]),
        ("2026-11-22", "zenodo", ["publisher: zenodo writes its name Zenodo, as citations should"]),
    ],
)
def test_a_far_date_and_a_name_of_an_archive_in_other_letters_are_doubted(published, publisher, doubts, tmp_path):
    path = tmp_path / "about.yaml"
    path.write_text(ABOUT.replace("2026-11-22", published).replace("Zenodo", publisher))
    assert [*read_about(path).doubts(date(2026, 11, 28))] == doubts
