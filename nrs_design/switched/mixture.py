"""Impedance controllers beside position and force controllers: one state for all of them.

Position and force controllers give the motion loop a position, impedance controllers a velocity,
which the robot integrates to a position ``r' = vc - vm``. The loop from r to the position theta is
the same G, so with its states xi every mode is written in ``[xi, vm, r]`` (without virtual
inertia ``[xi, r]``): ``xi' = Ap xi + Bp r``, ``theta = Cp xi``. Where another controller is active,
vm and r are idle.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.errors import AssemblyError
from nrs_design.models.contact.environment import Environment
from nrs_design.proof.matrix import RationalMatrix


def check_mixture_models(coordinates: str, touched: tuple[Environment, ...]) -> None:
    """Check that what is mixed has a model.

    Raises
    ------
    AssemblyError
        If not.
    """
    if coordinates == "force":
        raise AssemblyError(
            "force coordinates do not apply to impedance controllers beside others",
            remedy="use coordinates: deflection",
            at=("coordinates",),
        )
    for environment in touched:
        if environment.law.remembers:
            raise AssemblyError(
                f"environment {environment.name}, which is {environment.law.name}, is not modelled "
                "for impedance controllers beside others",
                remedy="use elastic or Kelvin-Voigt environments, or one kind of controller",
                at=("environments", environment.name),
            )


def resets_of(
    design: ControllerDesign, order: int, count: int
) -> Iterator[tuple[str, str, RationalMatrix]]:
    """Yield the switches from impedance controllers to others: the idle states become zero.

    Parameters
    ----------
    design : ControllerDesign
        All controllers.
    order, count : int
        How many states the motion loop has, and how many are idle.

    Yields
    ------
    tuple of (str, str, RationalMatrix)
        Controller before and after the switch, and what becomes of the state.
    """
    size = order + count
    kept = [[Fraction(int(i == j < order)) for j in range(size)] for i in range(size)]
    for source in design.controllers:
        for target in design.controllers:
            if (source.law.commands, target.law.commands) == ("velocity", "position"):
                yield source.name, target.name, RationalMatrix.from_rows(kept)
