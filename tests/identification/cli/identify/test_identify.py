"""What `nrs-design identify` does alike whatever is identified."""

import pytest

from tests.identification.cli.identify.records import DATA, NOSE, SINUSOIDS, SOFT
from tests.support import COMMUTING, run


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["html", "pdf"])
def test_report(tmp_path, ending):
    page = tmp_path / f"page.{ending}"
    run("identify", "tissue", *SOFT[:1], "--report", page, "-q", cwd=tmp_path, code=0)
    assert page.read_bytes()[:4] in (b"<!DO", b"%PDF")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "data"), [("tissue", SOFT[0]), ("actuator", DATA / "actuator-response.csv")]
)
def test_a_report_has_the_date_that_is_given_and_no_other(tmp_path, command, data):
    pages = []
    for dates in ([], ["--date", "2026-03-01"]):
        run("identify", command, data, "--report", "p.html", *dates, "-q", cwd=tmp_path, code=0)
        pages.append((tmp_path / "p.html").read_text())
    dated = '<time datetime="2026-03-01">2026-03-01</time>'
    assert [page.count("<time") for page in pages] == [0, 1]
    assert dated in pages[1]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["tissue", "missing.csv"], "missing.csv: cannot be read"),
        (["tissue", SOFT[0], NOSE[0]], "linear and rotational records are mixed"),
        (["tissue", SOFT[0], "--lever-arm", "24 N"], "is not a length"),
        (["tissue", SOFT[0], "--map", "Fz"], "is not a pair"),
        (["tissue", SOFT[0], "--write", COMMUTING], "has no place for identified values"),
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
    for command in ("tissue", "actuator", "delay", "tool"):
        assert "Example: nrs-design identify" in run("identify", command, "-h", cwd=tmp_path).stdout
    assert "Example: nrs-design audit run.csv" in run("audit", "-h", cwd=tmp_path).stdout
