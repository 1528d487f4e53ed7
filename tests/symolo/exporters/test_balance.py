"""Content of each split, counted again from the label images that were put into a release."""

import html
import json
import re

import numpy as np
import pytest

import symolo as library
from symolo.reader.balance import balance

CLASSES = {1: "floor", 2: "line", 3: "wall", 4: "obstacle", 5: "wall"}
"""Of the instances by id."""


@pytest.fixture
def divided(random_release, copy_of, sign):
    """A release with these annotations and these splits."""

    def make(kinds, splits, seed=2):
        root = copy_of(random_release(seed, kinds=kinds).root)
        metadata = json.loads((root / "metadata.json").read_text())
        (root / "metadata.json").write_text(json.dumps(metadata | {"splits": splits}))
        sign(root)
        return root

    return make


BY_RUN = {"by": "run", "seed": 1, "runs": {"train": ["CW/test_1"], "test": ["CCW/test_1"]}}


def counted(images):
    """Images that show each class, and instances of each class in all images, of label images (N, H, W)."""
    seen = [{one for one in np.unique(ids).tolist() if one} for ids in images]
    names = sorted({CLASSES[one] for ones in seen for one in ones})
    with_class = {name: sum(any(CLASSES[one] == name for one in ones) for ones in seen) for name in names}
    return with_class, {name: sum(CLASSES[one] == name for ones in seen for one in ones) for name in names}


def test_images_classes_and_speeds_of_each_split_are_those_of_its_runs(divided, random_release):
    release = random_release(2, kinds=("instance",))
    statistics = balance(library.load(divided(("instance",), BY_RUN)))
    assert [split.name for split in statistics.splits] == ["train", "test"]
    for split, truth in zip(statistics.splits, release.runs, strict=True):
        with_class, instances = counted(truth.instances)
        assert (split.images, [*split.runs], [*split.routes]) == (
            len(truth.pictures),
            [truth.name],
            [truth.name.partition("/")[0]],
        )
        assert ([*split.looks], [*split.robots]) == (["classroom"], ["nominal"])
        assert (dict(split.images_by_class), dict(split.instances)) == (with_class, instances)
        speeds = truth.table[truth.table[:, 18] > 0, 5]
        assert split.speeds_m_s == [speeds.min(), speeds.max()]
    rows = dict(statistics.rows)
    lines = [str(sum(not np.any(ids == 2) for ids in truth.instances)) for truth in release.runs]
    assert rows["images without the line"] == lines


def test_splits_by_image_count_only_their_images(divided, random_release):
    first, second = random_release(2, kinds=("instance",)).runs
    splits = {
        "by": "image",
        "seed": 1,
        "images": {"train": {first.name: [1]}, "test": {first.name: [2], second.name: [1]}},
    }
    train, test = (statistics := balance(library.load(divided(("instance",), splits)))).splits
    assert (train.images, test.images) == (1, 2)
    assert dict(train.instances) == counted(first.instances[:1])[1]
    assert dict(test.instances) == counted([first.instances[1], second.instances[0]])[1]
    assert "Splits by image: neighbouring images of a run are nearly alike" in statistics.warnings[0]


def test_a_class_that_a_split_lacks_is_a_warning(divided):
    """Walls and obstacles by their boxes; of the test, all boxes are hidden."""
    root = divided(("boxes_2d",), BY_RUN, seed=1)
    path = root / "CCW/test_1/annotations/annotations.json"
    document = json.loads(path.read_text())
    for one in document["annotations"]:
        one |= {"bbox": [0, 0, 0, 0], "area": 0}
    path.write_text(json.dumps(document))
    statistics = balance(library.load(root))
    assert statistics.warnings == (
        'No image of the split "test" shows the annotated class "wall"',
        'No image of the split "test" shows the annotated class "obstacle"',
    )
    assert not statistics.knows_line
    assert dict(statistics.rows)["images with wall"][1] == "0"


def test_without_annotations_classes_are_not_known_and_without_splits_there_is_nothing(divided, random_release):
    statistics = balance(library.load(divided((), BY_RUN)))
    assert (statistics.classes, statistics.warnings, statistics.knows_line) == ((), (), False)
    assert balance(library.load(random_release(2).root)) is None


def test_the_report_and_the_card_of_hugging_face_show_the_splits(divided, random_release, symolo, tmp_path):
    root, page, out = divided(("instance",), BY_RUN), tmp_path / "report.html", tmp_path / "out"
    assert symolo("report", root, "--detail", 1, "--out", page).code == 0
    assert symolo("export", root, "--format", "huggingface", "--out", out).code == 0
    counts = [len(truth.pictures) for truth in random_release(2, kinds=("instance",)).runs]
    (section,) = re.findall(r'<h2 id="splits">(.*?)<h2', html.unescape(page.read_text()), re.DOTALL)
    assert f'<th>images</th><td class="n">{counts[0]}</td><td class="n">{counts[1]}</td>' in section
    assert f"| images | {counts[0]} | {counts[1]} |\n" in (out / "huggingface/README.md").read_text()
    assert "<p>Divided by run.</p>" in section
    assert "\nDivided by run.\n" in (out / "huggingface/README.md").read_text()
    for warning in balance(library.load(root)).warnings:
        assert f'<p class="warn">{warning}.</p>' in section
        assert f"- {warning}.\n" in (out / "huggingface/README.md").read_text()


@pytest.mark.parametrize(("factor", "in_another"), [(1.0, "1"), (1.5, "0")])
def test_an_arena_that_differs_in_a_drawn_value_is_another_one(factor, in_another, divided, sign):
    root = divided((), BY_RUN)
    arena = json.loads((root / "CW/test_1/side/spec.json").read_text())["arena"]
    for run, times in (("CW/test_1", 1.0), ("CCW/test_1", factor)):
        path = root / run / "side/spec.json"
        line = arena["line"] | {"width_m": times * arena["line"]["width_m"]}
        path.write_text(json.dumps(json.loads(path.read_text()) | {"arena": arena | {"line": line}}))
    sign(root)
    rows = dict(balance(library.load(root)).rows)
    assert (rows["arenas"], rows["arenas that another split has too"]) == (["1", "1"], [in_another, in_another])


def without_images(root, *runs):
    for run in runs:
        table = root / run / "data.csv"
        header, *rows = table.read_text().splitlines()
        assert header.split(",")[18] == "img"
        emptied = (",".join([*row.split(",")[:18], "0", *row.split(",")[19:]]) for row in rows)
        table.write_text("\n".join([header, *emptied]) + "\n")


def test_a_dataset_without_images_has_no_warning_about_them_and_their_classes(divided, symolo, tmp_path, sign):
    """With `camera_hz: 0` no image was meant to be made. If only one split has none, this is a warning."""
    root = divided((), BY_RUN)
    without_images(root, "CCW/test_1")
    assert balance(library.load(root)).warnings == ('The split "test" has no images',)
    without_images(root, "CW/test_1")
    assert balance(library.load(root)).warnings == ()
    sign(root)
    symolo("report", root, "--out", tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    assert "Training, validation and test" in page
    assert "classes are not known" not in page
