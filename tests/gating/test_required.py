"""What a spec asks of its design, and a lock file must therefore say."""

import pytest

from nrs_design.gating.lock import read_lock
from nrs_design.gating.locked import find_missing
from nrs_design.spec import read_spec
from tests.support import ROOT, SOFT_TISSUE

GOALS = "goals: {max_sensitivity_peak: 9, transparency: {max_impedance: 9 N*m*s/rad, band: BAND}}"
RUN = """scenarios:
  hit: {command: {constant: 8 deg/s}, duration: 1 s, limits: {torque: 1 N*m, velocity: 9 deg/s}}
"""


def asked(tmp_path, text, locked=(), status="missed"):
    path = tmp_path / "s.nrs.yaml"
    path.write_text(text)
    known = {locked: status} if locked else {}
    return [f"{rule} {subject}" for rule, subject in find_missing(read_spec(path).spec, known)]


def test_every_shipped_lock_says_what_its_spec_asks():
    entries = read_lock(ROOT / "nrs.lock").specs
    for entry in entries:
        spec = read_spec(ROOT / entry.path).spec
        locked = [(goal.rule, goal.subject) for goal in entry.goals]
        assert find_missing(spec, dict.fromkeys(locked, "met")) == ()
        # Whichever is gone is missing.
        for index in range(len(locked)):
            rest = locked[:index] + locked[index + 1 :]
            assert find_missing(spec, dict.fromkeys(rest, "met")) == (locked[index],)


def test_goals_of_the_spec_and_limits_of_runs_are_asked(tmp_path):
    text = f"{SOFT_TISSUE.read_text()}{GOALS.replace('BAND', '[0 Hz, 1 Hz]')}\n{RUN}"
    controllers = [
        f"{rule} {name}"
        for name in ("insertion", "withdrawal")
        for rule, name in (
            ("NRS103", name),
            ("NRS106", f"{name}: max_sensitivity_peak"),
            ("NRS112", f"{name}: transparency"),
        )
    ]
    limits = ["NRS109 hit: torque", "NRS109 hit: velocity"]
    assert asked(tmp_path, text) == [*controllers, *limits]
    assert asked(tmp_path, text, ("NRS103", "controllers")) == limits
    assert asked(tmp_path, text, ("NRS109", "hit")) == controllers
    # What was never judged is not met, whatever a lock says.
    for stand_in in (("NRS103", "controllers"), ("NRS109", "hit")):
        assert asked(tmp_path, text, stand_in, "met") == [*controllers, *limits]


@pytest.mark.parametrize(("outer", "limited"), [("1 ms", False), ("4 ms", True)])
def test_no_limit_where_the_force_is_sampled_more_often(tmp_path, outer, limited):
    text = (
        SOFT_TISSUE.read_text() + f"sampling: {{period: 2 ms, delay: 0, outer_period: {outer}}}\n"
    )
    assert ("NRS103 insertion" in asked(tmp_path, text)) is limited
