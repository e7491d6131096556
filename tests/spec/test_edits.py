"""A file is read as if it said something else, for a while, and alone."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import parse_spec, read_spec
from nrs_design.spec.edits import saying_instead
from nrs_design.spec.load import read_axes
from tests.support import COMMUTING, ROOT, SOFT_TISSUE
from tests.tables import rows

TORQUE = (("limits", "torque"), "0.2 N*m")


def test_read_as_if_it_were_written(tmp_path):
    text = SOFT_TISSUE.read_text(encoding="utf-8")
    assert "0.3 N*m" in text
    (tmp_path / "written.nrs.yaml").write_text(text.replace("0.3 N*m", "0.2 N*m"), encoding="utf-8")
    written = read_spec(tmp_path / "written.nrs.yaml")
    before = read_spec(SOFT_TISSUE)
    with saying_instead(SOFT_TISSUE, [TORQUE]):
        said = read_spec(SOFT_TISSUE)
        assert said.spec.limits.torque.text == "0.2 N*m"
        assert said.sha256 == written.sha256
        assert read_spec(COMMUTING).sha256
    assert read_spec(SOFT_TISSUE) == before


@pytest.mark.parametrize(
    ("at", "text", "kept"), rows(__file__, "test_other_values_are_not_those_that_were_identified")
)
def test_other_values_are_not_those_that_were_identified(tmp_path, at, text, kept):
    """They were refused, or would be said to hold what the records do."""
    file = tmp_path / "a.nrs.yaml"
    arm = "    lever_arm: 0.24 m\n"
    beside = "    range_covers: tolerance\n    doubts: [too few]\n    accept_doubt: a reason\n"
    written = SOFT_TISSUE.read_text(encoding="utf-8").replace(arm, arm + beside)
    identified = parse_spec(written).environments["soft"].values_id()
    file.write_text(written.replace(beside, f"{beside}    range_id: {identified}\n"))
    at = ("environments", "soft", *at)
    with saying_instead(file, [(at, text)]):
        soft = read_spec(file).spec.environments["soft"]
    assert (soft.range_id, soft.range_covers) == (
        (identified, "tolerance") if kept else (None, None)
    )


def test_a_fault_has_the_place_of_what_it_replaces():
    place = read_spec(SOFT_TISSUE).place("limits", "torque")
    with (
        saying_instead(SOFT_TISSUE, [(("limits", "torque"), "0.2 s")]),
        pytest.raises(SpecError) as caught,
    ):
        read_spec(SOFT_TISSUE)
    assert caught.value.line == place.line


def test_an_axis_of_a_file_with_several():
    file = ROOT / "docs/examples/six-axes.nrs.yaml"
    before = [axis.sha256 for axis in read_axes(file)]
    with saying_instead(file, [(("axes", "x", "limits", "bandwidth"), "1.25 Hz")]):
        after = [axis.sha256 for axis in read_axes(file)]
    assert [a != b for a, b in zip(before, after, strict=True)] == [True, *[False] * 5]
