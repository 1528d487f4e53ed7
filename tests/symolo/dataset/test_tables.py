"""data.csv as text: fixed digits, and strict reading."""

import math

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.rerendering.image_rows import image_numbers
from symolo.core.errors import InputError
from symolo.core.tables.table import MAX_FAULTS
from symolo.core.tables.time_series import Recording, TimeSeries, Trajectory
from symolo.dataset.codes import BOARD_COLUMNS, BOARD_EVENT_COLUMNS, State
from symolo.dataset.documents import metadata
from symolo.dataset.manifest import manifest, read_manifest
from symolo.dataset.tables.rows import (
    HEADER,
    STATES,
    Fault,
    Rows,
    csv_bytes,
    heading,
    parse_table,
    read_rows,
    semantic_faults,
    wrapped,
)
from symolo.dataset.tables.side_tables import BOARD, CAMERA, TOF, WHEELS

NUMBERS = st.floats(-1e6, 1e6)


def row(**cells):
    values = {"t": "0", "x": "1.5", "img": "1", "state": "0"} | {k: str(v) for k, v in cells.items()}
    return ",".join(values.get(name, "0.5") for name in HEADER)


HEADER_LINE = ",".join(HEADER)


def table(*rows, header=HEADER_LINE):
    return "\n".join((header, *rows)) + "\n"


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
    (turned,) = wrapped(np.array([yaw]))
    assert -math.pi < turned <= math.pi
    assert math.cos(turned - yaw) == pytest.approx(1, abs=1e-9)


def test_half_a_turn_is_plus_pi():
    np.testing.assert_array_equal(wrapped(np.array([math.pi, -math.pi])), [math.pi, math.pi])


def test_a_heading_just_above_minus_pi_is_written_as_plus_pi():
    """-3.1415926 would be written as -3.141593, which is below -pi."""
    angles = np.array([-math.pi + 1e-7, -math.pi + 4e-7, math.pi, 3.0, -math.pi - 2e-7])
    np.testing.assert_array_equal(heading(angles, 6), [3.141593, -3.141592, 3.141593, 3.0, 3.141592])


def recording(t_s, pose, state, twist, **readings):
    series = [TimeSeries(name, "", t_s, np.asarray(values)) for name, values in readings.items()]
    return Recording(Trajectory(t_s, np.array(pose), np.array(twist), np.array(state)), tuple(series))


def test_headings_in_the_rows_are_those_of_the_description():
    pose, twist = [[0, 0, -math.pi + 1e-7], [0, 0, -math.pi + 1e-6]], np.zeros((2, 2))
    readings = {"tof_m": np.ones((2, 3)), "line": np.ones((2, 8)), "image": [1, 0]}
    rows = Rows.from_recording(recording(np.array([0.0, 0.05]), pose, [0, 0], twist, **readings))
    np.testing.assert_array_equal(rows.pose[:, 2], [3.141593, -3.141592])


def test_each_reading_of_a_recording_stands_in_its_column_with_its_digits():
    pose = [[1.0000014, 2.0000006, 0.5], [-1e-9, 3.0, 0.2500011]]
    readings = {
        "tof_m": [[0.11111, 0.2, 0.3], [0.4, 0.5, 0.6]],
        "line": np.arange(16.0).reshape(2, 8) / 16 + 0.000021,
        "image": [1, 0],
    }
    twist = [[0.1, 0.2], [0.3, 0.4000006]]
    rows = Rows.from_recording(recording(np.array([0.0, 0.0504]), pose, [0, 33], twist, **readings))
    channels = [float(f"{i / 16:.4f}2") for i in range(16)]
    first = [0, 1.000001, 2.000001, 0.5, 0, 0.1, 0.2, 0.1111, 0.2, 0.3, *channels[:8], 1]
    second = [50, 0.0, 3.0, 0.250001, 33, 0.3, 0.400001, 0.4, 0.5, 0.6, *channels[8:], 0]
    np.testing.assert_array_equal(rows.table(), [first, second])
    assert rows.to_csv().decode().splitlines()[2] == (
        "50,0.000000,3.000000,0.250001,33,0.300000,0.400001,0.4000,0.5000,0.6000,"
        "0.50002,0.56252,0.62502,0.68752,0.75002,0.81252,0.87502,0.93752,0"
    )
    assert [rows.at(0).tolist(), rows.at(1).tolist()] == rows.table().tolist()
    assert rows.at(1).dtype == np.float64
    assert not np.signbit(rows.pose[1, 0])


def test_every_fault_of_meaning_is_found_with_its_line_and_kind_in_the_order_of_the_file():
    cells = [
        {},
        {"t": 50, "img": 0, "state": 7},
        {"t": 50, "img": 2},
        {"t": 40, "img": 1},
        {"t": 90, "img": 3, "L0": 1},
    ]
    numbers, faults = parse_table(table(*(row(**c) for c in cells)).encode(), HEADER)
    assert faults == []
    found = semantic_faults(Rows.from_table(numbers))
    assert [(fault.line, fault.kind) for fault in found] == [(3, "state"), (4, "time"), (5, "time"), (5, "image")]
    assert str(found[1]) == "line 4: column t: 50 ms is not after 50 ms"
    assert found[3].what == "column img: 1 does not count up from 2"


def test_a_state_that_is_not_known_is_no_reason_to_refuse_a_table(tmp_path):
    """So that a dataset of a later version can be read; `verify` reports it."""
    (tmp_path / "data.csv").write_text(table(row(state=7)))
    assert read_rows(tmp_path / "data.csv").state.tolist() == [7]


@pytest.mark.parametrize("sign", [-1, 1])
def test_numbers_up_to_those_that_a_float_holds_exactly_are_read(sign):
    numbers, faults = parse_table(table(row(t=sign * 2**53)).encode(), HEADER)
    assert (faults, numbers[0, 0]) == ([], sign * 2.0**53)
    _, (fault,) = parse_table(table(row(t=sign * (2**53 + 2))).encode(), HEADER)
    assert fault.line == 2


def test_a_table_that_cannot_be_opened_is_refused_with_the_reason(tmp_path):
    with pytest.raises(InputError, match=r"none\.csv: cannot be read: No such file or directory"):
        read_rows(tmp_path / "none.csv")


@pytest.mark.parametrize("text", ["", table(), table(row(), header="t,x")])
def test_a_table_with_faults_has_no_rows_but_all_its_columns(text):
    numbers, faults = parse_table(text.encode(), HEADER)
    assert numbers.shape == (0, 19)
    assert faults


def test_every_state_of_the_controller_is_known_to_the_tables_and_has_a_meaning():
    assert set(STATES) == set(metadata.STATES) == set(State)
    assert all(metadata.STATES.values())


@pytest.mark.parametrize(
    ("text", "where", "what"),
    [
        ("", ":1", "is empty"),
        (table(), ":1", "no rows"),
        (table("0,1,2", header="t,x,y"), ":1", "column theta is missing"),
        (table("0,1,2,3", header="x,t,y,theta"), ":1", "columns in another order"),
        (table(row(), header=HEADER_LINE + ",extra"), ":1", "column extra is not known"),
        (table(row(), header=HEADER_LINE.replace("d_f", "D_F")), ":1", "did you mean d_f"),
        (table(row(), header=HEADER_LINE.replace("x,y", "y,x")), ":1", "columns in another order"),
        (table(row(), row(t=50)[:-5]), ":3", "18 columns; allowed: 19"),
        (table(row(), row(t=50) + ",1"), ":3", "20 columns; allowed: 19"),
        (table(row(), ""), ":3", "1 column; allowed: 19"),
        (table(row(), row(t=50, L4="NaN")), ":3", "column L4: got 'NaN'"),
        (table(row(), row(t=50, y="")), ":3", "column y: got ''"),
        (table(row(), row(t=50, img="")), ":3", "column img: got ''"),
        (table(row(), row(t=50, x="1_000")), ":3", "column x: got '1_000'"),
        (table(row(), row(t=50, y="1e999")), ":3", "column y: got '1e999'"),
        (table(row(), row(t=50, y="\u0663")), ":3", "column y"),
        (table(row(), row(t=50, v='"0.1"')), ":3", "column v"),
        (table(row(t=100), row(t=50)), ":3", "50 ms is not after 100 ms"),
        (table(row(), row(t=50, img=1)), ":3", "1 does not count up from 1"),
        (table(row(img=-1)), ":2", "-1 does not count up from 0"),
        (table(row(img="1.5")), ":2", "column img: got '1.5', allowed: a whole number"),
        (table(row(img="1e300")), ":2", "column img: got '1e300', allowed: -9.0"),
        (table(row(), row(t="1e300")), ":3", "column t: got '1e300', allowed: -9.0"),
        (table(row(state="-1e19")), ":2", "column state: got '-1e19', allowed: -9.0"),
    ],
)
def test_a_foreign_table_is_read_strictly(text, where, what, tmp_path):
    path = tmp_path / "data.csv"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read_rows(path)
    assert f"{path}{where}: " in str(caught.value)
    assert what in str(caught.value)


def test_times_in_seconds_are_recognised_by_the_first_ones_that_fall_on_the_same_millisecond(tmp_path):
    """And only these: where times do not increase, or an image number does not, this is what is reported."""
    path = tmp_path / "data.csv"
    times = ("0", "1", "2.2", "2.4", "2.6")
    path.write_text(table(*(row(t=t, img=0) for t in times), row(t="2.7", img=-1)))
    with pytest.raises(InputError) as caught:
        read_rows(path)
    assert str(caught.value) == (
        f"{path}:5: column t: 2.4 ms is not a millisecond after 2.2 ms; "
        "give t in milliseconds; this looks like seconds: multiply it by 1000"
    )
    path.write_text(table(row(t=0, img=2), row(t=1, img=1), row(t="1.2", img=0), row(t="1.4", img=0)))
    with pytest.raises(InputError, match=r":3: column img: 1 does not count up from 2"):
        read_rows(path)
    path.write_text(table(row(t="0.2", img=0), row(t="0.1", img=0)))
    with pytest.raises(InputError, match=r":3: column t: 0 ms is not after 0 ms; repair or remove the row"):
        read_rows(path)


def test_time_and_pose_are_enough_and_what_was_not_measured_is_not_invented(tmp_path):
    path = tmp_path / "data.csv"
    text = table(
        "0,1.500000,0.500000,0.250000,,2", "50,1.600000,0.500000,0.250000,0.4000,3", header="t,x,y,theta,d_l,img"
    )
    path.write_text(text)
    rows = read_rows(path)
    assert rows.columns == ("t", "x", "y", "theta", "d_l", "img")
    np.testing.assert_array_equal(rows.pose, [[1.5, 0.5, 0.25], [1.6, 0.5, 0.25]])
    np.testing.assert_array_equal(rows.tof_m, [[np.nan] * 3, [np.nan, 0.4, np.nan]])
    assert np.isnan(rows.twist).all()
    assert np.isnan(rows.line).all()
    assert (rows.has_state, rows.state.tolist(), rows.image.tolist()) == (False, [-1, -1], [2, 3])
    assert semantic_faults(rows) == []
    assert rows.to_csv().decode() == text
    np.testing.assert_array_equal(rows.at(1), [50, 1.6, 0.5, 0.25, 0.4, 3])
    assert [column.name for column in rows.definitions] == list(rows.columns)


@pytest.mark.parametrize("columns", [("t", "x", "y", "theta", "v"), ("t", "x", "y", "theta", "d_l")])
def test_a_table_has_the_columns_of_its_rows_and_no_others(columns):
    numbers = np.array([[0.0, 1.5, 0.5, 0.25, 0.4], [50.0, 1.6, 0.5, 0.25, 0.3]])
    rows = Rows.from_table(numbers, columns)
    np.testing.assert_array_equal(rows.table(), numbers)
    np.testing.assert_array_equal(rows.at(1), numbers[1])
    assert (rows.state.tolist(), rows.image.tolist()) == ([-1, -1], [0, 0])


def test_pandas_reads_the_same_numbers_and_keeps_whole_numbers_whole(tmp_path):
    path = tmp_path / "data.csv"
    path.write_text(table(row(), row(t=50, img=2)))
    rows = read_rows(path)
    path.write_bytes(rows.to_csv())
    frame = pd.read_csv(path)
    assert [name for name in frame if frame[name].dtype == np.int64] == ["t", "state", "img"]
    np.testing.assert_array_equal(frame.to_numpy(), rows.table())


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
    np.testing.assert_array_equal(image_numbers(np.array([0, 33, 67, 100, 133, 167]), 30), [1, 2, 3, 4, 5, 6])
    np.testing.assert_array_equal(image_numbers(np.array([0, 199, 200, 399, 400]), 5), [1, 0, 2, 0, 3])


def test_a_manifest_is_what_was_written():
    hashes = {"b/c d.txt": "0" * 64, "a": "f" * 64}
    assert manifest(hashes).startswith(b"f" * 64 + b"  a\n")
    assert read_manifest(manifest(hashes)) == hashes


def test_a_table_with_a_fault_in_every_row_is_not_read_to_its_end():
    _, faults = parse_table(b"a,b\n" + 3 * MAX_FAULTS * b"x,1\n", ("a", "b"))
    assert len(faults) == MAX_FAULTS + 1
    assert str(faults[-2]).startswith(f"line {MAX_FAULTS + 1}: column a")
    assert str(faults[-1]) == f"line {MAX_FAULTS + 1}: {MAX_FAULTS} faults up to here; the rows below are not read"


def test_of_rows_out_of_order_a_thousand_are_listed():
    last = MAX_FAULTS + 10
    numbers, _ = parse_table(table(*(row(t=last - i, img=0) for i in range(last))).encode(), HEADER)
    assert [fault.line for fault in semantic_faults(Rows.from_table(numbers))] == list(range(3, MAX_FAULTS + 3))


def test_each_column_of_the_tables_beside_data_has_a_meaning_and_a_unit():
    for table in (WHEELS, TOF, CAMERA, BOARD):
        assert all(column.meaning and column.unit for column in table.columns), table.file
        assert len({column.meaning for column in table.columns}) == len(table.columns), table.file
    assert [*BOARD_COLUMNS][2:] == [*BOARD_EVENT_COLUMNS.values()]


def test_rows_and_their_faults_cannot_be_changed(changeable):
    for kind in (Rows, Fault):
        assert changeable(kind) == []
