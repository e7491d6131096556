"""Records: what makes them unusable."""

import resource
import subprocess
import sys

import numpy as np
import pytest

from nrs_design.errors import DataError
from nrs_design.identification.datasets.records import (
    FrequencyResponse,
    read_actuator,
    read_signals,
    read_tissue,
)

TIME = np.arange(200) / 100
DEFLECTION = 0.005 * (1 - np.cos(3 * TIME))


def write(tmp_path, header, *columns):
    path = tmp_path / "record.csv"
    rows = (",".join(f"{v:.9g}" for v in row) for row in zip(*columns, strict=True))
    path.write_text(header + "\n" + "\n".join(rows) + "\n")
    return path


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


def test_gap(tmp_path):
    """Stretches of 50 rows are fitted together; shorter ones alone are no record."""
    with pytest.raises(DataError, match=r"a gap of 0\.06 s, where steps are 0\.01 s, and"):
        tissue(tmp_path, time=TIME + 0.05 * (np.arange(200) // 40))
    assert len(tissue(tmp_path, time=TIME + 0.05 * (np.arange(200) // 50)).force) == 200


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
    ("header", "scale", "unit", "is_angle"),
    [
        ("time_s,command_rpm,angle_rad", 1.0, "rpm", True),
        ("time_s,command_mV,velocity_rad_s", 1e-3, "V", False),
        ("time_s,command_counts,velocity_rpm", 1.0, "counts", False),
        ("Time [s],Command [A],Speed [deg/s]", 1.0, "A", False),
    ],
)
def test_commands_and_outputs(tmp_path, header, scale, unit, is_angle):
    """A command that was cut off is still what was commanded."""
    command = np.clip(3000 * np.sin(20 * TIME), -2800, 2800)
    (record,) = read_actuator(write(tmp_path, header, TIME, command, TIME))
    assert record.command.max() == pytest.approx(2800 * scale)
    assert (record.unit, record.is_angle) == (unit, is_angle)


def test_ready_response(tmp_path):
    path = write(tmp_path, "frequency_hz,magnitude_db,phase_deg", [1, 2, 4], [-66, -67, -70],
                 [-10, -20, -40])  # fmt: skip
    (found,) = read_actuator(path)
    assert isinstance(found, FrequencyResponse)
    assert np.abs(found.response[0]) == pytest.approx(10 ** (-66 / 20))
    assert found.frequency[1] == pytest.approx(4 * np.pi)


def test_an_angle_that_begins_anew_after_each_turn(tmp_path):
    command, angle = 100 + 50 * np.sin(6 * TIME), 400 * TIME
    path = write(tmp_path, "time_s,command_rpm,angle_deg", TIME, command, angle % 360)
    for read in (read_actuator, read_signals):
        with pytest.raises(DataError, match="jumps by a whole turn") as caught:
            read(path)
        assert caught.value.line == 92
    read_actuator(write(tmp_path, "time_s,command_rpm,angle_deg", TIME, command, angle))


ROWS = 1_000_000
SCRIPT = """
import resource, sys
from pathlib import Path
import numpy
from nrs_design.identification.datasets.records import read_tissue
peak = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
before = peak()
record = read_tissue(Path(sys.argv[1]))
print(len(record.force), peak() - before)
"""


@pytest.mark.slow
def test_a_million_rows(tmp_path):
    path = tmp_path / "large.csv"
    time = np.arange(ROWS) / 1000
    deflection = 0.01 * np.sin(time)
    rows = np.column_stack([time, deflection, 750 * deflection])
    np.savetxt(path, rows, "%.6f", ",", header="time_s,deflection_m,force_N", comments="")
    command = [sys.executable, "-c", SCRIPT, str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    count, kilobytes = map(int, done.stdout.split())
    assert count == ROWS
    # The three columns take 24 MB; the text alone would be 27 MB, as Python objects ten times that.
    assert kilobytes < 120_000, resource.RUSAGE_SELF
