"""Forms of a certificate in floating point: matrices for tables, and norms for runs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Table
from nrs_design.reporting.evidence.offers import Form
from nrs_design.reporting.formatting import number
from nrs_design.simulation.norms import (
    Array,
    Norm,
    clipped,
    polynomial_norm,
    quadratic_norm,
    scaled_matrices,
)

# Larger matrices, and more of them, do not fit on a page.
_WRITTEN, _TABLES = 8, 2


def norms_of(forms: Sequence[Form], order: int) -> list[Norm]:
    """Return the root of each form; quadratic ones are all divided by the same number."""
    if forms[0].degree == 1:
        return [quadratic_norm(Q) for Q in scaled_matrices(*(form.Q for form in forms))]
    return [polynomial_norm(form.Q, form.degree, order) for form in forms]


def largest_norm(forms: Sequence[Form], order: int) -> Norm:
    """Return the largest root of the forms in contact, and in free motion of those for it.

    Without forms for free motion, those in contact hold there with the deflection at zero.
    """
    norms = norms_of(forms, order)
    touching = [norm for norm, form in zip(norms, forms, strict=True) if not form.free]
    free = [norm for norm, form in zip(norms, forms, strict=True) if form.free]

    def in_contact(states: Array) -> Array:
        return np.asarray(np.max([norm(states) for norm in touching], axis=0))

    def everywhere(states: Array) -> Array:
        flying = np.max([norm(states[..., :-1]) for norm in free], axis=0)
        return np.asarray(np.where(states[..., -1] > 0, in_contact(states), flying))

    return everywhere if free else in_contact


def step_norms(forms: Sequence[Form], system: SwitchedSystem) -> list[Norm]:
    """Return the norm of every step of a round; in free motion without the deflection."""
    norms = norms_of(forms, system.order)
    return norms if system.contact is None else [clipped(norm) for norm in norms]


def matrix_tables(forms: Sequence[Form], states: tuple[str, ...]) -> list[Table]:
    """Return the matrices of the first quadratic forms as tables, if a page holds them."""
    matrices = scaled_matrices(*(form.Q for form in forms))
    shown = list(zip(forms, matrices, strict=True))[:_TABLES]
    return [_table(form.name, Q, states[: len(Q)]) for form, Q in shown if len(Q) <= _WRITTEN]


def _table(of: str, Q: Array, states: tuple[str, ...]) -> Table:
    rows = tuple((name, *(number(v, 5) for v in row)) for name, row in zip(states, Q, strict=True))
    return Table(f"Q{of and f' of {of}'}, divided by the largest entry", ("", *states), rows)
