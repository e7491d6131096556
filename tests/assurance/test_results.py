import pytest

from nrs_design.assurance.results import RecordedTest, read_results
from nrs_design.errors import DataError, SpecError

HASH = "0123456789abcdef" * 4
IDS = ("tissue.linear", "period.single")
ITEM = "{result: passed, date: 2026-01-31, reference: TR-17}"


def written(tmp_path, results, spec=f'"{HASH}"'):
    path = tmp_path / "results.yaml"
    path.write_text(f"spec: {spec}\nresults:\n{results}\n")
    return path


def test_results_are_read(tmp_path):
    items = f"  tissue.linear: {ITEM}\n"
    items += "  period.single: {result: failed, date: 2026-02-01, by: lab 3, reference: log 4}"
    path = written(tmp_path, items)
    found = read_results(path, IDS)
    assert found.spec == HASH
    assert found.by_id == {
        "tissue.linear": RecordedTest(True, "2026-01-31", "TR-17", ""),
        "period.single": RecordedTest(False, "2026-02-01", "log 4", "lab 3"),
    }
    assert found.text == path.read_text()
    assert found.by_id["period.single"].said == "failed, 2026-02-01, by lab 3, log 4"


def test_an_unknown_id_is_refused_with_the_list(tmp_path):
    with pytest.raises(DataError) as caught:
        read_results(written(tmp_path, f"  tissue.linear: {ITEM}\n  tisue.linear: {ITEM}"), IDS)
    assert (caught.value.line, caught.value.column) == (4, 3)
    assert "there is no id 'tisue.linear'" in str(caught.value)
    assert "tissue.linear, period.single" in str(caught.value.remedy)


@pytest.mark.parametrize(
    ("item", "said"),
    [
        ("{result: passed, date: 2026-01-31}", "reference is missing"),
        ("{result: ok, date: 2026-01-31, reference: x}", "the result is 'ok'"),
        ("{result: passed, date: 31.1.2026, reference: x}", "'31.1.2026' is no date"),
        ("{result: passed, date: 2026-02-30, reference: x}", "'2026-02-30' is no date"),
        ("{result: passed, date: 2026-01-31, reference: ''}", "reference of tissue.linear is no"),
        ("{result: passed, date: 2026-01-31, reference: [x]}", "reference of tissue.linear is no"),
        ("{result: passed, date: 2026-01-31, reference: x, who: y}", "'who' is no key here"),
        ("passed", "'tissue.linear' is no mapping"),
    ],
)
def test_what_says_something_else_is_refused_with_its_line(tmp_path, item, said):
    with pytest.raises(DataError, match=said) as caught:
        read_results(written(tmp_path, f"  tissue.linear: {item}"), IDS)
    assert caught.value.line == 3
    assert caught.value.remedy


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f"results: {{tissue.linear: {ITEM}}}", "spec is missing"),
        (f'spec: "{HASH}"', "results is missing"),
        (f"spec: abc\nresults: {{tissue.linear: {ITEM}}}", "spec is not a SHA-256"),
        ("- 1", "'the file' is no mapping"),
    ],
)
def test_a_file_of_another_form_is_refused(tmp_path, text, said):
    path = tmp_path / "results.yaml"
    path.write_text(text)
    with pytest.raises(DataError, match=said):
        read_results(path, IDS)


def test_an_id_that_is_there_twice_is_refused(tmp_path):
    with pytest.raises(SpecError):
        read_results(written(tmp_path, f"  tissue.linear: {ITEM}\n  tissue.linear: {ITEM}"), IDS)
