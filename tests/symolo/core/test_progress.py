import pytest

from symolo.core.progress import LineReport


@pytest.mark.parametrize(("total", "line"), [(1, "export: 1 of 1 file in "), (2, "export: 2 of 2 files in ")])
def test_a_line_counts_one_thing_and_several(capsys, total, line):
    with LineReport().stage("export", total, "files") as stage:
        stage.update("a", total)
    assert capsys.readouterr().err.startswith(line)
