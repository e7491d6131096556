"""A constant force that pushes into contact: what a statement about it is allowed to speak of."""

from __future__ import annotations

from dataclasses import replace

from nrs_design.proof.system import SwitchedSystem
from nrs_design.switched import assumption_kinds as kinds

_ONE_FORCE = kinds.INPUTS.says(
    "Where a constant force pushes in: the admittances take F - Fd in place of F, with one Fd > 0 "
    "that does not change, whichever controller is active; all other inputs are zero.",
    "one Fd > 0, of any size, that does not change",
)
_ONE_STIFFNESS = kinds.TISSUE.says(
    "Where a constant force pushes in: the stiffness is anywhere in its range, but does not "
    "change; one that does moves the deflection at which F = Fd, and is not covered.",
    "a stiffness in its range that does not change",
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
        assumptions=(*system.assumptions, _ONE_FORCE, _ONE_STIFFNESS),
    )
