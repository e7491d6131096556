"""Tables in terminals of all widths, and in pipes."""

import re

import pytest

from nrs_design.cli.tables import print_table
from tests.support import SOFT_TISSUE
from tests.terminal import run_on_terminal

STYLE = re.compile("\x1b\\[[0-9;?]*[A-Za-z]")
NUMBERS = ("2.15", "0.1552", "59.13 deg", "9.89 ms")


@pytest.mark.slow
@pytest.mark.parametrize("columns", [120, 40])
def test_no_number_is_broken(tmp_path, columns):
    shown, code = run_on_terminal(columns, "optimize", SOFT_TISSUE, cwd=tmp_path)
    plain = STYLE.sub("", shown)
    assert code == 0
    assert all(number in plain for number in NUMBERS)
    result = plain[plain.index("soft-tissue: the worst") :]
    assert max(map(len, result.splitlines())) <= columns


def test_rows_become_columns_as_far_as_they_fit(monkeypatch, capsys):
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", "24")
    rows = [[f"row{i}", f"{i}.123456", f"{i}.987654"] for i in range(3)]
    print_table("", ["name", "a\nm", "b"], rows)
    words = [line.split() for line in STYLE.sub("", capsys.readouterr().out).splitlines()]
    heads = [line for line in words if line[:1] == ["name"]]
    assert heads == [["name", "row0"], ["name", "row1"], ["name", "row2"]]
    assert ["a", "m", "1.123456"] in words


def test_a_long_cell_in_a_pipe_stays_whole(capsys):
    sentence = "word " * 100 + "end"
    print_table("", ["a", "b"], [["1", sentence]])
    assert sentence in capsys.readouterr().out
