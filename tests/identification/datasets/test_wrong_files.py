"""Wrong files: each has one message that says what, where and what to do."""

import numpy as np
import pytest

from nrs_design.identification.datasets.records import read_actuator, read_signals, read_tissue
from nrs_design.identification.errors import DataError
from tests.support import run

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
# Name of the file, its content, what is said (a pattern), and the line.
WRONG = {
    "empty": ("a.csv", b"", "has no header line", None),
    "no header": ("a.csv", text(head=""), "begins with numbers", 1),
    "UTF-16": ("a.csv", text().decode().encode("utf-16"), "is no text", 1),
    "binary": ("a.csv", b"\x00\x01\x02" * 50, "is no text", 1),
    "Excel named CSV": ("a.csv", b"PK\x03\x04" + bytes(100), "is no text", 1),
    "a bag": ("a.bag", b"#ROSBAG V2.0\n" + bytes(100), "is no text", 2),
    "MATLAB": ("a.mat", b"MATLAB 5.0 MAT-file" + bytes(100), "is no text", 1),
    "force missing": ("a.csv", text(HEAD.replace("force_N", "temp_C")), "force_N are missing", 1),
    "no unit": ("a.csv", text(HEAD.replace("force_N", "Force")), "has no unit", 1),
    "mega for milli": ("a.csv", text(HEAD.replace("force_N", "force_MN")), "unit 'MN'", 1),
    "quantity twice": ("a.csv", text("time_s,force_N,Force [N]\n"), "there twice", 1),
    "empty cell": ("a.csv", text(replace=[(5, "0.05,,5")]), "deflection_m is missing", 7),
    "short row": ("a.csv", text(replace=[(5, "0.05,5")]), "row has 2 values", 7),
    "empty row": ("a.csv", text(replace=[(5, "")]), "row is empty", 7),
    "an underscore": ("a.csv", text(replace=[(5, "0.05,1_0,2")]), "not a number", 7),
    "digits of another script": ("a.csv", text(replace=[(5, "0.05,٣,2")]), "not a number", 7),
    "a word": ("a.csv", text(replace=[(5, "0.05,0.1,off")]), "'off', not a number", 7),
    "not finite": ("a.csv", text(replace=[(5, "0.05,0.1,nan")]), "force_N is nan", 7),
    "decimal commas": ("a.csv", text(HEAD.replace(",", ";"),
        body=[line.replace(",", ";").replace(".", ",") for line in BODY]), "not a number", 2),
    "marks between thousands": ("a.csv", text(replace=[(5, '0.05,"1,000",2')]), "not a number", 7),
    "decimal commas between commas": ("a.csv",
        text(body=[f"0,{i:02d},0,00{i % 9},{i}" for i in range(60)]), "row has 5 values", 2),
    "a quote that does not end": ("a.csv", text(replace=[(7, '"0.07,0.007,7')]), "has 1 values", 9),
    "time repeats": ("a.csv", text(replace=[(5, BODY[4])]), "time repeats", 7),
    "time goes back": ("a.csv", text(replace=[(5, "0.01,0.005,5")]), "time goes back", 7),
    "a gap": ("a.csv", text(body=[*BODY[:45], "9.5,0.01,3", "9.51,0.02,2", "9.52,0.03,1"] + [
        f"9.{i},0.01,{i % 7}" for i in range(53, 60)]), "a gap of .* and no 50 rows", 47),
    "a huge value": ("a.csv", text(replace=[(5, "0.05,1e297,5")]),
        r"deflection_m is 1e\+297: no sensor", 7),
    "huge in another unit": ("a.csv", text(HEAD.replace("time_s", "time_min"), [(59,
        "1e308,0.1,5")]), "time_min is inf", 61),
    "tiny changes": ("a.csv", column(1, 1e-200 * TIME), "never changes by more than 6e-201", 2),
    "changes by rounding": ("a.csv", column(2, 0.3 + 1e-17 * FLAT),
        "force never changes by more than", 2),
    "no time passes": ("a.csv", column(0, 1e-200 * TIME), "time hardly advances", 61),
    "too short": ("a.csv", text(body=BODY[:10]), "has 10 rows", 11),
    "nothing moves": ("a.csv", column(1, [0.1] * 60), "deflection never changes", 2),
    "sensor saturated": ("a.csv", column(2, FLAT), "saturated", 32),
    "endless line": ("a.csv", text() + b"1" * (4 << 20), "is no CSV", 62),
    "line end of old Macs": ("a.csv", text().replace(b"\n", b"\r"), "is no CSV", 1),
}  # fmt: skip


def write(tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content)
    return path


def rows(head, *columns):
    """A file of 60 rows; a column is a number, or a function of the row."""
    lines = (",".join(f"{c(i) if callable(c) else c}" for c in columns) for i in range(60))
    return (head + "\n" + "\n".join(lines) + "\n").encode()


def clock(i):
    return f"{0.01 * i:.2f}"


def swing(i):
    return i % 7


def signals(path):
    return read_signals(path, {"u": "input_any", "y": "output_any"})


# Reader, content, what is said, and the line.
OTHERS = {
    "no output": (read_actuator, rows("time_s,command_V", clock, swing), "angle_rad", 1),
    "no command": (read_actuator, rows("time_s,angle_rad", clock, swing), "command", 1),
    "a command in ohm": (read_actuator, rows("time_s,command_ohm,angle_rad", clock, swing, swing),
        "'ohm'", 1),
    "a position for a motor": (read_actuator, rows("time_s,command_deg,angle_rad", clock, swing,
        swing), "a command in rad, and no velocity", 2),
    "a velocity without unit": (read_actuator, rows("time_s,command_V,velocity", clock, swing,
        swing), "velocity.*has no unit", 1),
    "a command that never changes": (read_actuator, rows("time_s,command_rpm,angle_rad", clock,
        3000, swing), "command never changes", 2),
    "a motor at rest": (read_actuator, rows("time_s,command_rpm,angle_rad", clock, swing, 0.5),
        "angle never changes", 2),
    "two angles": (read_actuator, rows("time_s,command_V,angle_rad,angle_deg", clock, swing, swing,
        swing), "there twice", 1),
    "nothing measured": (signals, rows("time_s,u", clock, swing), "no column 'y'", 1),
    "a signal that never changes": (signals, rows("time_s,u,y", clock, swing, 1), "never changes",
        2),
}  # fmt: skip


CASES = {case: (read_tissue, *rest) for case, rest in WRONG.items()} | {
    case: (read, "a.csv", *rest) for case, (read, *rest) in OTHERS.items()
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
