"""Logs of tests, and what is judged of them."""

from nrs_design.identification.running.bounds import read_run_bounds
from nrs_design.identification.running.judge import judge_run
from nrs_design.identification.running.log import read_run
from nrs_design.identification.tables.columns import parse_mapping
from nrs_design.spec import read_spec
from tests.identification import runs
from tests.support import ROBOT, SOFT_TISSUE

SOFT = read_run_bounds(read_spec(SOFT_TISSUE))
SAMPLED = read_run_bounds(read_spec(ROBOT / "soft-tissue-sampled.nrs.yaml"))


def log(tmp_path, data=None, text=None, entries=()):
    path = tmp_path / "run.csv"
    path.write_text(runs.text(*(data or runs.run())) if text is None else text)
    return read_run(path, parse_mapping(entries))


def judged(record, bounds=SOFT, **options):
    return judge_run(record, bounds, proved=True, **options)


def check(found, name):
    return next(item for item in found.checks if item.name == name)
