import pytest

from symolo.publishing.limits import fits_archives

GB = 10**9


@pytest.mark.parametrize(
    ("sizes", "zenodo", "hub"),
    [
        ([10 * GB] * 5, "fits a record", "fits"),
        ([10 * GB] * 5 + [1], "more than the 50 GB", "fits"),
        ([1] * 101, "101 files are more than the 100", "fits"),
        ([20 * GB + 1], "fits a record", "20 GB that it advises"),
        ([50 * GB + 1], "more than the 50 GB", "50 GB that it takes"),
    ],
)
def test_each_archive_says_what_it_takes(sizes, zenodo, hub):
    lines = fits_archives(sizes)
    assert zenodo in lines[0]
    assert hub in lines[1]
