"""A missing input is named with its row, and with the column and the cell that have no number."""

import pytest

from diagnosis.new_case.rows import measurement_of
from logs.log_file import read_log
from logs.mapping import LogMapping
from symolo.core.errors import InputError


@pytest.fixture
def fault(tmp_path):
    """Return the error of a step log in which some cells of duty cycle and battery are replaced."""

    def read(**cells):
        lines = ["t,duty,battery,speed,current"]
        for row in range(40):
            duty, battery = (cells.get(name, {}).get(row, number) for name, number in (("duty", 0.5), ("battery", 7.4)))
            lines.append(f"{0.01 * row:.2f},{duty},{battery},{0.1 * row:.1f},0.1")
        path = tmp_path / "log.csv"
        path.write_text("\n".join(lines) + "\n")
        columns = {"t_s": "t", "omega_rad_s": "speed", "current_A": "current"}
        mapping = {name: {"column": column} for name, column in columns.items()}
        mapping["u_cmd_V"] = {"column": "duty", "times": "battery"}
        with pytest.raises(InputError) as caught:
            measurement_of(read_log(path), LogMapping.model_validate({"kind": "motor_step", "columns": mapping}), "log")
        return str(caught.value)

    return read


def test_an_empty_cell_of_the_times_column_is_named(fault):
    """The first row is the second line of the file."""
    text = fault(battery={20: "", 25: ""})
    assert "row 22: column battery: got '', allowed: a number" in text
    assert "rows of this column with such a cell: 2" in text
    assert "column duty" not in text


def test_cells_of_both_columns_are_named(fault):
    text = fault(duty={5: "nan"}, battery={5: "", 9: ""})
    assert "row 7: column duty: got 'nan', allowed: a number" in text
    assert "row 7: column battery: got '', allowed: a number" in text
    assert "rows of this column with such a cell: 2" in text
