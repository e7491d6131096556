"""Logs of a run."""

import numpy as np
import pytest

from nrs_design.identification.running import read_run
from tests.identification import runs


@pytest.mark.parametrize("names", ["iw", "37"])
def test_modes_have_names(tmp_path, names):
    t, angle, torque, command, mode = runs.run(duration=6.0)
    mode = np.where(mode == "insertion", *names)
    path = tmp_path / "run.csv"
    path.write_text(runs.text(t, angle, torque, command, mode))
    log = read_run(path)
    assert log.labels == tuple(names)
    assert [log.labels[i] for i in log.modes] == mode.tolist()
    assert log.command_unit == "rpm"
