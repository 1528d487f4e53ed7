"""`symolo compare`: identical, equal within so many decibels, or different, with closed forms for the decibels."""

import json
import math
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest

from pipeline.work.processors import class_of, cpu_class
from symolo.compare.folders import Verdict, compare
from symolo.dataset.manifest import SEALS

TABLE = "t,x,state\n0,4.0,0\n50,-8.0,0\n100,2.0,1\n"


@pytest.fixture
def pair(tmp_path):
    """Two folders of the same run: an image, a mask, a table and a document."""
    a = tmp_path / "a"
    (a / "annotations/instance").mkdir(parents=True)
    cv2.imwrite(str(a / "000001.png"), np.full((6, 8, 3), 100, np.uint8))
    cv2.imwrite(str(a / "annotations/instance/000001.png"), np.full((6, 8), 300, np.uint16))
    (a / "data.csv").write_text(TABLE)
    (a / "spec.json").write_text(json.dumps({"seed": 1, "look": {"sun": 2.0, "name": "lab"}, "none": []}))
    return a, Path(shutil.copytree(a, tmp_path / "b"))


def only(pair, tolerance_db=50.0):
    """The one file that is not the same bytes."""
    (result,) = [result for result in compare(*pair, tolerance_db) if result.verdict is not Verdict.IDENTICAL]
    return result


def test_a_copy_is_identical(pair, symolo):
    assert {result.verdict for result in compare(*pair, 50.0)} == {Verdict.IDENTICAL}
    ended = symolo("compare", *pair)
    assert (ended.code, ended.out) == (0, "identical: 4 files\n")


@pytest.mark.parametrize(("step", "expected_db"), [(1, 20 * math.log10(255)), (5, 20 * math.log10(255 / 5))])
def test_images_are_distinguished_by_their_psnr(pair, step, expected_db):
    cv2.imwrite(str(pair[1] / "000001.png"), np.full((6, 8, 3), 100 + step, np.uint8))
    result = only(pair, tolerance_db=expected_db - 0.01)
    assert result.verdict is Verdict.CLOSE
    assert result.likeness.level_db == pytest.approx(expected_db)
    assert only(pair, tolerance_db=expected_db + 0.01).verdict is Verdict.DIFFERENT


def test_one_wrong_pixel_is_named(pair, symolo):
    picture = np.full((6, 8, 3), 100, np.uint8)
    picture[4, 3, 1] = 130
    cv2.imwrite(str(pair[1] / "000001.png"), picture)
    ended = symolo("compare", *pair, "--tolerance-db", 30)
    level_db = 20 * math.log10(255 / 30) + 10 * math.log10(6 * 8 * 3)
    assert (
        f"000001.png: equal within {level_db:.1f} dB: 1 of 48 pixels differ, the most by 30 at x = 3, y = 4"
        in ended.out
    )
    assert ended.code == 6
    assert ended.out.splitlines()[-1].startswith(f"equal within {level_db:.1f} dB: 3 of 4 files identical")


def test_the_same_pixels_in_another_file_are_equal(pair):
    picture = cv2.imread(str(pair[0] / "000001.png"))
    cv2.imwrite(str(pair[1] / "000001.png"), picture, [cv2.IMWRITE_PNG_COMPRESSION, 0])
    result = only(pair, tolerance_db=1000)
    assert (result.verdict, result.likeness.what) == (Verdict.CLOSE, "the same pixels in other bytes")


def test_an_id_is_no_amount(pair):
    mask = np.full((6, 8), 300, np.uint16)
    mask[0, 0] = 301
    cv2.imwrite(str(pair[1] / "annotations/instance/000001.png"), mask)
    result = only(pair, tolerance_db=0)
    assert (result.verdict, result.likeness.what) == (Verdict.DIFFERENT, "1 of 48 pixels differ, which are ids")


def test_pictures_of_other_sizes_or_no_pictures_are_different(pair):
    cv2.imwrite(str(pair[1] / "000001.png"), np.zeros((6, 9, 3), np.uint8))
    assert "8 x 6 px, 3 channels of uint8 in A, 9 x 6 px" in str(only(pair, 0))
    (pair[1] / "000001.png").write_bytes(b"\x89PNG nothing")
    assert "the image of B cannot be decoded" in str(only(pair, 0))


def test_columns_are_distinguished_by_their_largest_difference(pair):
    """Peak 8, one of three rows off by 0.008: 20 log10(1000) + 10 log10(3) dB."""
    (pair[1] / "data.csv").write_text(TABLE.replace("-8.0", "-8.008"))
    result = only(pair)
    assert result.likeness.level_db == pytest.approx(60 + 10 * math.log10(3))
    assert result.likeness.what == "column x: by up to 0.008 at line 3"
    assert result.verdict is Verdict.CLOSE
    assert only(pair, tolerance_db=70).verdict is Verdict.DIFFERENT


@pytest.mark.parametrize(
    ("table", "what"),
    [
        (TABLE.replace("100,2.0,1", "100,2.0,2"), "column state: 1 in A, 2 in B at line 4; different in 1 row"),
        (TABLE.replace("4.0", "nan"), "column x: 4 in A, nan in B at line 2"),
        (TABLE.replace("x,", "y,"), "columns t,x,state in A, t,y,state in B"),
        (TABLE + "150,1.0,1\n", "3 rows in A, 4 in B"),
        (TABLE.replace("4.0", "much"), "line 2 differs"),
        ("", "4 lines in A, 0 in B"),
    ],
)
def test_tables_that_no_tolerance_makes_equal(pair, table, what):
    (pair[1] / "data.csv").write_text(table)
    result = only(pair, tolerance_db=0)
    assert result.verdict is Verdict.DIFFERENT
    assert what in result.likeness.what


@pytest.mark.parametrize(
    ("change", "level_db", "what"),
    [
        ({"look": {"sun": 2.002, "name": "lab"}}, 60.0, "look.sun: 2.0 in A, 2.002 in B"),
        ({"look": {"sun": 2.0, "name": "lap"}}, -math.inf, "look.name: 'lab' in A, 'lap' in B"),
        ({"none": [1]}, -math.inf, "none: '[]' in A, nothing in B; none.0: nothing in A, 1 in B"),
        ({"seed": True}, -math.inf, "seed: 1 in A, true in B"),
        (
            {"seed": 2, "look": {"sun": 2.002, "name": "lap"}},
            -math.inf,
            "look.name: 'lab' in A, 'lap' in B; seed: 1 in A, 2 in B; look.sun: 2.0 in A, 2.002 in B",
        ),
        (
            {"none": list("abcdef")},
            -math.inf,
            "none: '[]' in A, nothing in B; "
            + "; ".join(f"none.{number}: nothing in A, {letter!r} in B" for number, letter in enumerate("abcd"))
            + "; and 2 more",
        ),
    ],
)
def test_documents_are_distinguished_by_their_leaves(pair, change, level_db, what):
    content = json.loads((pair[0] / "spec.json").read_text()) | change
    (pair[1] / "spec.json").write_text(json.dumps(content))
    result = only(pair)
    assert result.likeness.level_db == pytest.approx(level_db)
    assert result.likeness.what == what


def test_files_of_one_side_and_links_are_named(pair, symolo):
    (pair[0] / "data.csv").unlink()
    (pair[1] / "000001.png").unlink()
    (pair[1] / "spec.json").unlink()
    (pair[1] / "spec.json").symlink_to(pair[0] / "spec.json")
    ended = symolo("compare", *pair)
    assert ended.code == 7
    assert ended.out.splitlines()[:2] == ["000001.png: only in A", "data.csv: only in B"]
    assert "spec.json: different (not alike): " in ended.out
    assert "is no regular file" in ended.out
    assert ended.out.splitlines()[-1] == "different: 1 different, 1 only in A, 1 only in B; 1 of 4 files identical"


def test_what_cannot_be_compared_is_refused_in_one_line(pair, tmp_path, symolo):
    for paths in ((pair[0], tmp_path / "none"), (pair[0], pair[1] / "data.csv")):
        ended = symolo("compare", *paths)
        assert (ended.code, ended.err.count("\n")) == (2, 1)


def test_processors_and_programs_that_differ_are_reported(pair, symolo):
    cpus = ("x86-64-v3 GenuineIntel family 6", "x86-64-v4 AuthenticAMD family 25")
    for folder, cpu in zip(pair, cpus, strict=True):
        (folder / "bag-info.txt").write_text(f"Payload-Oxum: 1.1\nCPU-Class: {cpu}\n")
    ended = symolo("compare", *pair)
    assert ended.code == 6
    assert ended.out.splitlines() == [
        "bag-info.txt: differs, because it lists or describes the other files",
        f"other CPU class, which may decide low bits: {cpus[0]} in A, {cpus[1]} in B",
        "the same values: 4 of 5 files identical, no number or pixel differs in the others",
    ]


V3 = "cx16 lahf_lm popcnt sse4_1 sse4_2 ssse3 avx avx2 bmi1 bmi2 f16c fma abm movbe xsave"
V4 = f"{V3} avx512f avx512bw avx512cd avx512dq avx512vl"


@pytest.mark.parametrize(
    ("cpuinfo", "expected"),
    [
        (f"vendor_id\t: AuthenticAMD\ncpu family\t: 25\nflags\t\t: fpu {V3}\n", "x86-64-v3 AuthenticAMD family 25"),
        (f"vendor_id\t: GenuineIntel\ncpu family\t: 6\nflags\t\t: {V4}\n", "x86-64-v4 GenuineIntel family 6"),
        # Without fma a processor is of the second level, whatever else it has.
        (f"vendor_id\t: X\ncpu family\t: 6\nflags\t\t: {V4.replace(' fma', '')}\n", "x86-64-v2 X family 6"),
        ("vendor_id\t: X\ncpu family\t: 15\nflags\t\t: fpu sse2\n", "x86-64-v1 X family 15"),
        (
            "Features\t: fp asimd sve\nCPU implementer\t: 0x41\nCPU part\t: 0xd40\n",
            "aarch64 sve implementer 0x41 part 0xd40",
        ),
        ("", "aarch64"),
    ],
)
def test_the_class_of_a_processor_is_its_level_maker_and_family(cpuinfo, expected):
    """Levels as in the x86-64 psABI, section 3.1.1."""
    assert class_of(cpuinfo, "aarch64") == expected


def test_a_processor_whose_kernels_the_environment_names_is_of_another_class(monkeypatch):
    """OpenBLAS then takes the kernels of that core (its USAGE.md), and low bits of NumPy's products are others."""
    monkeypatch.delenv("OPENBLAS_CORETYPE", raising=False)
    by_itself = cpu_class()
    monkeypatch.setenv("OPENBLAS_CORETYPE", "Prescott")
    assert cpu_class() == f"{by_itself} OPENBLAS_CORETYPE=Prescott"


@pytest.mark.parametrize("name", SEALS)
def test_what_signing_adds_is_not_compared(pair, symolo, name):
    a, b = pair
    (a / name).write_text("signed with one key")
    assert symolo("compare", a, b).out == "identical: 4 files\n"
    (b / name).write_text("signed with another key")
    assert symolo("compare", a, b).code == 0


def test_a_file_in_another_form_has_the_same_values(pair):
    (pair[1] / "spec.json").write_text(json.dumps(json.loads((pair[0] / "spec.json").read_text()), indent=4))
    assert str(only(pair)) == "spec.json: the same values: differs only in how it was made, or in its form"


def test_settings_of_two_releases_that_differ_are_listed(painted, tmp_path, symolo):
    a = painted()
    b = painted(settings=["look.sun.elevation_deg=60", "look.boards.wear={uniform: [0.2, 0.3]}"])
    page = tmp_path / "page.html"
    lines = symolo("compare", a, b, "--page", page).out.splitlines()
    settings = [line for line in lines if line.startswith("other setting")]
    assert "other setting look.sun.elevation_deg: uniform 18 to 50 in A, 60 in B" in settings
    assert "other setting look.boards.wear: uniform 0.1 to 0.8 in A, uniform 0.2 to 0.3 in B" in settings
    assert len(settings) == 2
    assert "look.sun.elevation_deg" in page.read_text()
    assert [one["setting"] for one in json.loads(symolo("compare", a, b, "--json").out)["settings"]] == [
        "look.boards.wear",
        "look.sun.elevation_deg",
    ]
