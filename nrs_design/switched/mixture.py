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
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.gains import idle_decay
from nrs_design.controllers.laws import Admittance
from nrs_design.errors import AssemblyError
from nrs_design.models.contact.environment import Environment
from nrs_design.models.contact.law import AbstractLinearLaw
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.spec import IdleStatesSpec

Row = list[Fraction]
Rows = tuple[tuple[Fraction, ...], ...]
ZERO = Fraction(0)


def check_mixture(coordinates: str, touched: tuple[Environment, ...]) -> None:
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


def idle_size(design: ControllerDesign) -> int:
    """Return how many states the impedance controllers have of their own."""
    laws = [c.law for c in design.controllers if isinstance(c.law, Admittance)]
    return 1 + any(law.Mt != 0 for law in laws)


def impedance_rows(A: Rows, C: Row, law: Admittance, contact: AbstractLinearLaw) -> list[Row]:
    """Return A of an impedance mode in the state ``[xi, vm, r]``.

    ``Mt vm' = -Bt vm + F``, ``r' = -vm``, ``F = k Cp xi + b Cp (Ap xi + Bp r)``. With ``Mt = 0``
    the velocity is ``vm = F / Bt``.

    Parameters
    ----------
    A, C : rows
        Of the motion loop in controllable canonical form, ``Bp = [0, ..., 1]'``.
    law : Admittance
        In N m s/rad and kg m^2.
    contact : AbstractLinearLaw
        Without memory.
    """
    (k,), b = contact.reaction.C, contact.reaction.D
    n = len(C)
    rates = [sum((C[i] * A[i][j] for i in range(n)), ZERO) for j in range(n)]
    inner = [ZERO] * (law.Mt != 0)
    force = [*(k * c + b * rate for c, rate in zip(C, rates, strict=True)), *inner, b * C[-1]]
    rows = [[*row, *inner, ZERO] for row in A]
    rows[-1][-1] = Fraction(1)
    if law.Mt == 0:
        return [*rows, [-f / law.Bt for f in force]]
    admittance = [f / law.Mt for f in force]
    admittance[n] -= law.Bt / law.Mt
    return [*rows, admittance, [*[ZERO] * n, Fraction(-1), ZERO]]


def with_idle(rows: list[Row], count: int, decay: Fraction) -> list[Row]:
    """Append the idle states to a position or force mode.

    Parameters
    ----------
    rows : list of rows
        Its A in the state xi.
    count : int
        Of idle states.
    decay : Fraction
        Their rate in 1/s.
    """
    n = len(rows)
    idle = [[ZERO] * (n + i) + [-decay] + [ZERO] * (count - i - 1) for i in range(count)]
    return [[*row, *[ZERO] * count] for row in rows] + idle


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
            if isinstance(source.law, Admittance) and not isinstance(target.law, Admittance):
                yield source.name, target.name, RationalMatrix.from_rows(kept)


def mixture_states(order: int, count: int) -> tuple[str, ...]:
    """Name the states."""
    admittance = ("vm [rad/s]",) if count == 2 else ()
    return (*(f"xi{i + 1}" for i in range(order)), *admittance, "reference [rad]")


def mixture_texts(idle: IdleStatesSpec, count: int) -> Iterator[str]:
    """Say what is taken for granted about the states of impedance controllers."""
    what = "the position reference" if count == 1 else "the velocity vm and the position reference"
    decay = idle_decay(idle)
    meanwhile = f"decay at {exact_decimal(decay)} 1/s" if decay else "are held"
    yield (
        f"Impedance controllers integrate their velocity to a position reference of the motion "
        f"loop. While a position or force controller is active, {what} of the impedance "
        f"controllers act on nothing and {meanwhile}."
    )
    if idle.reset:
        yield (
            "At a switch from an impedance controller to a position or force controller they are "
            "set to zero: an impedance controller starts from the rest position, with vm = 0."
        )
    yield (
        "The commanded position is that at which the contact carries no force; position and "
        "reference are counted from it."
    )
    yield (
        "The reference that the motion loop follows, and with it the velocity, may jump at a "
        "switch; position and motion state xi do not: the PD differentiates the jump. A controller "
        "that leaves this kick out is not covered."
    )
