"""The exact check, sooner for large families; what it accepts is what the plain check accepts.

`certify` asks here. Whatever re-checks a certificate runs `nrs_design.proof` only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import accumulate, combinations_with_replacement
from operator import mul, sub
from typing import Any

from nrs_design.proof.evidence import AbstractEvidence, FormsOnGraph
from nrs_design.proof.evidence.abstract import find_indefinite
from nrs_design.proof.exact import IntegerMatrix, bit_length, is_symmetric, is_too_large, multiply
from nrs_design.proof.system import SwitchedSystem

# Bits of the smallest diagonal entry in the elimination with rounded numbers: one digit of Python.
CLEAR_BITS = 28
# From this order on, packed products are faster than plain ones.
PACKED_ORDER = 10
# Work per candidate, and per form: for itself, and per product of entries and square of their bits.
# What a motion does during a stay is enclosed anew for each form.
PER_CANDIDATE = 1e-3
PER_FORM, PER_ENCLOSED_FORM = 1e-4, 5e-4
PER_PRODUCT = 1.5e-7
PER_SQUARED_BITS = 2e-13

Forms = Iterator[tuple[str, IntegerMatrix]]


def find_fault(
    evidence: AbstractEvidence,
    system: SwitchedSystem,
    charge: Callable[[float], None] = lambda work: None,
) -> str | None:
    """Say why evidence does not hold, or None: `AbstractEvidence.find_fault`, sooner.

    Forms that are clearly positive definite are passed over; the plain test decides the others. The
    work of the check is charged form by form.
    """
    charge(PER_CANDIDATE)
    if (unfit := evidence.find_unfit(system)) is not None:
        return unfit
    packed = _PACKED.get(type(evidence)) if system.order >= PACKED_ORDER else None
    forms = evidence.forms(system) if packed is None else packed(evidence, system)
    # Evidence that encloses what happens during a stay says in how many pieces.
    encloses = getattr(getattr(evidence, "stays", None), "pieces", 1) > 1
    counted = _counted(forms, PER_ENCLOSED_FORM if encloses else PER_FORM, charge)
    return find_indefinite(item for item in counted if not is_clearly_positive_definite(item[1]))


def _counted(forms: Forms, each: float, charge: Callable[[float], None]) -> Forms:
    """Charge every form as it is made."""
    for name, M in forms:
        charge(each + len(M) ** 3 * (PER_PRODUCT + PER_SQUARED_BITS * bit_length(M) ** 2))
        yield name, M


def is_clearly_positive_definite(M: IntegerMatrix) -> bool:
    """Tell whether elimination with rounded numbers shows that a matrix is positive definite.

    Rounding down to multiples of 2^s changes a symmetric matrix of order r by an E with entries of
    size below 2^s, so ``E <= r 2^s I``: what is left after ``r 2^s I`` is subtracted, too, is below
    the matrix. The matrix itself and every Schur complement is replaced by such a smaller one. If
    all pivots of these are positive, so are those of the matrix. No is no answer; nor is it one for
    what is not symmetric, or so large that the plain test refuses to decide it.
    """
    if not M or is_too_large(M) or not is_symmetric(M):
        return False
    order = len(M)
    shift = CLEAR_BITS - min(M[i][i] for i in range(order)).bit_length()
    entries = [
        entry << shift if shift >= 0 else entry >> -shift
        for i, row in enumerate(M)
        for entry in row[i:]
    ]
    while order:
        # Where the diagonal is in an upper triangle that is written row after row.
        for k in accumulate(range(order, 1, -1), initial=0):
            entries[k] -= order
        pivot, row, rest = entries[0], entries[1:order], entries[order:]
        if pivot <= 0:
            return False
        # In the order of the entries: the pairs of every entry of the row with all from it on.
        pairs = combinations_with_replacement(row, 2)
        entries = list(map(sub, rest, [a * b // pivot for a, b in pairs]))
        order -= 1
    return True


def multiply_packed(left: IntegerMatrix, right: IntegerMatrix) -> list[list[int]]:
    """Return the matrix product, as `nrs_design.proof.exact.multiply` does.

    Every row of the right factor is written as one long integer, with its entries as digits of a
    base that no entry of the product can overflow. A row of the product is then a sum of as many
    long products as it has factors; half of the base makes its digits positive.
    """
    if not right or any(len(row) != len(right) for row in left):
        return multiply(left, right)
    width = bit_length(left) + bit_length(right) + len(right).bit_length() + 1
    half, mask = 1 << (width - 1), (1 << width) - 1
    shifts = range(0, width * len(right[0]), width)
    long_rows = [sum([a << shift for a, shift in zip(row, shifts, strict=True)]) for row in right]
    halves = sum(half << shift for shift in shifts)
    sums = [sum(map(mul, row, long_rows), halves) for row in left]
    return [[(total >> shift & mask) - half for shift in shifts] for total in sums]


# Kinds with forms that may be multiplied in another way.
_PACKED: Mapping[type[AbstractEvidence], Callable[[Any, SwitchedSystem], Forms]] = {
    FormsOnGraph: lambda evidence, system: evidence.forms(system, multiply_packed)
}
