"""Logs in any format."""

import numpy as np
import pytest
from scipy.io import savemat

from nrs_design.identification.running import read_run
from tests.identification import runs


@pytest.mark.parametrize("ending", ["csv", "npz", "mat"])
@pytest.mark.parametrize("numbers", [False, True])
def test_modes_have_names(tmp_path, ending, numbers):
    t, angle, torque, command, mode = runs.run(duration=6.0)
    if numbers:
        mode = np.where(mode == "insertion", 3, 7)
    path = tmp_path / f"run.{ending}"
    columns = {"time_s": t, "angle_rad": angle, "mode": mode}
    if ending == "csv":
        path.write_text(runs.text(t, angle, torque, command, mode))
    elif ending == "npz":
        np.savez(path, **columns)
    else:
        savemat(path, columns)
    log = read_run(path)
    names = ("3", "7") if numbers else ("insertion", "withdrawal")
    assert [*log.labels] == [*names]
    assert [log.labels[i] for i in log.modes] == [str(word) for word in mode]
    assert log.command_unit == ("rpm" if ending == "csv" else "")
