"""What a statement about a constant force takes for granted, and where there is none."""

from dataclasses import replace

from nrs_design.switched.constant_force import with_constant_force
from tests.proof.systems import bouncing


def test_force_and_stiffness_are_said_to_be_constant():
    system = with_constant_force(bouncing())
    assert system.contact == replace(bouncing().contact, pushed=True)
    force, stiffness = system.assumptions
    assert "one Fd > 0 that does not change" in force
    assert "does not change" in stiffness
    assert [force.id, stiffness.id] == ["constant-force.force", "constant-force.stiffness"]


def test_where_contact_is_kept_nothing_changes():
    kept = replace(bouncing(), contact=None)
    assert with_constant_force(kept) is kept
