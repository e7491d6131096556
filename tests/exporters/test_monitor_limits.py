"""What a running loop is held against follows from its spec and its proof."""

from dataclasses import replace
from fractions import Fraction

from nrs_design.exporters.monitor_limits import monitor_limits
from tests.exporters.monitored import spec_with
from tests.exporters.programs import LAWS

LAW = LAWS["inertia"]


def test_what_is_monitored_is_what_the_spec_says(sampled_export):
    stays = spec_with("{dwell_time: 2.501 s, longest_dwell_time: 5.001 s}")
    limits = monitor_limits(replace(sampled_export, spec=stays), LAW)
    assert limits.stays == ((1251, 2500), (1251, 2500))
    limits = monitor_limits(replace(sampled_export, spec=spec_with()), LAW)
    assert limits.torque <= Fraction(3, 10) < limits.torque * (1 + Fraction(1, 2**22))
    assert (limits.age, limits.command) == ((0, 1), 3000)


def test_rules_that_name_contacts_are_not_followed(sampled_export):
    spec = spec_with("{transitions: [[insertion, withdrawal]]}")
    limits = monitor_limits(replace(sampled_export, spec=spec), LAW)
    assert limits.follows == ((True, True), (False, True))
    rules = spec.switching.model_copy(update={"transitions": (("insertion/a", "withdrawal/b"),)})
    named = replace(sampled_export, spec=spec.model_copy(update={"switching": rules}))
    limits = monitor_limits(named, LAW)
    assert limits.follows == ((True, True), (True, True))
    assert [text for text in limits.left_out if "name contacts" in text]
