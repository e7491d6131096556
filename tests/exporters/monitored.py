"""A spec whose running loop is monitored, with other rules of switching."""

from nrs_design.spec import parse_spec
from tests.support import SOFT_TISSUE

TEXT = SOFT_TISSUE.read_text().replace("bandwidth: 2 Hz", "bandwidth: 2 Hz\n  command: 3000 rpm")


def spec_with(rules="arbitrary", text=TEXT):
    """The nominal tissue where there are rules: a dwell time and a range exclude each other."""
    if rules != "arbitrary":
        text = text.replace("switching: arbitrary", f"switching: {rules}")
        text = text.replace("{nominal: 747.1461 N/m, range: [720.56 N/m, 768.17 N/m]}", "747 N/m")
    return parse_spec(text)
