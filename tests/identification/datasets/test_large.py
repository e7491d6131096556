"""A million rows, in bounded memory."""

import resource
import subprocess
import sys

import numpy as np
import pytest

ROWS = 1_000_000
SCRIPT = """
import resource, sys
from pathlib import Path
import numpy
from nrs_design.identification.datasets import read_tissue
peak = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
before = peak()
seen = []
record = read_tissue(Path(sys.argv[1]), {}, seen.append)
print(len(record.force), peak() - before, len(seen))
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
    count, kilobytes, steps = map(int, done.stdout.split())
    assert count == ROWS
    # The three columns take 24 MB; the text alone would be 27 MB, as Python objects ten times that.
    assert kilobytes < 120_000, resource.RUSAGE_SELF
    assert steps > 20
