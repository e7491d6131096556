"""A second opinion by python-flint on what our own integers have decided.

The trusted check decides; this module only has a right of veto. A disagreement is a defect of
this program or of flint, and never a verdict.

How far it goes: stable modes and averages are decided anew from the matrices; for a common
quadratic function the conditions are formed and decided anew; for every other kind flint decides
the definiteness of the forms that our code made. Where flint has the first word, on exponentials,
a Taylor series in Python integers has the second: at both ends of every stay, its enclosure must
meet that of flint. What flint makes of an exponential (times in between, products, traces) has no
second opinion.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from nrs_design.proof.evidence.abstract import AbstractEvidence
from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem

if TYPE_CHECKING:
    from nrs_design.proof.evidence.block_triangular import BlockTriangular
    from nrs_design.proof.evidence.graph import FormsOnGraph
    from nrs_design.proof.evidence.growing_sequence import GrowingSequence

# Half as many bits as are left of the diagonal where a matrix is rounded down.
SHORT_BITS = 24
# A matrix and a time, of which the exponential is enclosed.
Exponent = tuple[RationalMatrix, Fraction]


def agrees(
    system: SwitchedSystem, evidence: AbstractEvidence, forms: Sequence[IntegerMatrix] | None = None
) -> bool:
    """Tell whether the second opinion, too, is that evidence holds which the check has accepted.

    The forms are those that the check has made; by default they are made here.
    """
    if not all(_is_met(A, time) for A, time in _exponents(system, evidence)):
        return False
    decide = _OPINIONS.get(evidence.kind)
    if decide is not None and (opinion := decide(system, evidence)) is not None:
        return opinion
    checked_forms = (form for _, form in evidence.forms(system)) if forms is None else forms
    return all(map(finds_positive, checked_forms))


def _agrees_on_growth(system: SwitchedSystem, evidence: GrowingSequence) -> bool:
    from nrs_design.proof.evidence.growing_sequence import average

    if evidence.shares:
        return agrees(*evidence.at_value(system))
    if not evidence.is_average:
        return True
    return not _is_surely_stable(average(system, evidence.steps), system.time)


def _agrees_on_every_part(system: SwitchedSystem, evidence: BlockTriangular) -> bool:
    from nrs_design.proof.evidence.block_triangular import diagonal_block

    blocks = evidence.blocks
    return all(agrees(diagonal_block(system, blocks[k]), part) for k, part in evidence.parts)


def _exponents(system: SwitchedSystem, evidence: AbstractEvidence) -> set[Exponent]:
    """Return matrices and times of which flint encloses the exponential."""
    enclosed = _ENCLOSED.get(evidence.kind)
    if enclosed is None or system.time is Time.DISCRETE:
        return set()
    return set(enclosed(system, evidence, {mode.name: mode.A for mode in system.modes}))


def _steps(
    system: SwitchedSystem, evidence: GrowingSequence, modes: Mapping[str, RationalMatrix]
) -> Iterator[Exponent]:
    if evidence.doublings is not None and not evidence.shares:
        yield from ((modes[name], time) for name, time in evidence.steps)


def _stays(
    system: SwitchedSystem, evidence: FormsOnGraph, modes: Mapping[str, RationalMatrix]
) -> Iterator[Exponent]:
    if evidence.stays is None:
        return
    from nrs_design.proof.stays import shifted

    for name, stay in system.stays().items():
        for time in (stay.shortest, stay.longest if name in evidence.stays.leaving else None):
            if time:
                yield shifted(modes[name], evidence.rate), time


_ENCLOSED: Mapping[str, Callable[..., Iterator[Exponent]]] = {
    "growing-sequence": _steps,
    "graph": _stays,
}


def _is_met(A: RationalMatrix, time: Fraction) -> bool:
    """Tell whether flint's enclosure of ``exp(A t)`` and that of a Taylor series overlap."""
    from nrs_design.controllers.taylor import exponential_nearly
    from nrs_design.proof.enclosure import exponential, overlap, precision

    M, error = exponential_nearly(A, time)
    with precision():
        return overlap(exponential(A, time, time), M, error)


def _decreases_everywhere(system: SwitchedSystem, evidence: FormsOnGraph) -> bool | None:
    """Form one form and its decrease in every mode anew, in flint's arithmetic; else None.

    Facts and monomials enter the forms only.
    """
    if len(evidence.nodes) > 1 or evidence.degree > 1 or evidence.multipliers or evidence.stays:
        return None
    Q, p, q = _matrix(evidence.nodes[0].form), evidence.rate.numerator, evidence.rate.denominator

    def decrease(A: RationalMatrix) -> Any:
        N, d = _matrix(A.numerators), A.denominator
        if system.time is Time.DISCRETE:
            return Q * (p * p * d * d) - N.transpose() * Q * N * (q * q)
        half = Q * (N * q)
        return -half - half.transpose() - Q * (2 * p * d)

    modes = (decrease(mode.A) for mode in system.modes)
    return has_positive_spectrum(Q) and all(map(has_positive_spectrum, modes))


# The kinds on which flint has more to say than on the definiteness of their forms.
_OPINIONS: Mapping[str, Callable[[SwitchedSystem, Any], bool | None]] = {
    "block-triangular": _agrees_on_every_part,
    "graph": _decreases_everywhere,
    "growing-sequence": _agrees_on_growth,
}


def _matrix(rows: Sequence[Sequence[int]]) -> Any:
    from flint import fmpz_mat

    return fmpz_mat([list(row) for row in rows])


def finds_positive(M: IntegerMatrix) -> bool:
    """Tell whether flint finds a symmetric matrix positive definite, at first from a shorter one.

    With a power of two ``d_i`` for each row, ``M = D (S + R) D`` where S is rounded down to
    integers, so that the entries of the symmetric R are in [0, 1) and ``R >= -n I``. Where
    ``S - n I`` is positive definite, M is; where it is not, M itself is asked about.
    """
    shifts = [max(0, row[i].bit_length() // 2 - SHORT_BITS) for i, row in enumerate(M)]
    short = [
        [entry >> a + b for entry, b in zip(row, shifts, strict=True)]
        for row, a in zip(M, shifts, strict=True)
    ]
    for i, row in enumerate(short):
        row[i] -= len(M)
    return has_positive_spectrum(_matrix(short)) or has_positive_spectrum(_matrix(M))


def has_positive_spectrum(M: Any) -> bool:
    """Tell whether the characteristic polynomial of a symmetric flint matrix alternates in sign.

    All roots are real, so by Descartes' rule they are all positive iff it does.
    """
    falling = enumerate(reversed(M.charpoly().coeffs()))
    return all(c > 0 if k % 2 == 0 else c < 0 for k, c in falling)


def _is_surely_stable(A: RationalMatrix, time: Time) -> bool:
    """Tell whether rigorous enclosures of all eigenvalues lie in the stable region."""
    from nrs_design.proof.enclosure import eigenvalues

    balls = eigenvalues(A)
    if time is Time.CONTINUOUS:
        return all(ball.real < 0 for ball in balls)
    return all(abs(ball) < 1 for ball in balls)
