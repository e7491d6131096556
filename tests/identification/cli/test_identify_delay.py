"""`nrs-design identify delay`, as a user types it."""

import shutil

import numpy as np
import pytest

from tests.identification import signals
from tests.support import ROBOT, document_of, run

COMMAND = ("identify", "delay", "loop.csv", "--command", "raw", "--measured", "used")


def write_loop(folder, time, raw, used):
    rows = np.column_stack([time, raw, used])
    np.savetxt(folder / "loop.csv", rows, "%.6f", ",", header="time_s,raw,used", comments="")


@pytest.mark.slow
def test_delay_into_a_spec(tmp_path):
    spec = tmp_path / "mine.nrs.yaml"
    shutil.copy(ROBOT / "soft-tissue-sampled.nrs.yaml", spec)
    record = signals.copy(1)
    write_loop(tmp_path, record.time, record.sent, record.seen)
    unnamed = run("identify", "delay", "loop.csv", "--write", spec, cwd=tmp_path, code=2)
    assert "as the law used it" in " ".join(unnamed.stderr.replace("│", " ").split())
    options = ("--report", "delay.html", "--write", spec)
    document = document_of(*COMMAND, *options, cwd=tmp_path, code=0)
    samples = document["delay_samples"]
    assert samples["low"] < signals.DELAY < samples["high"]
    assert document["sampling_step_s"] == pytest.approx(0.002)
    assert document["whole_samples"][1] >= 3
    assert (tmp_path / "delay.html").exists()
    assert "delay: [1, 4]" in spec.read_text()


def test_a_doubt_is_no_success(tmp_path):
    """Of columns that are swapped, the exit code was 0, and the text said "-0.01 s later"."""
    record = signals.copy(4)
    write_loop(tmp_path, record.time, record.seen, record.sent)
    done = run(*COMMAND, cwd=tmp_path, code=3)
    assert "s earlier (correlation" in done.stdout
    assert "samples of 0.002 s [95 %]" in done.stdout
    assert "warning: used comes 6.23 samples before raw" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["loop.csv", "--command", "raw"], "name both columns"),
        (["loop.csv", "--command", "raw", "--measured", "usd"], "there is no column 'usd' to map"),
        (["loop.csv", "--command", "raw", "--measured", "raw"], "name two columns"),
        (["loop.csv", "--command", "time_s", "--measured", "raw"], "the column of --command"),
        (["loop.csv"], "are missing"),
        (["none.csv"], "cannot be read"),
    ],
)
def test_wrong_delays(tmp_path, arguments, message):
    (tmp_path / "loop.csv").write_text("time_s,raw,used\n" + "0,1,2\n" * 60)
    done = run("identify", "delay", *arguments, cwd=tmp_path, code=2)
    assert message in done.stderr
    assert "_any" not in done.stderr
