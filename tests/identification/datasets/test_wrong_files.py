"""Wrong files: each has one message that says what, where and what to do."""

from pathlib import Path

import numpy as np
import pytest

from nrs_design.identification.datasets.records import read_actuator, read_signals, read_tissue
from nrs_design.identification.errors import DataError
from tests.support import run
from tests.tables import table

HEAD = "time_s,deflection_m,force_N\n"
BODY = [f"{0.01 * i:.2f},{0.001 * (i % 20):.3f},{i % 20}" for i in range(60)]


def text(head=HEAD, replace=(), body=BODY):
    lines = list(body)
    for at, line in replace:
        lines[at] = line
    return (head + "\n".join(lines) + "\n").encode()


def column(index, values):
    rows = [line.split(",") for line in BODY]
    for row, value in zip(rows, values, strict=True):
        row[index] = str(value)
    return text(body=[",".join(row) for row in rows])


TIME = np.arange(60) / 100
FLAT = np.minimum(np.arange(60), 30)
TABLE = table(Path(__file__).with_suffix(".yaml"))
# Name of the file, its content, what is said (a pattern), and the line.
WRONG = {
    **{
        case: (
            "a.csv",
            text(said.get("head", HEAD), said.get("rows", {}).items()),
            said["says"],
            said["line"],
        )
        for case, said in TABLE["wrong"].items()
    },
    "empty": ("a.csv", b"", "has no header line", None),
    "UTF-16": ("a.csv", text().decode().encode("utf-16"), "is no text", 1),
    "binary": ("a.csv", b"\x00\x01\x02" * 50, "is no text", 1),
    "Excel named CSV": ("a.csv", b"PK\x03\x04" + bytes(100), "is no text", 1),
    "a bag": ("a.bag", b"#ROSBAG V2.0\n" + bytes(100), "is no text", 2),
    "MATLAB": ("a.mat", b"MATLAB 5.0 MAT-file" + bytes(100), "is no text", 1),
    "decimal commas": (
        "a.csv",
        text(
            HEAD.replace(",", ";"), body=[line.replace(",", ";").replace(".", ",") for line in BODY]
        ),
        "not a number",
        2,
    ),
    "decimal commas between commas": (
        "a.csv",
        text(body=[f"0,{i:02d},0,00{i % 9},{i}" for i in range(60)]),
        "row has 5 values",
        2,
    ),
    "time repeats": ("a.csv", text(replace=[(5, BODY[4])]), "time repeats", 7),
    "a gap": (
        "a.csv",
        text(
            body=[*BODY[:45], "9.5,0.01,3", "9.51,0.02,2", "9.52,0.03,1"]
            + [f"9.{i},0.01,{i % 7}" for i in range(53, 60)]
        ),
        "a gap of .* and no 50 rows",
        47,
    ),
    "tiny changes": ("a.csv", column(1, 1e-200 * TIME), "never changes by more than 6e-201", 2),
    "changes by rounding": (
        "a.csv",
        column(2, 0.3 + 1e-17 * FLAT),
        "force never changes by more than",
        2,
    ),
    "no time passes": ("a.csv", column(0, 1e-200 * TIME), "time hardly advances", 61),
    "too short": ("a.csv", text(body=BODY[:10]), "has 10 rows", 11),
    "nothing moves": ("a.csv", column(1, [0.1] * 60), "deflection never changes", 2),
    "sensor saturated": ("a.csv", column(2, FLAT), "saturated", 32),
    "endless line": ("a.csv", text() + b"1" * (4 << 20), "is no CSV", 62),
    "line end of old Macs": ("a.csv", text().replace(b"\n", b"\r"), "is no CSV", 1),
}


def write(tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content)
    return path


def filled(head, columns):
    """Return a file of 60 rows; a column is a number, or named as one of `FILLED`."""
    lines = (
        ",".join(str(FILLED[c](i)) if c in FILLED else c for c in columns.split())
        for i in range(60)
    )
    return (head + "\n" + "\n".join(lines) + "\n").encode()


FILLED = {"clock": lambda i: f"{0.01 * i:.2f}", "swing": lambda i: i % 7}


def signals(path):
    return read_signals(path, {"u": "input_any", "y": "output_any"})


READERS = {"read_actuator": read_actuator, "signals": signals}
CASES = {case: (read_tissue, *rest) for case, rest in WRONG.items()} | {
    case: (
        READERS[said["reader"]],
        "a.csv",
        filled(said["head"], said["columns"]),
        said["says"],
        said["line"],
    )
    for case, said in TABLE["others"].items()
}


@pytest.mark.parametrize("case", CASES)
def test_one_message(tmp_path, case):
    read, name, content, message, line = CASES[case]
    path = write(tmp_path, name, content)
    with pytest.raises(DataError, match=message) as caught:
        read(path)
    error = caught.value
    assert error.path == path
    assert error.remedy
    assert line is None or error.line == line
    assert "\n" not in str(error)
    assert len(str(error)) < 500


@pytest.mark.parametrize("case", ["empty", "UTF-16", "a bag", "sensor saturated", "MATLAB"])
def test_nothing_is_half_written(tmp_path, case):
    name, content, _, _ = WRONG[case]
    path = write(tmp_path, name, content)
    done = run("identify", "tissue", path, "--report", "page.html", "--json", cwd=tmp_path, code=2)
    assert done.stderr.count("error[NRS006]") == 1
    assert "warning" not in done.stderr.lower()
    assert [file.name for file in tmp_path.iterdir()] == [name]
