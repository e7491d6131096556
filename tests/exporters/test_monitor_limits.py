"""What a running loop is held against follows from its spec and its proof."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.exporters.monitor_limits import monitor_limits
from nrs_design.spec import parse_spec, read_spec
from tests.exporters.monitored import TEXT, spec_with
from tests.exporters.programs import LAWS
from tests.support import ROBOT

LAW = LAWS["inertia"]


def test_what_is_monitored_is_what_the_spec_says(sampled_export):
    """Thesis 6.1 and 6.3.1.1: 720.56 to 768.17 N/m at 0.24 m, 0.3 N m."""
    stays = spec_with("{dwell_time: 2.501 s, longest_dwell_time: 5.001 s}")
    limits = monitor_limits(replace(sampled_export, spec=stays), LAW.modes)
    assert limits.stays == ((1251, 2500), (1251, 2500))
    limits = monitor_limits(replace(sampled_export, spec=spec_with()), LAW.modes)
    (pair,) = limits.stiffness[0]
    ends = [Fraction("720.56") * Fraction("0.24") ** 2, Fraction("768.17") * Fraction("0.24") ** 2]
    assert [float(k) for k in pair] == pytest.approx([float(end) for end in ends])
    assert ends[0] <= pair[0] <= pair[1] <= ends[1]
    assert limits.torque <= Fraction(3, 10) < limits.torque * (1 + Fraction(1, 2**22))
    assert (limits.window, limits.age, limits.command) == (250, (0, 1), 3000)


def test_lost_contact_that_the_proof_covers(tmp_path, sampled_export):
    """Without a proof, what the spec asks for counts."""
    record = sampled_export.record.model_copy(update={"verdict": "unproved", "unproved": "so"})
    export = replace(sampled_export, record=record)
    spec = parse_spec(f"{TEXT}contact: losable\n")
    assert not monitor_limits(replace(export, spec=spec), ("insertion",)).contact_kept
    assert monitor_limits(replace(export, spec=spec_with()), ("insertion",)).contact_kept
    covered = replace(sampled_export, spec=spec_with())
    assert not monitor_limits(covered, ("insertion",)).contact_kept
    assert monitor_limits(replace(covered, certificate=None), ("insertion",)).contact_kept


def test_free_modes_of_force_control_are_covered(sampled_export):
    """Their proof is of an ordinary kind: it knows them as modes, not as a loss of contact."""
    spec = read_spec(ROBOT / "force-limit-sampled.nrs.yaml").spec
    export = replace(sampled_export, spec=spec, certificate=None)
    assert not monitor_limits(export, tuple(spec.controllers)).contact_kept


def test_a_tissue_that_remembers_is_not_judged(sampled_export):
    spec = read_spec(ROBOT / "nose.nrs.yaml").spec
    limits = monitor_limits(replace(sampled_export, spec=spec), tuple(spec.controllers))
    assert set(limits.stiffness) == {()}
    assert [text for text in limits.left_out if "remembers" in text]


def test_rules_that_name_contacts_are_not_followed(sampled_export):
    spec = spec_with("{transitions: [[insertion, withdrawal]]}")
    limits = monitor_limits(replace(sampled_export, spec=spec), LAW.modes)
    assert limits.follows == ((True, True), (False, True))
    rules = spec.switching.model_copy(update={"transitions": (("insertion/a", "withdrawal/b"),)})
    named = replace(sampled_export, spec=spec.model_copy(update={"switching": rules}))
    limits = monitor_limits(named, LAW.modes)
    assert limits.follows == ((True, True), (True, True))
    assert [text for text in limits.left_out if "name contacts" in text]


@pytest.mark.parametrize(("period", "window"), [("0.05", 20), ("0.002", 250), ("0.0001", 500)])
def test_a_window_is_neither_too_short_nor_too_long(sampled_export, period, window):
    time = sampled_export.record.sample_time.model_copy(update={"exact": period})
    record = sampled_export.record.model_copy(update={"sample_time": time})
    export = replace(sampled_export, record=record, spec=spec_with())
    assert monitor_limits(export, LAW.modes).window == window
