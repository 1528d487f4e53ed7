"""What many images would cost: sums by hand, and a few that are really made."""

import re
from dataclasses import replace

import pytest

from pipeline.planning.price import Price

PRICE = Price(
    device="CPU",
    images=12,
    rows_per_image=4.0,
    simulate_s=0.036,
    start_s=18.0,
    first_s=0.0,
    render_s=3.24,
    annotate_s=0.36,
    image_bytes=97_600.0,
    annotation_bytes=100_000.0,
)


def test_a_million_images_cost_a_million_times_one_and_their_share_of_a_block():
    """3.24 s and 18 s / 50 are 3.6 s, a thousandth of an hour; a row takes 600 bytes."""
    text = PRICE.text(1_000_000, "640 x 480 px")
    printed = dict(re.findall(r"^(\w+) +([\d.,]+ \S+)", text, re.MULTILINE))
    assert printed["simulate"] == "10 core-hours"
    assert printed["render"] == "1,000 core-hours:"
    assert printed["annotate"] == "200 core-hours"
    assert printed["disk"] == "100 GB,"
    assert "with all annotations 200 GB" in text
    assert "shards     100 of 1 GB, with all annotations 200" in text
    assert "No graphics card was measured" in text


def test_what_a_first_image_takes_longer_counts_once_a_block_and_not_for_annotations():
    """90 s / 50 are half of 3.6 s."""
    text = replace(PRICE, first_s=90.0).text(1_000_000, "some")
    assert "render     1,500 core-hours: 3.24 s per image, 108 s per block" in text
    assert "annotate   200 core-hours" in text


def test_a_card_is_priced_in_hours_of_its_own():
    text = replace(PRICE, device="OPTIX").text(1000, "some")
    assert "1 OPTIX-hours" in text
    assert "No graphics card" not in text


@pytest.mark.long
def test_a_few_images_are_made_timed_and_thrown_away(monkeypatch, tmp_path, symolo, tiny):
    monkeypatch.setattr("pipeline.planning.price.RUNS", 1)
    monkeypatch.setattr("pipeline.planning.price.IMAGES", 2)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    ended = symolo("plan", "smoke", *tiny, "--images", 50)
    assert ended.code == 0
    assert "50 images of 32 x 24 px" in ended.out
    assert "2 images of 1 draws" in ended.out
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("frames", ["0", "-1", "many"])
def test_no_number_of_images_is_refused(symolo, frames):
    assert symolo("plan", "smoke", "--images", frames).code == 2
