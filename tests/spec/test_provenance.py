"""Where identified values come from."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import parse_spec

from .samples import IMPEDANCE, spoiled

ARM = "    lever_arm: 0.24 m\n"
DOUBT = '    doubts: ["a: the residual is 46 % of the range of the force"]\n'


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
