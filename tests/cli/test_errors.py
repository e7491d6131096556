"""What errors look like, as a user meets them."""

import pytest

from nrs_design.cli.errors import MAX_LISTED, MAX_SHOWN, excerpt
from tests.spec.samples import SWITCHED
from tests.support import document_of, run
from tests.tables import rows
from tests.terminal import run_on_terminal


def test_json_lists_so_many_faults_and_counts_them_all(tmp_path):
    text = SWITCHED + "".join(f"key{i}: 1\n" for i in range(MAX_LISTED + 5))
    (tmp_path / "a.nrs.yaml").write_text(text)
    (spec,) = document_of("check", "a.nrs.yaml", cwd=tmp_path)["specs"]
    assert (spec["count"], len(spec["faults"])) == (MAX_LISTED + 5, MAX_LISTED)


def test_no_more_than_a_screenful(tmp_path):
    modes = "".join(f"  - {{name: m{i}, A: [[?]]}}\n" for i in range(MAX_SHOWN + 5))
    text = SWITCHED.partition("  - ")[0] + modes.replace("?", "x y") + "switching: arbitrary\n"
    (tmp_path / "a.nrs.yaml").write_text(text)
    shown = run("check", "a.nrs.yaml", cwd=tmp_path).stderr
    assert shown.count("-->") == MAX_SHOWN
    assert shown.splitlines()[-1] == f"{MAX_SHOWN} faults and 5 more in a.nrs.yaml"


@pytest.mark.parametrize("column", [1, 2, 57, 120, 5000])
def test_long_lines_are_cut_around_the_caret(column):
    line = "".join(chr(ord("a") + i % 26) for i in range(5000))
    shown, before = excerpt(line, column, 60)
    assert len(shown) <= 60
    assert shown[before] == line[column - 1]


def test_wide_characters_count_twice_and_escapes_as_written():
    assert excerpt("\u4e2d\u6587: x", 5, 60) == ("\u4e2d\u6587: x", 6)
    assert excerpt("\t- 1", 2, 60) == ("\\t- 1", 2)


def test_the_words_of_wrong_usage_are_printable(tmp_path):
    shown = run("check", "--no-such\u202eoption\x1b[31m", cwd=tmp_path, code=2).stderr
    assert shown.replace("\n", "").isprintable()


@pytest.mark.parametrize(
    ("arguments", "said"), rows(__file__, "test_wrong_usage_is_json_like_every_other_error")
)
def test_wrong_usage_is_json_like_every_other_error(tmp_path, arguments, said):
    document = document_of(*arguments, cwd=tmp_path, code=2)
    (fault,) = document["faults"]
    assert document["schema"] == "nrs-design/error/1"
    assert said in fault["message"]


@pytest.mark.slow
def test_colour_on_a_terminal_unless_refused(tmp_path):
    (tmp_path / "a.nrs.yaml").write_text(f"{SWITCHED}key: 1\n")
    shown, _ = run_on_terminal(80, "check", "a.nrs.yaml", cwd=tmp_path)
    assert "\x1b[1;31merror[NRS001]" in shown
    plain, code = run_on_terminal(80, "check", "a.nrs.yaml", cwd=tmp_path, NO_COLOR="1")
    assert "\x1b" not in plain
    assert code == 2
