"""Where identified values come from."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import doubt_spec, parse_spec
from nrs_design.spec.describe import describe

from .samples import IMPEDANCE, spoiled

ARM = "    lever_arm: 0.24 m\n"
DOUBT = '    doubts: ["a: the residual is 46 % of the range of the force"]\n'
REASON = "    accept_doubt: a phantom, to be measured again\n"


def test_doubts_and_what_a_range_holds_are_listed():
    spec = parse_spec(spoiled(IMPEDANCE, ARM, f"{ARM}{DOUBT}{REASON}    range_covers: tolerance\n"))
    rows = {row.name: row for row in describe(spec)}
    assert "46 %" in rows["environments.soft.doubts[0]"].written
    assert rows["environments.soft.accept_doubt"].written == "a phantom, to be measured again"
    assert rows["environments.soft.range_covers"].value.startswith("95 % of all such specimens")
    assert not any("doubts" in doubt.at for doubt in doubt_spec(spec))


COVERED = "    range_covers: tolerance\n"


def test_values_that_were_changed_by_hand_are_refused():
    """The layout of the text may change; a value, its arm, a doubt and what is held may not."""
    plain = spoiled(IMPEDANCE, ARM, ARM + COVERED)
    plain = spoiled(plain, ARM, ARM + DOUBT)
    known = f"{COVERED}{DOUBT}    range_id: {parse_spec(plain).environments['soft'].values_id()}\n"
    text = spoiled(IMPEDANCE, ARM, ARM + known)
    assert parse_spec(text).environments["soft"].range_id is not None
    parse_spec(text.replace("lever_arm: 0.24 m", "lever_arm: 240 mm"))
    for old, new in (
        ("0.24 m", "0.25 m"),
        ("covers: tolerance", "covers: prediction"),
        (COVERED, ""),
        (DOUBT, ""),
    ):
        with pytest.raises(SpecError, match="changed since they were identified"):
            parse_spec(spoiled(text, old, new))
