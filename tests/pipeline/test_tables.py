"""data.csv as text: fixed digits, and strict reading."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from configs.errors import InputError
from pipeline.dataset.manifest import manifest, read_manifest
from pipeline.dataset.rows import HEADER, Rows, csv_bytes, parse_table, read_rows, wrapped
from pipeline.rerender import image_numbers

NUMBERS = st.floats(-1e6, 1e6)


def test_text_has_the_digits_asked_for_and_no_negative_zero():
    assert csv_bytes(("a", "b"), (0, 3), np.array([[2.0, -0.0001], [-3.0, 1.23456]])) == b"a,b\n2,0.000\n-3,1.235\n"


@given(st.lists(st.tuples(NUMBERS, NUMBERS), min_size=1, max_size=5))
def test_what_was_written_is_read_to_the_last_digit(rows):
    text = csv_bytes(("a", "b"), (6, 6), np.array(rows))
    table, faults = parse_table(text, ("a", "b"))
    assert faults == []
    np.testing.assert_allclose(table, np.array(rows), atol=0.51e-6, rtol=0)
    assert csv_bytes(("a", "b"), (6, 6), table) == text


@given(st.floats(-50, 50))
def test_wrapped_headings_point_the_same_way(yaw):
    (heading,) = wrapped(np.array([yaw]))
    assert -math.pi < heading <= math.pi
    assert math.cos(heading - yaw) == pytest.approx(1, abs=1e-9)


def test_half_a_turn_is_plus_pi():
    np.testing.assert_array_equal(wrapped(np.array([math.pi, -math.pi])), [math.pi, math.pi])


def row(**cells):
    values = {"t": "0", "x": "1.5", "img": "1", "state": "0"} | {k: str(v) for k, v in cells.items()}
    return ",".join(values.get(name, "0.5") for name in HEADER)


HEADER_LINE = ",".join(HEADER)


def table(*rows, header=HEADER_LINE):
    return "\n".join((header, *rows)) + "\n"


@pytest.mark.parametrize(
    ("text", "where", "what"),
    [
        ("", ":1", "is empty"),
        (table(), ":1", "no rows"),
        (table(row(), header=HEADER_LINE.removesuffix(",img")), ":1", "'img' is missing"),
        (table(row(), header=HEADER_LINE + ",extra"), ":1", "'extra' is not known"),
        (table(row(), header=HEADER_LINE.replace("d_f", "D_F")), ":1", "nearest: d_f"),
        (table(row(), row(t=50)[:-5]), ":3", "18 columns instead of 19"),
        (table(row(), row(t=50) + ",1"), ":3", "20 columns instead of 19"),
        (table(row(), ""), ":3", "1 columns instead of 19"),
        (table(row(), row(t=50, L4="NaN")), ":3", "column L4: 'NaN'"),
        (table(row(), row(t=50, L4="")), ":3", "column L4: ''"),
        (table(row(), row(t=50, x="1_000")), ":3", "column x: '1_000'"),
        (table(row(), row(t=50, y="1e999")), ":3", "column y: '1e999'"),
        (table(row(), row(t=50, y="\u0663")), ":3", "column y"),
        (table(row(), row(t=50, v='"0.1"')), ":3", "column v"),
        (table(row(t=100), row(t=50)), ":3", "50 ms is not after 100 ms"),
        (table(row(), row(t=50, img=1)), ":3", "1 does not count up from 1"),
        (table(row(img=-1)), ":2", "-1 does not count up from 0"),
        (table(row(img="1.5")), ":2", "'1.5' is not an integer"),
    ],
)
def test_a_foreign_table_is_read_strictly(text, where, what, tmp_path):
    path = tmp_path / "data.csv"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read_rows(path)
    assert f"{path}{where}: " in str(caught.value)
    assert what in str(caught.value)


def test_windows_line_ends_a_byte_order_mark_and_a_missing_last_line_end_are_no_fault(tmp_path):
    path = tmp_path / "data.csv"
    path.write_bytes(b"\xef\xbb\xbf" + table(row(), row(t=50, img=0)).replace("\n", "\r\n").encode().rstrip())
    rows = read_rows(path)
    np.testing.assert_array_equal(rows.t_ms, [0, 50])
    np.testing.assert_array_equal(rows.image, [1, 0])
    assert rows.pose[0, 0] == 1.5


def test_rows_are_read_only(tmp_path):
    (tmp_path / "data.csv").write_text(table(row()))
    rows = read_rows(tmp_path / "data.csv")
    assert isinstance(rows, Rows)
    with pytest.raises(ValueError, match="read-only"):
        rows.pose[0, 0] = 0


def test_images_are_taken_at_the_first_row_of_each_period():
    """5 Hz on rows that come every 50 ms, and on rows that come late by some milliseconds."""
    np.testing.assert_array_equal(image_numbers(np.arange(0, 450, 50), 5), [1, 0, 0, 0, 2, 0, 0, 0, 3])
    np.testing.assert_array_equal(image_numbers(np.array([7, 58, 110, 161, 209, 260]), 5), [1, 0, 0, 0, 2, 0])
    np.testing.assert_array_equal(image_numbers(np.array([0, 1000, 2000]), 5), [1, 2, 3])


def test_a_manifest_is_what_was_written():
    hashes = {"b/c d.txt": "0" * 64, "a": "f" * 64}
    assert manifest(hashes).startswith(b"f" * 64 + b"  a\n")
    assert read_manifest(manifest(hashes)) == hashes
