"""Logs in any format."""

import numpy as np
import pytest
from scipy.io import savemat

from nrs_design.identification.running import read_run
from tests.identification import runs


@pytest.mark.parametrize(
    ("ending", "names"), [("csv", "iw"), ("npz", "iw"), ("mat", "iw"), ("npz", "37")]
)
def test_modes_have_names(tmp_path, ending, names):
    t, angle, torque, command, mode = runs.run(duration=6.0)
    mode = np.where(mode == "insertion", *names)
    path = tmp_path / f"run.{ending}"
    columns = {"time_s": t, "angle_rad": angle, "mode": mode.astype(int) if "3" in names else mode}
    if ending == "csv":
        path.write_text(runs.text(t, angle, torque, command, mode))
    else:
        {"npz": lambda: np.savez(path, **columns), "mat": lambda: savemat(path, columns)}[ending]()
    log = read_run(path)
    assert log.labels == tuple(names)
    assert [log.labels[i] for i in log.modes] == mode.tolist()
    assert log.command_unit == ("rpm" if ending == "csv" else "")
