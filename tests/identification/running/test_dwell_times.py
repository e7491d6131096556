"""Times in each mode: inside is what every reading of a log allows, outside what none does."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.identification.running.bounds import read_run_bounds
from nrs_design.spec import read_spec
from tests.identification import runs
from tests.identification.runs import check, judged, log
from tests.support import SOFT_TISSUE
from tests.tables import rows


def with_switching(tmp_path, rules):
    """The nominal tissue: a dwell time and a range exclude each other."""
    text = SOFT_TISSUE.read_text().replace("switching: arbitrary", f"switching: {rules}")
    text = text.replace("{nominal: 747.1461 N/m, range: [720.56 N/m, 768.17 N/m]}", "747 N/m")
    path = tmp_path / "spec.nrs.yaml"
    path.write_text(text)
    return read_run_bounds(read_spec(path))


@pytest.mark.parametrize(("rules", "status", "words"), rows(__file__, "test_dwell_times"))
def test_dwell_times(tmp_path, rules, status, words):
    found = check(judged(log(tmp_path), with_switching(tmp_path, rules)), "dwell times")
    assert found.status == status
    if words is not None:
        assert words in found.violation


@pytest.mark.parametrize(
    ("inserting", "status", "words"),
    [
        (lambda t: t < 0.5, "undecided", "insertion lasted 0.498 s at least: the log begins with"),
        (lambda t: t < 9.5, "inside", "1 switch; a stay between two rows (up to 0.002 s) is not"),
        (lambda t: (t < 5) | (t > 6), "outside", "2 switches"),
    ],
)
def test_what_the_rows_of_a_log_tell_of_stays(tmp_path, inserting, status, words):
    """A first stay may have begun before the log; a last one has not ended within it."""
    t, *rest, _ = runs.run()
    record = log(tmp_path, (t, *rest, np.where(inserting(t), "insertion", "withdrawal")))
    found = check(judged(record, with_switching(tmp_path, "{dwell_time: 2 s}")), "dwell times")
    assert found.status == status
    assert words in found.measured


def test_a_log_with_a_row_for_every_sample_misses_no_stay(tmp_path):
    rules = replace(with_switching(tmp_path, "{dwell_time: 2 s}"), period=0.002)
    assert check(judged(log(tmp_path), rules), "dwell times").measured == "3 switches"


@pytest.mark.parametrize(
    ("rules", "cut", "status"), rows(__file__, "test_missing_rows_may_hide_switches")
)
def test_missing_rows_may_hide_switches(tmp_path, rules, cut, status):
    """Neither inside, nor outside by what would need the rows."""
    columns = runs.run()
    kept = (columns[0] < cut[0]) | (columns[0] > cut[1])
    record = log(tmp_path, tuple(column[kept] for column in columns))
    found = check(judged(record, with_switching(tmp_path, rules)), "dwell times")
    assert found.status == status


def test_rules_that_name_contacts_are_not_taken_for_none(tmp_path):
    rules = "{transitions: [[insertion/soft, withdrawal/soft]]}"
    found = judged(log(tmp_path), with_switching(tmp_path, rules))
    stays = check(found, "dwell times")
    assert stays.status == "not judged"
    assert "name contacts" in stays.measured
    assert found.verdict == "inconclusive"


def test_rules_without_a_column(tmp_path):
    record = log(tmp_path, csv=runs.without_modes(runs.run()))
    assert check(judged(record), "dwell times").status == "inside"
    found = judged(record, with_switching(tmp_path, "{dwell_time: 2 s}"))
    assert check(found, "dwell times").measured == "no column for mode"
