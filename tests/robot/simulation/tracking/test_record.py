import numpy as np
import pytest

from nrs_design.robot.simulation.tracking.experiment import Experiment
from nrs_design.robot.simulation.tracking.record import TrackingRecord

ERROR = np.array([[0.01, 0.0, 1e-3], [-0.01, 0.02, -1e-3]])


@pytest.fixture
def record():
    experiment = Experiment("psi", (0.0, 0.0, 0.2), 0.1, np.pi, hold=1.0)
    wanted = np.ones((2, 3))
    command = np.array([[1.0, -5.0, 2.0], [3.0, 4.0, 0.0]])
    return TrackingRecord(
        "any", experiment, np.arange(2.0), wanted, wanted - ERROR, wanted - 2 * ERROR, command
    )


def test_root_mean_square_of_each_coordinate(record):
    assert record.rmse == pytest.approx([0.01, 0.02 / 2**0.5, 1e-3])
    assert record.actual_rmse == pytest.approx(2 * record.rmse)


def test_summary_in_the_units_of_the_print(record):
    summary = record.summary()
    assert (summary["controller"], summary["moved"]) == ("any", "psi")
    assert (summary["period"], summary["duration"]) == pytest.approx((2.0, 3.0))
    assert summary["rmse"] == pytest.approx([np.degrees(0.01), np.degrees(0.02 / 2**0.5), 1.0])
    assert summary["actual_rmse"] == pytest.approx([2 * error for error in summary["rmse"]])
    assert summary["largest_command"] == [3, 5, 2]
