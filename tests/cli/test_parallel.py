"""Parallel position and force control, from the spec to the verdict, as a user types it."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import parse_spec
from tests.support import ROOT, document_of, run

PARALLEL = ROOT / "docs/examples/parallel.nrs.yaml"


def changed(tmp_path, *pairs):
    text = PARALLEL.read_text()
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "changed.nrs.yaml"
    path.write_text(text)
    return path


def test_any_stiffness_from_tissue_to_tissue_and_tool_is_proved(tmp_path):
    result = run(
        "certify-switching", PARALLEL, "-v", "--out", "ours.cert.json", cwd=tmp_path, code=0
    )
    assert "PROVED" in result.stdout
    assert "the axis moves on until it meets something" in result.stdout
    run("verify", "ours.cert.json", PARALLEL, cwd=tmp_path, code=0)


def test_an_integral_alone_is_refuted_where_routh_says_so(tmp_path):
    """At Ki = 1000 the limit is 51 N m/rad, within the range of the spec."""
    path = changed(tmp_path, ("0.02 rad", "1e-6 rad"), ("0.2 rad/(N*m*s)", "1000 rad/(N*m*s)"))
    run("certify-switching", path, cwd=tmp_path, code=1)
    (item,) = document_of("tune", path, cwd=tmp_path)["parallel"]
    low, high = item["unstable_stiffness"]
    assert low == pytest.approx(51.1, abs=0.1)
    assert high > 104.7


@pytest.mark.slow
def test_tune_and_report(tmp_path):
    result = run("tune", PARALLEL, cwd=tmp_path, code=0)
    assert "parallel: parallel control" in result.stdout
    assert "none" in result.stdout
    run("report", PARALLEL, "--out", "page.html", cwd=tmp_path, code=0)
    page = (tmp_path / "page.html").read_text()
    assert "Region of gains" in page
    assert "Goals and worst values" not in page


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("    proportional_gain: 0.02 rad/(N*m)\n", "", "proportional_gain` is missing"),
        ("0.2 rad/(N*m*s)", "0.2 rad/(N*m)", "that is a proportional gain"),
        ("0.2 rad/(N*m*s)", "0 rad/(N*m*s)", "must be positive"),
        ("design:", "goals: {max_sensitivity_peak: 2}\ndesign:", "no controller that a goal"),
        (
            "model: elastic",
            "model: kelvin-voigt\n    damping: 1 N*m*s/rad",
            "which has damping or remembers: not modelled",
        ),
        ("switching:", "contact: losable\nswitching:", None),
    ],
)
def test_what_is_refused(tmp_path, old, new, message):
    path = changed(tmp_path, (old, new))
    if message is None:
        result = run("certify-switching", path, cwd=tmp_path, code=2)
        assert "loss of contact is modelled for impedance" in result.stderr
        return
    with pytest.raises(SpecError) as caught:
        parse_spec(path.read_text())
    assert message in f"{caught.value.message} ({caught.value.remedy})"


def test_others_beside_it_share_no_state(tmp_path):
    path = changed(tmp_path, ("controllers:\n", "controllers:\n  position: {type: position}\n"))
    result = run("certify-switching", path, cwd=tmp_path, code=2)
    assert "a parallel controller, beside 'position'" in result.stderr
