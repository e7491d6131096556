"""Records: what makes them unusable."""

import hashlib

import numpy as np
import pytest

from nrs_design.identification.datasets.records import read_actuator, read_tissue
from nrs_design.identification.errors import DataError
from nrs_design.identification.tables import table as tables
from nrs_design.identification.tables.columns import parse_mapping
from nrs_design.identification.tables.table import read_table
from tests.identification.support import write_csv
from tests.tables import rows

TIME = np.arange(200) / 100
DEFLECTION = 0.005 * (1 - np.cos(3 * TIME))


def write(tmp_path, header, *columns):
    return write_csv(tmp_path / "record.csv", header, *columns)


def tissue(tmp_path, time=TIME, deflection=DEFLECTION, force=None):
    force = 750 * deflection if force is None else force
    return read_tissue(write(tmp_path, "time_s,deflection_m,force_N", time, deflection, force))


def test_a_record(tmp_path):
    record = tissue(tmp_path, time=TIME + 7)
    assert (record.name, record.rotational) == ("record", False)
    assert record.motion.time[0] == 0
    assert record.motion.time[-1] == pytest.approx(1.99)


def test_angle_in_degrees(tmp_path):
    path = write(tmp_path, "time_s,angle_deg,torque_mNm", TIME, 10 * DEFLECTION, DEFLECTION)
    record = read_tissue(path)
    assert record.rotational
    assert record.motion.deflection.max() == pytest.approx(np.radians(10 * DEFLECTION.max()))
    assert record.force.max() == pytest.approx(1e-3 * DEFLECTION.max())


def test_of_a_record_with_pauses_the_longest_stretch_is_used(tmp_path):
    with pytest.raises(DataError, match=r"a gap of 0\.06 s, where steps are 0\.01 s, and"):
        tissue(tmp_path, time=TIME + 0.05 * (np.arange(200) // 40))
    found = tissue(tmp_path, time=TIME + 0.05 * (np.arange(200) >= 50) + (np.arange(200) >= 180))
    assert (len(found.force), found.motion.time[0]) == (130, 0)
    assert found.force == pytest.approx(750 * DEFLECTION[50:180])
    assert found.pauses.startswith("2 pauses in the record: its longest stretch is used (0.55 to ")
    assert "70 rows left out" in found.pauses
    held = np.minimum(DEFLECTION, 0.006)
    with pytest.raises(DataError, match="saturated") as caught:
        tissue(tmp_path, TIME + 0.05 * (np.arange(200) >= 50), DEFLECTION, 750 * held)
    assert caught.value.line == 62


@pytest.mark.parametrize(
    "columns",
    [
        {"time": TIME + np.random.default_rng(0).uniform(-0.004, 0.004, 200)},
        {"deflection": np.minimum(DEFLECTION, 0.006)},
        {"deflection": DEFLECTION - 0.004, "force": np.maximum(750 * (DEFLECTION - 0.004), 0.0)},
    ],
    ids=["jitter is no gap", "a rest is no saturation", "out of contact is none"],
)
def test_what_a_record_may_be(tmp_path, columns):
    assert len(tissue(tmp_path, **columns).force) == 200


@pytest.mark.parametrize(
    ("header", "scale", "unit", "is_angle"), rows(__file__, "test_commands_and_outputs")
)
def test_commands_and_outputs(tmp_path, header, scale, unit, is_angle):
    """A command that was cut off is still what was commanded."""
    command = np.clip(3000 * np.sin(20 * TIME), -2800, 2800)
    record = read_actuator(write(tmp_path, header, TIME, command, TIME))
    assert record.command.max() == pytest.approx(2800 * scale)
    assert (record.unit, record.is_angle) == (unit, is_angle)


def test_an_angle_that_begins_anew_after_each_turn(tmp_path):
    command, angle = 100 + 50 * np.sin(6 * TIME), 400 * TIME
    path = write(tmp_path, "time_s,command_rpm,angle_deg", TIME, command, angle % 360)
    with pytest.raises(DataError, match="jumps by a whole turn") as caught:
        read_actuator(path)
    assert caught.value.line == 92
    read_actuator(write(tmp_path, "time_s,command_rpm,angle_deg", TIME, command, angle))


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
    with pytest.raises(DataError, match="x_raw is 'a', not a number"):
        read_table(frame | {"x_raw": ["a", "b", "c"]}, LAYOUTS, mapping)


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(DataError, match="cannot be read"):
        read_table(tmp_path / "missing.csv", LAYOUTS, {})
    with pytest.raises(DataError, match="is a folder"):
        read_table(tmp_path, LAYOUTS, {})


@pytest.mark.parametrize(("entries", "message"), rows(__file__, "test_wrong_mappings"))
def test_wrong_mappings(entries, message):
    with pytest.raises(DataError, match=message):
        parse_mapping(entries)


def test_mapping_of_a_column_that_is_not_there(tmp_path):
    with pytest.raises(DataError, match="no column 'forceN'") as caught:
        read(tmp_path, GOOD, ["torque_Nm=forceN"])
    assert "did you mean 'force_N'" in caught.value.remedy


def test_too_many_rows_or_words(tmp_path, monkeypatch):
    monkeypatch.setattr(tables, "MAX_ROWS", 3)
    with pytest.raises(DataError, match="more than 3 rows"):
        read(tmp_path, GOOD)
    monkeypatch.setattr(tables, "MAX_LABELS", 1)
    with pytest.raises(DataError, match="mode has more than 1 words"):
        read_table({"time_s": [0, 1], "mode": ["a", "b"]}, (("time",),), {}, ("mode",))
