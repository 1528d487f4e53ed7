"""Tables of any origin: comments above the header, a row of units below it, and the rows that messages name."""

import pytest

from logs.log_file import read_log
from logs.trajectories.readers import READERS
from logs.units import taken_apart
from symolo.core.errors import InputError


@pytest.fixture
def read(tmp_path):
    def written(text, name="run.csv"):
        (tmp_path / name).write_text(text)
        return read_log(tmp_path / name)

    return written


@pytest.mark.parametrize(
    ("above", "count"), [("", 0), ("# my robot, camera overhead\n", 1), ("\n# first, try\n# 12;3\n#\n", 4)]
)
def test_comments_above_the_header_are_left_out_and_noted(above, count, read):
    log = read(f"{above}t_s\tx_m\n0\t1\n1\tzwei\n")
    assert log.columns == {"t_s": ("0", "1"), "x_m": ("1", "zwei")}
    noted = {0: (), 1: ("run.csv: left out above the header: 1 row",)}
    assert log.notes == noted.get(count, ("run.csv: left out above the header: 4 rows",))
    with pytest.raises(InputError, match=rf"run\.csv: row {count + 3}: column x_m: got 'zwei'"):
        log.numbers("x_m")


def test_a_header_in_a_comment_stays_the_header(read):
    log = read("# made by a logger\n# t_s, x_m\n0,1\n1,2\n")
    assert log.columns == {"t_s": ("0", "1"), "x_m": ("1", "2")}


@pytest.mark.parametrize("first", [",", "nan,nan", "0,"])
def test_a_header_in_a_comment_may_have_missing_values_below_it(first, read):
    assert list(read(f"#t_s,x_m\n{first}\n1,2\n").columns) == ["t_s", "x_m"]


def test_a_header_in_a_comment_may_have_its_units_in_another_one(read):
    log = read("# first try\n# t,x,n\n# s,cm,-\n0,1,2\n1,2,3\n")
    assert log.columns == {"t [s]": ("0", "1"), "x [cm]": ("1", "2"), "n": ("2", "3")}
    assert log.where(0).endswith("run.csv: row 4")


def test_words_that_may_be_units_are_none_above_other_words(read):
    """A and B are surfaces, not amperes."""
    assert read("t,dist,surface\n1,1,A\n2,2,B\n").columns["surface"] == ("A", "B")


def test_a_row_of_units_becomes_a_part_of_the_names(read):
    log = read("t,x,heading_deg,ticks_L,note\nms,[cm],deg,1,\n0,1,2,3,\n1,2,3,4,\n")
    assert list(log.columns) == ["t [ms]", "x [cm]", "heading_deg", "ticks_L", "note"]
    assert log.numbers("x [cm]").tolist() == [1.0, 2.0]
    assert log.notes == ("run.csv: row 2 has the units of the columns",)
    assert log.where(0).endswith("run.csv: row 3")


def test_a_row_of_words_that_are_no_units_is_a_row(read):
    assert read("name,material\na,wood\nb,cm\n").columns["name"] == ("a", "b")


def test_counts_without_a_unit_are_recognised():
    assert taken_apart("ticks_L [1]") == taken_apart("ticks_L [-]") == taken_apart("ticks_L")
    assert taken_apart("tof [1]").words == ("tof", "1")


def test_a_table_below_a_comment_is_recognised_as_a_table(tmp_path):
    path = tmp_path / "run.log"
    path.write_text("# my robot\n\nt_s;x_m;y_m;theta_rad\n0;1;1;0\n")
    assert next(reader.name for reader in READERS if reader.recognises(path)) == "table"


def test_a_title_above_the_header_is_named_and_not_every_row_below_it(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("My robot run 3\nt,x,y\n0,1,2\n1,2,3\n")
    with pytest.raises(InputError, match=r"row 2: 3 cells under a header of 1; row 1 is no header .*begin it with #"):
        read_log(path)
