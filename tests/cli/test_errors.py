"""What errors look like, as a user meets them."""

import pytest

from nrs_design.cli.errors import MAX_LISTED, MAX_SHOWN, excerpt
from tests.spec.samples import IMPEDANCE, SWITCHED, spoiled
from tests.support import ROOT, SOFT_TISSUE, document_of, run, typed
from tests.terminal import run_on_terminal

FAULTY = spoiled(
    spoiled(spoiled(IMPEDANCE, "0.0351 s", "12 mS"), "damping_ratio: 0.707", "damping: 0.707"),
    "stiffness: 43 N*m/rad",
    "stiffness: {nominal: 43, range: [1 N*m/rad, 2]}",
)


@pytest.fixture
def faulty(tmp_path):
    (tmp_path / "a.nrs.yaml").write_text(FAULTY)
    return tmp_path


def test_every_fault_with_its_line_a_caret_and_its_remedy(faulty):
    result = typed("check", "a.nrs.yaml", cwd=faulty)
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr.count("error[NRS001]") == 4
    assert "4 faults in a.nrs.yaml" in result.stderr
    lines = result.stderr.splitlines()
    assert lines[:6] == [
        "error[NRS001]: actuator.time_constant: unknown unit 'mS'",
        " --> a.nrs.yaml:5:18",
        "  |",
        "5 |   time_constant: 12 mS",
        "  |                  ^",
        "  = help: did you mean ms?",
    ]


def test_other_commands_show_the_same(faulty):
    shown = run("check", "a.nrs.yaml", cwd=faulty).stderr
    assert run("certify-switching", "a.nrs.yaml", cwd=faulty).stderr == shown


def test_json_lists_them_all(faulty):
    (spec,) = document_of("check", "a.nrs.yaml", cwd=faulty)["specs"]
    assert [(f["line"], f["column"]) for f in spec["faults"]] == [
        (5, 18),
        (7, 3),
        (17, 26),
        (17, 49),
    ]
    assert all(fault["message"] and fault["remedy"] for fault in spec["faults"])
    error = document_of("tune", "a.nrs.yaml", cwd=faulty)
    assert (error["schema"], error["faults"]) == ("nrs-design/error/1", spec["faults"])


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


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("name: sample", " name: sample", "'name' is indented by 1 space"),
        ("{velocity: 8 deg/s, torque: 0.3 N*m, bandwidth: 2 Hz}", "[1]", "a mapping, not a list"),
        ("0.3 N*m", "0 N*m", "help: write a number above zero, such as '0.3 N*m'"),
        ("0.24 m", "240", "help: write '240 mm' or '240 m', whichever is meant"),
    ],
)
def test_slips_of_the_pen(tmp_path, old, new, said):
    (tmp_path / "a.nrs.yaml").write_text(spoiled(IMPEDANCE, old, new))
    assert said in run("check", "a.nrs.yaml", cwd=tmp_path).stderr


def test_the_words_of_wrong_usage_are_printable(tmp_path):
    shown = run("check", "--no-such\u202eoption\x1b[31m", cwd=tmp_path, code=2).stderr
    assert shown.replace("\n", "").isprintable()


def test_a_design_without_answer_points_at_its_field(tmp_path):
    text = spoiled(IMPEDANCE, "{min: 0.1 N*m*s/rad, max: 20", "{min: 0.0001 N*m*s/rad, max: 0.001")
    (tmp_path / "a.nrs.yaml").write_text(text)
    shown = run("optimize", "a.nrs.yaml", cwd=tmp_path).stderr
    line = next(i for i, part in enumerate(text.splitlines(), 1) if "Bt:" in part)
    assert f"a.nrs.yaml:{line}:5" in shown
    assert "error[NRS002]: controller insertion: no admittance" in shown


@pytest.mark.slow
def test_colour_on_a_terminal_unless_refused(faulty):
    assert "\x1b[1;31merror[NRS001]" in run_on_terminal(80, "check", "a.nrs.yaml", cwd=faulty)[0]
    plain, code = run_on_terminal(80, "check", "a.nrs.yaml", cwd=faulty, NO_COLOR="1")
    assert "\x1b" not in plain
    assert code == 2


def test_quiet_prints_errors_only(tmp_path):
    proof = ROOT / "reports/soft-tissue.cert.json"
    for command in (("check",), ("tune",), ("optimize",), ("verify", proof)):
        result = run(*command, SOFT_TISSUE, "-q", cwd=tmp_path)
        assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
