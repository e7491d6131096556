"""A parameter that is unknown but constant: a form at each end of it, as a theorem of Coq."""

from __future__ import annotations

from math import lcm

from nrs_design.exporters.proof_assistant.text import (
    Definitions,
    factor_of,
    identifiers,
    listed,
    long_integer,
    symmetric,
)
from nrs_design.exporters.proof_assistant.theorem import Theorem
from nrs_design.proof.evidence.parameter_quadratic import ParameterQuadratic
from nrs_design.proof.exact import IntegerMatrix, lyapunov_factor
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.system import SwitchedSystem

LIBRARY = ("forms", "polynomials", "continuous", "parameter")


def parameter_theorem(system: SwitchedSystem, evidence: ParameterQuadratic) -> Theorem:
    """Return the theorem of a certificate with a constant parameter."""
    definitions, modes = Definitions(), {mode.name: mode.A for mode in system.modes}
    names = identifiers(modes)
    for name, A in modes.items():
        definitions.define(names[name], _flow(A, definitions), name)
    definitions.define("low", symmetric(evidence.low))
    definitions.define("high", symmetric(evidence.high))
    _, _, *forms = (form for _, form in evidence.forms(system))
    witnesses = []
    for k, (low, high) in enumerate(system.switching.fixed_ends):
        over = lcm(modes[low].denominator, modes[high].denominator)
        factor = lyapunov_factor(over, evidence.rate)
        three = [_witness(gram, factor) for gram in forms[3 * k : 3 * k + 3]]
        witnesses.append(definitions.define(f"witness{k + 1}", f"({', '.join(three)})"))
    rate = f"{evidence.rate.numerator} {evidence.rate.denominator}"
    factor = max(map(factor_of, (evidence.low, evidence.high)))
    pairs = listed(f"({names[low]}, {names[high]})" for low, high in system.switching.fixed_ends)
    shape = f"{system.order} {rate} {factor} low high\n    {pairs}"
    return Theorem(
        LIBRARY,
        definitions.texts,
        f"parameter_falls {shape}\n    {listed(witnesses)}",
        f"decays_between {shape}",
        "parameter_sound _ _ _ _ _ _ _ _ checked",
        system.states,
    )


def _flow(A: RationalMatrix, definitions: Definitions) -> str:
    return f"Flow {listed(map(definitions.row, A.numerators))} {A.denominator} [] 1"


def _witness(gram: IntegerMatrix, factor: int) -> str:
    return f"Witness {symmetric(gram, long_integer)} {factor}"
