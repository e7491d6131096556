"""What a search for polynomials takes: known before anything is lifted."""

from __future__ import annotations

from math import comb

from nrs_design.proof.evidence.graph import MAX_DEGREE, MAX_MONOMIALS
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.sdp import program_cost
from nrs_design.work import Cost

HELD = f"a certificate holds at most {MAX_MONOMIALS} monomials and degree {MAX_DEGREE}"


def highest_degree(variables: int) -> int:
    """Return the largest d whose monomials a certificate can hold."""
    degrees = range(1, MAX_DEGREE // 2 + 1)
    fitting = (d for d in degrees if comb(variables + d - 1, d) <= MAX_MONOMIALS)
    return max(fitting, default=1)


def polynomial_cost(variables: int, modes: int, degree: int) -> tuple[Cost, str]:
    """Predict what a common polynomial takes before anything is lifted; say for what.

    Parameters
    ----------
    variables : int
        States.
    modes : int
        How many.
    degree : int
        The d of a form of degree 2d.
    """
    order = comb(variables + degree - 1, degree)
    shared = order * (order + 1) // 2 + 1
    forms = shared - 1 - comb(variables + 2 * degree - 1, 2 * degree)
    cones = [(order, shared)] * 2 + [(order, shared + forms)] * modes
    return program_cost(shared + modes * forms, shared, cones), f"a program in {order} monomials"


def family_cost(system: SwitchedSystem, degree: int) -> tuple[Cost, str]:
    """Predict the same for a system; see `polynomial_cost`."""
    return polynomial_cost(system.order, len(system.modes), degree)


def conewise_cost(system: SwitchedSystem, degree: int) -> tuple[Cost, str]:
    """Predict what one solution takes, before anything is lifted; say for what.

    Parameters
    ----------
    system : SwitchedSystem
        In which contact is lost.
    degree : int
        The d of a form of degree 2d.
    """
    assert system.contact is not None  # the ladder
    n, free = system.order, len(system.contact.free)
    order, inner = (comb(m + degree - 1, degree) for m in (n, n - 1))
    shared = order * (order + 1) // 2 + 1
    forms = shared - 1 - comb(n + 2 * degree - 1, 2 * degree)
    flying = inner * (inner + 1) // 2 - comb(n - 1 + 2 * degree - 1, 2 * degree)
    modes = len(system.modes)
    cones = [(order, shared)] * 2 + [(order, shared + forms)] * modes
    cones += [(inner, shared + flying)] * free
    unknowns = shared + modes * forms + free * flying
    return program_cost(unknowns, shared, cones), f"a program in {order} monomials"
