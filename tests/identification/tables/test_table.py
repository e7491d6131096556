"""Reading CSV: what is refused, and with which row."""

import hashlib

import numpy as np
import pytest

from nrs_design.errors import DataError
from nrs_design.identification.tables import table as tables
from nrs_design.identification.tables.columns import parse_mapping
from nrs_design.identification.tables.table import read_table

LAYOUTS = (("time", "deflection", "force"), ("time", "angle", "torque"))
HEADER = "time_s,deflection_m,force_N\n"
GOOD = HEADER + "".join(f"{0.1 * i:.1f},{0.001 * i:.3f},{i}\n" for i in range(5))


def read(tmp_path, text, entries=()):
    path = tmp_path / "data.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_table(path, LAYOUTS, parse_mapping(entries))


def test_values_units_and_hash(tmp_path):
    text = "# synthetic\ntime_ms,force_mN,note,deflection_mm\n10,1500,7,2\n20,1e3,7,3\r\n30,0,7,-4"
    found = read(tmp_path, text)
    group = found.values
    assert group["time"] == pytest.approx([0.01, 0.02, 0.03])
    assert group["force"] == pytest.approx([1.5, 1.0, 0.0])
    assert group["deflection"] == pytest.approx([2e-3, 3e-3, -4e-3])
    assert found.source.synthetic
    assert found.source.sha256 == hashlib.sha256(text.encode()).hexdigest()


def test_arrays_are_read_as_a_file_is():
    time = np.arange(3.0)
    frame = {"time_ms": time, "Force [kN]": time, "x_raw": 2 * time, "mode": ["a", "b", "a"]}
    mapping = parse_mapping(["deflection_mm=x_raw"])
    found = read_table(frame, LAYOUTS, mapping, optional=("mode",))
    assert found.values["deflection"] == pytest.approx(2e-3 * time)
    assert found.values["force"] == pytest.approx(1e3 * time)
    assert [found.labels[int(i)] for i in found.values["mode"]] == ["a", "b", "a"]
    with pytest.raises(DataError, match="no column of one length"):
        read_table(frame | {"x_raw": time[1:]}, LAYOUTS, mapping)
    with pytest.raises(DataError, match="is nan"):
        read_table(frame | {"x_raw": np.nan * time}, LAYOUTS, mapping)


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(DataError, match="cannot be read"):
        read_table(tmp_path / "missing.csv", LAYOUTS, {})
    with pytest.raises(DataError, match="is a folder"):
        read_table(tmp_path, LAYOUTS, {})


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        (["force_N"], "is not a pair"),
        (["force_N="], "is not a pair"),
        (["weight_kg=w"], "no column of ours"),
        (["force_dyn=Fz"], "has the unit 'dyn'"),
        (["force_N=a", "force_N=b"], "mapped twice"),
    ],
)
def test_wrong_mappings(entries, message):
    with pytest.raises(DataError, match=message):
        parse_mapping(entries)


def test_mapping_of_a_column_that_is_not_there(tmp_path):
    with pytest.raises(DataError, match="no column 'forceN'") as caught:
        read(tmp_path, GOOD, ["torque_Nm=forceN"])
    assert "did you mean 'force_N'" in caught.value.remedy


def test_too_many_rows(tmp_path, monkeypatch):
    monkeypatch.setattr(tables, "MAX_ROWS", 3)
    with pytest.raises(DataError, match="more than 3 rows"):
        read(tmp_path, GOOD)
