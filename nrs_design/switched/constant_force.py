"""A constant force that pushes into contact: what a statement about it is allowed to speak of."""

from __future__ import annotations

from dataclasses import replace

from nrs_design.proof.system import SwitchedSystem
from nrs_design.switched.assumption import say

_ASSUMED = (
    say("constant-force.force", "one Fd > 0, of any size, that does not change"),
    say("constant-force.stiffness", "a stiffness in its range that does not change"),
)


def with_constant_force(system: SwitchedSystem) -> SwitchedSystem:
    """Let statements be about a constant force; where no contact can be lost, nothing changes.

    The modes stay what they are: at a constant stiffness they are those of the deviations from the
    rest at F = Fd, and where the surface is, a statement says by itself.

    Parameters
    ----------
    system : SwitchedSystem
        One axis in contact with one environment, as `nrs_design.spec.combinations` checks.
    """
    if system.contact is None:
        return system
    return replace(
        system,
        contact=replace(system.contact, pushed=True),
        assumptions=(*system.assumptions, *_ASSUMED),
    )
