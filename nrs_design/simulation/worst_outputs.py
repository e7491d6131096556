"""Outputs that an adversary maximizes: their values along runs, and certified bounds."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from nrs_design.axis import axis_with
from nrs_design.certificates.bounds import bound_on
from nrs_design.models.contact.environment import Environment
from nrs_design.proof.bounds import upper_float
from nrs_design.proof.channels import Output
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.norms import Array, deflected

DEFLECTION = "deflection"
_PUSHED = ("force", DEFLECTION)


def output_values(system: SwitchedSystem, output: Output, states: Array) -> Array:
    """Return an output along a run for every row of it; shape (K + 1, r).

    Tissue that can be lost pushes and never pulls.
    """
    rows = np.array([row.floats()[0] for row in output.rows])
    if system.contact is None:
        return np.asarray(states @ rows.T)
    values = np.asarray(deflected(states) @ rows.T)
    return np.maximum(values, 0.0) if pushes_only(system, output) else values


def pushes_only(system: SwitchedSystem, output: Output) -> bool:
    """Tell whether an output is of tissue that can be lost: it pushes and never pulls."""
    return system.contact is not None and output.name in _PUSHED


def deflection_of(system: SwitchedSystem) -> Output | None:
    """Return the deflection as an output; None where it is no state."""
    from nrs_design.proof.matrix import RationalMatrix

    axis = axis_with(system.states)
    delta = axis.named("delta [rad]")
    if delta not in system.states:
        return None
    row = [int(state == delta) for state in system.states]
    return Output(DEFLECTION, axis.unit("rad"), (RationalMatrix.from_rows([row]),))


def forces_by_mode(system: SwitchedSystem, touched: Sequence[Environment]) -> NDArray[np.bool_]:
    """Return the rows of the force that apply to contact and corner of each mode; shape (m, r).

    Modes are named after controller, contact and corner; one that names no contact may have any.
    """
    labels = [
        {environment.name, *(f"{p}-{end}" for p, (end, _) in zip(names, ends, strict=True) if end)}
        for environment in touched
        for names in (environment.law.parameters(),)
        for ends in product(*(interval.ends for interval in environment.ranges))
    ]
    found = np.array(
        [[label <= set(mode.name.split("/")) for label in labels] for mode in system.modes]
    )
    return np.asarray(found | ~found.any(axis=1, keepdims=True))


def certified_bounds(
    system: SwitchedSystem, statements: Iterable[AbstractEvidence]
) -> dict[str, float]:
    """Return certified bounds on every output and on the deflection, rounded up.

    Of checked statements, bounds under all disturbances at once count. Where the force is a
    stiffness times the deflection, the bound holds for every stiffness in its range, so also for
    the highest.
    """
    found: dict[str, float] = {}
    checked = tuple(statements)
    for output in system.outputs:
        bound = bound_on(system, checked, output.name)
        if bound is None:
            continue
        found[output.name] = upper_float(bound.level)
        rows = [row.fractions()[0] for row in output.rows]
        if output.name == "force" and not any(any(row[:-1]) for row in rows):
            found[DEFLECTION] = upper_float(bound.level / max(abs(row[-1]) for row in rows))
    return found
