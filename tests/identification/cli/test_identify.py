"""What `nrs-design identify` does alike whatever is identified."""

import pytest

from tests.identification.cli.records import NOSE, SINUSOIDS, SOFT
from tests.support import run


@pytest.mark.slow
@pytest.mark.parametrize(("dates", "count"), [((), 0), (("--date", "2026-03-01"), 1)])
def test_a_report_has_the_date_that_is_given_and_no_other(tmp_path, dates, count):
    options = ("--report", "p.html", *dates, "-q")
    run("identify", "tissue", SOFT[0], *options, cwd=tmp_path, code=0)
    page = (tmp_path / "p.html").read_text()
    assert page.count("<time") == count
    assert page.count('<time datetime="2026-03-01">2026-03-01</time>') == count


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["tissue", "missing.csv"], "missing.csv: cannot be read"),
        (["tissue", SOFT[0], NOSE[0]], "linear and rotational records are mixed"),
        (["tissue", SOFT[0], "--lever-arm", "24 N"], "is not a length"),
        (["tissue", SOFT[0], "--map", "Fz"], "is not a pair"),
        (["tissue", SINUSOIDS[0]], "are missing"),
        (["actuator", SOFT[0]], "are missing"),
    ],
)
def test_bad_input_is_one_message(tmp_path, arguments, message):
    result = run("identify", *arguments, cwd=tmp_path, code=2)
    assert message in result.stderr
    assert result.stderr.count("error[") == 1
    assert list(tmp_path.iterdir()) == []


def test_help_has_examples(tmp_path):
    for command in ("tissue", "actuator", "delay"):
        assert "Example: nrs-design identify" in run("identify", command, "-h", cwd=tmp_path).stdout
    assert "Example: nrs-design audit run.csv" in run("audit", "-h", cwd=tmp_path).stdout
