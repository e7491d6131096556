"""A response as a table, and what reads it."""

import numpy as np
import pytest

from nrs_design.identification.running.log import read_run
from nrs_design.simulation.time_response import Signal, TimeResponse


def response(t=(0.0, 0.5, 0.5, 1.0)):
    n = len(t)
    ones = np.linspace(0, 1 / 3, n)
    return TimeResponse(
        np.array(t),
        np.array([ones, 2 * ones]),
        np.array([3 * ones]),
        np.array([4 * ones]),
        (Signal("angle", "rad"), Signal("torque", "N*m")),
        (Signal("commanded position", "rad"),),
        (Signal("hand", "rad/s"),),
        np.where(np.arange(n) < n // 2, 0, 1),
        ("insertion", "withdrawal"),
    )


def test_rows_are_found_by_name():
    one = response()
    assert len(one) == 4
    assert one["torque"] == pytest.approx(2 * one["angle"])
    assert one["hand"] == pytest.approx(4 * one["angle"])
    assert one.active == ["insertion", "insertion", "withdrawal", "withdrawal"]
    with pytest.raises(KeyError):
        one["speed"]


def test_a_table_has_one_row_for_an_instant():
    lines = response().to_csv().splitlines()
    assert lines[0] == "time_s,angle_rad,torque_Nm,hand_rad_s,commanded-position_rad,mode"
    modes = [line.rpartition(",")[2] for line in lines[1:]]
    assert modes == ["insertion", "withdrawal", "withdrawal"]


def test_csv_is_read_back_to_the_bit(tmp_path):
    """The log of a running robot has these columns."""
    file, one = tmp_path / "run.csv", response(tuple(np.linspace(0, 1, 60)))
    file.write_text(one.to_csv())
    log = read_run(file)
    assert log.time.tolist() == one.t.tolist()
    assert log.columns["torque"].tolist() == one["torque"].tolist()
    assert log.labels == ("insertion", "withdrawal")
