"""Tables of any origin: comments above the header, a row of units below it, and the rows that messages name."""

import pytest

from logs.log_file import read_log
from logs.trajectories.readers import READERS
from logs.units.names import taken_apart
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


@pytest.mark.parametrize("above", ["# my robot\n\n", "My robot, run 3\n", "My robot\n\nRun 3\n"])
def test_a_table_below_a_comment_or_a_title_is_recognised_as_a_table(above, tmp_path):
    path = tmp_path / "run.log"
    path.write_text(f"{above}t_s;x_m;y_m;theta_rad\n0;1;1;0\n")
    assert next(reader.name for reader in READERS if reader.recognises(path)) == "table"


def test_a_title_in_place_of_the_header_is_named_and_not_every_row_below_it(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("My robot run 3\n0,1,2\n1,2,3\n")
    with pytest.raises(InputError, match=r"row 2: 3 cells under a header of 1; row 1 is no header .*begin it with #"):
        read_log(path)


@pytest.mark.parametrize("title", ["Run 3, on carpet\n", "Fs,50.00\nLogging time,3600\n", "Run 3\n\n"])
@pytest.mark.parametrize(("header", "rows"), [("t_s,x_m,y_m", "0,1,2\n1,2,3\n"), ("d_mm", "79.0\n80.0\n")])
def test_titles_above_the_header_are_left_out_and_noted(title, header, rows, read):
    if header == "d_mm" and "," not in title:
        title = "Run 3, on carpet\n"
    log = read(f"{title}{header}\n{rows}")
    assert list(log.columns) == header.split(",")
    assert log.rows == 2
    count = title.count("\n")
    assert log.notes == (f"run.csv: left out above the header: {count} row{'s' if count > 1 else ''}",)
    assert log.where(0).endswith(f"run.csv: row {count + 2}")


def test_a_title_above_a_row_of_units_is_left_out(read):
    log = read("Run 3, on carpet\nt,x,n\ns,cm,-\n0,1,2\n1,2,3\n")
    assert list(log.columns) == ["t [s]", "x [cm]", "n"]


@pytest.mark.parametrize("text", ["t,x,y\n0,1\n1,2\n", "t,x\n0,1,2\n1,2,3\n", "run,3\n0,1,2\n1,2,3\n"])
def test_a_header_that_does_not_fit_its_rows_is_no_title(text, read):
    with pytest.raises(InputError, match=r"row 2: [23] cells under a header of [23]"):
        read(text)


def test_a_third_header_row_with_symbols_is_left_out_and_noted(read):
    """As in the logs of the Robotino: names, units and symbols, and a separator at the end of each row."""
    log = read("Time;1st motor speed;X axis;\nms;rad/s;pix;\nt;m1vel;x;\n0,5;1;2;\n1,5;2;3;\n")
    assert list(log.columns) == ["Time [ms]", "1st motor speed [rad/s]", "X axis [pix]"]
    assert taken_apart("X axis [pix]").unknown == "pix"
    assert log.numbers("Time [ms]").tolist() == [0.5, 1.5]
    assert log.notes == ("run.csv: row 2 has the units of the columns", "run.csv: row 3 has words only and is left out")
    assert log.where(0).endswith("run.csv: row 4")


def test_a_file_without_a_header_takes_names(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("# OptiTrack\n0,1,2\n0.05,2,3\n")
    log = read_log(path, ["t_s", "x_m", "y_m"])
    assert log.columns == {"t_s": ("0", "0.05"), "x_m": ("1", "2"), "y_m": ("2", "3")}
    assert log.where(0).endswith("run.csv: row 2")
    with pytest.raises(InputError, match=r"run.csv: row 2: 2 names for 3 columns; allowed: 3"):
        read_log(path, ["t_s", "x_m"])
    path.write_text("t,x,y\n0,1,2\n")
    with pytest.raises(InputError, match=r"run.csv: row 1: the row is a header: got .*leave the names out"):
        read_log(path, ["t_s", "x_m", "y_m"])


@pytest.mark.parametrize("rows", ["0,1,2\n1,2,\n2,3,4\n", "0,1,2\n1,2,3\n2,3", "0,1,2,\n1,2,3,\n", "0,,\n1,2,3\n"])
def test_a_title_is_left_out_above_rows_with_an_empty_or_missing_end(rows, read):
    log = read(f"Run 3\nt_s,x_m,y_m\n{rows}")
    assert list(log.columns) == ["t_s", "x_m", "y_m"]
    assert log.numbers("t_s")[:2].tolist() == [0.0, 1.0]


def test_a_row_of_units_with_an_empty_end_does_not_make_the_header_a_title(read):
    log = read("t,x,mode\ns,cm,\n0,1,2\n1,2,3\n")
    assert list(log.columns) == ["t [s]", "x [cm]", "mode"]


@pytest.mark.parametrize(
    "text", ["0,1,\n0.05,2,3\n", "0,1,2,\n0.05,2,3,\n", "0,0;1;2\n0,05;2;3\n", "0,0;1,5;2,5\n0,05;2,5;3\n"]
)
def test_names_fit_a_first_row_with_an_empty_end_or_decimal_commas(text, tmp_path):
    path = tmp_path / "run.csv"
    path.write_text(text)
    log = read_log(path, ["t_s", "x_m", "y_m"])
    assert log.numbers("t_s").tolist() == [0.0, 0.05]
    assert log.numbers("y_m")[1] == 3.0


def test_an_empty_name_of_a_column_is_refused(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("0,1,2\n0.05,2,3\n")
    with pytest.raises(InputError, match=r"row 1: name 2 is empty; name every column, also one that is not used"):
        read_log(path, ["t_s", "", "y_m"])


NAMED = "t_s{0}x [°]{0}name\n0{0}1.5{0}a\n1{0}2.5{0}b\n"


@pytest.mark.parametrize(
    ("encoding", "noted"),
    [
        ("utf-16", "run.csv is read as UTF-16 text"),
        ("cp1252", "run.csv is read as Windows-1252 text"),
        ("utf-8-sig", "run.csv begins with a byte-order mark"),
    ],
)
def test_tables_of_spreadsheets_are_read_in_their_encodings(encoding, noted, tmp_path):
    path = tmp_path / "run.csv"
    path.write_bytes(NAMED.format("\t").encode(encoding))
    log = read_log(path)
    assert log.columns == {"t_s": ("0", "1"), "x [°]": ("1.5", "2.5"), "name": ("a", "b")}
    assert log.notes == (noted,)
    assert next(reader.name for reader in READERS if reader.recognises(path)) == "table"


@pytest.mark.parametrize("content", [b"\xff\xfa\x00\n", b"t_s,x\n0,\xff\x01\n", b"\xff\xfe\x00", b"t,x\n\x81,1\n"])
def test_bytes_that_are_no_text_are_refused(content, tmp_path):
    path = tmp_path / "run.csv"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"run\.csv.*(is no UTF-8 text|is UTF-16 text); save it as UTF-8"):
        read_log(path)


@pytest.mark.parametrize("above", ["", "# made with numpy\n", "My robot: run 3 of 5\n", "My robot, run 3\n"])
@pytest.mark.parametrize("mark", ["", "# "])
def test_cells_may_be_separated_by_spaces(above, mark, tmp_path):
    """numpy.savetxt writes such files, with the header in a comment."""
    path = tmp_path / "run.txt"
    path.write_text(f"{above}{mark}t_s x_m  y_m\n0.0e+00 1 2\n  1 2   3\n")
    assert read_log(path).columns == {"t_s": ("0.0e+00", "1"), "x_m": ("1", "2"), "y_m": ("2", "3")}
    assert next(reader.name for reader in READERS if reader.recognises(path)) == "table"


@pytest.mark.parametrize(
    ("header", "name"),
    [
        ("# t_s enc_l enc_r u_l u_r x_m y_m theta_rad", "table"),
        ("# t x y v w a b theta", "table"),
        ("# t x y z roll pitch yaw v", "table"),
        ("# t x y z qw qx qy qz", "table"),
        ("# timestamp tx ty tz qx qy qz qw", "tum"),
        ("# timestamp x y z q_x q_y q_z q_w", "tum"),
        ("# t x y z i j k w", "tum"),
        ("# time px py pz rx ry rz rw", "tum"),
        ("# t x y z q1 q2 q3 q4", "tum"),
        ("# ground truth of the third run by Vicon", "tum"),
        ("# my robot", "tum"),
    ],
)
def test_names_above_eight_numbers_show_whether_they_are_poses_in_space(header, name, tmp_path):
    path = tmp_path / "run.txt"
    path.write_text(f"{header}\n0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n")
    assert next(reader.name for reader in READERS if reader.recognises(path)) == name


def test_a_text_of_words_is_no_table(tmp_path):
    path = tmp_path / "notes.txt"
    path.write_text("This is my robot\nIt drives well\n12 34\n")
    assert not [reader.name for reader in READERS if reader.recognises(path)]


def test_a_separator_in_quotes_separates_nothing(read):
    log = read('"t_s","n","name"\n"0.5","1,440","Anna, Lab 3"\n"1","12,345,678","say ""hi"""\n')
    assert log.columns == {"t_s": ("0.5", "1"), "n": ("1440", "12345678"), "name": ("Anna, Lab 3", 'say "hi')}
    assert log.numbers("n").tolist() == [1440.0, 12345678.0]


def test_commas_in_quotes_are_decimal_ones_if_no_number_has_a_point(read):
    log = read('"t_s","x_m"\n"0,050","1,500"\n"0,100","-2"\n')
    assert log.numbers("t_s").tolist() == [0.05, 0.1]
    assert log.numbers("x_m").tolist() == [1.5, -2.0]


def test_commas_in_quotes_that_may_mean_both_are_refused(read):
    with pytest.raises(InputError, match="comma, which may be a decimal one or stand between thousands: got '1,440'"):
        read('t_s,n\n1,"1,440"\n2,"1,500"\n')


def test_decimals_may_have_commas_between_tabs(read):
    """As in the Unicode text of a spreadsheet."""
    assert read("t_s\tx_m\n0,05\t1,5\n0,1\t2\n").numbers("x_m").tolist() == [1.5, 2.0]


@pytest.mark.parametrize(("backwards", "signs"), [([-1.0], [1.0, -1.0, 1.0, 1.0]), (["r"], [1.0, 1.0, -1.0, 1.0])])
def test_a_sense_is_negative_where_its_column_has_a_value_whatever_its_decimals_and_capitals(read, backwards, signs):
    assert read("t_s;sense\n0,0;1,0\n0,1;-1,0\n0,2;R\n0,3;\n").signs("sense", backwards).tolist() == signs


def test_a_cell_of_any_length_is_read(read):
    """The csv module of Python stops at 131,072 characters."""
    assert len(read(f't_s,name\n0,"{"a" * 200_000}"\n1,b\n').columns["name"][0]) == 200_000


def test_a_name_of_a_column_that_fills_a_screen_is_refused_and_not_repeated(read):
    with pytest.raises(InputError, match="the name of column 2 has 501 characters; allowed: at most 500") as raised:
        read(f"t_s,{501 * 'x'}\n0,1\n")
    assert len(str(raised.value)) < 400
    assert list(read(f"t_s,{500 * 'x'}\n0,1\n").columns) == ["t_s", 500 * "x"]
