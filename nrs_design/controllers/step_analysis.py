"""What follows from the operations of a law: its map, its roundings, and how large it gets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import chain

from nrs_design.controllers.operations import LINEAR, Operation, StepLaw
from nrs_design.controllers.sampled import Term
from nrs_design.errors import DesignError
from nrs_design.models.linear_form import LinearForm, combine

# Single precision reaches to 2^128; what a bound itself leaves out is far less than the other half.
LARGEST = Fraction(2) ** 127
# More than all roundings of a step add to a value, over its size.
SLACK = 1 + Fraction(1, 2**16)


def linear_forms(law: StepLaw, mode: int, given: Mapping[str, LinearForm]) -> dict[str, LinearForm]:
    """Return every value of a step as a linear form, computed without rounding or saturation.

    Parameters
    ----------
    law : StepLaw
        The law.
    mode : int
        Which controller is in force.
    given : mapping of str to LinearForm
        Inputs and states in coordinates of the caller's choice.

    Raises
    ------
    ValueError
        If the law is not linear.
    """
    _check_linear(law)
    forms = dict(given)
    for operation in law.operations:
        right = forms[operation.right]
        if operation.kind == "saturate":
            forms[operation.name] = right
        elif operation.kind == "multiply":
            factor = law.coefficient[operation.left].of(mode)
            forms[operation.name] = combine((factor, right))
        else:
            sign = Fraction(1 if operation.kind == "add" else -1)
            forms[operation.name] = combine((Fraction(1), forms[operation.left]), (sign, right))
    return forms


def _check_linear(law: StepLaw) -> None:
    others = {operation.kind for operation in law.operations} - LINEAR
    if others:
        raise ValueError(f"not linear: {', '.join(sorted(others))}")


def rounded_terms(
    law: StepLaw, mode: int, given: Mapping[str, LinearForm]
) -> dict[str, tuple[Term, ...]]:
    """Return what each result is a sum of, and in how many roundings each summand takes part.

    Only of results that are used further on: those whose rounding is their own, the outputs and
    the next states. Of a result with a rounding of its own, the operations after it take the
    rounded value.

    Parameters
    ----------
    law : StepLaw
        The law.
    mode : int
        Which controller is in force.
    given : mapping of str to LinearForm
        Inputs and states in coordinates of the caller's choice.
    """
    forms, terms = linear_forms(law, mode, given), dict[str, tuple[Term, ...]]()
    for value in law.values:
        count = int(value.rounding == "term")
        terms[value.name] = (Term(value.symbol, given[value.name], count),)
    kept: dict[str, tuple[Term, ...]] = {}
    targets = {*law.outputs.values(), *law.following.values()}
    for operation in law.operations:
        found = _terms(law, mode, operation, terms)
        if operation.rounding == "own" or operation.name in targets:
            kept[operation.name] = found
        if operation.rounding == "own":
            found = (Term(operation.symbol, forms[operation.name], 0),)
        terms[operation.name] = found
    return kept


def _terms(
    law: StepLaw, mode: int, operation: Operation, terms: Mapping[str, tuple[Term, ...]]
) -> tuple[Term, ...]:
    right = terms[operation.right]
    if operation.kind == "saturate":
        return right
    if operation.kind == "multiply":
        coefficient = law.coefficient[operation.left]
        factor, prefix = coefficient.of(mode), f"{coefficient.symbol} "
        if factor in (0, 1):
            # Both products are exact.
            return right if factor else ()
        return tuple(term.times(factor, prefix, 1) for term in right)
    add, left = operation.kind == "add", terms[operation.left]
    sign = Fraction(1 if add else -1)
    if not left or not right:
        # What nothing is added to stays as it is.
        return left or tuple(term.times(sign, "", 0) for term in right)
    more = int(operation.rounding != "angle")
    both = (*left, *(term.times(sign, "", 0) for term in right))
    if any(term.roundings for term in both):
        return tuple(term.times(Fraction(1), "", more) for term in both)
    # A sum of exact numbers is off in proportion to itself.
    names = [" + ".join(term.name for term in side) for side in (left, right)]
    name = operation.symbol or f"({names[0]} {'+' if add else '-'} {names[1]})"
    return (Term(name, combine(*((Fraction(1), term.form) for term in both)), more),)


def check_range(law: StepLaw) -> None:
    """See that no operation can leave single precision while values keep their limits.

    Raises
    ------
    DesignError
        If one can.
    ValueError
        If the law is not linear: its results are checked instead.
    """
    _check_linear(law)
    bounds = {value.name: value.limit for value in law.values}
    for operation in law.operations:
        right = bounds[operation.right]
        if operation.kind in ("multiply", "saturate"):
            left = max(map(abs, law.coefficient[operation.left].values))
            bound = min(left, right) if operation.kind == "saturate" else left * right * SLACK
        else:
            bound = (bounds[operation.left] + right) * SLACK
        if bound >= LARGEST:
            raise DesignError(
                f"{operation.name} of the law may be beyond single precision",
                remedy="choose smaller gains, or other units",
            )
        bounds[operation.name] = bound


def term_counts(law: StepLaw, mode: int = 0) -> dict[str, int]:
    """Return how often each term of a law is rounded in a mode, by its name."""
    given: dict[str, Sequence[Fraction]] = {value.name: [Fraction(0)] for value in law.values}
    terms = chain.from_iterable(rounded_terms(law, mode, given).values())
    return {term.name: term.roundings for term in terms if term.roundings}
