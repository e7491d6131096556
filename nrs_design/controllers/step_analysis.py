"""Map, roundings and range of a law, from its operations."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.float32 import PRECISION
from nrs_design.controllers.operations import Kind, Operation, StepLaw
from nrs_design.errors import DesignError
from nrs_design.models.linear_form import ONE, LinearForm, combine, zero

# Single precision ends at 2^128. The factor two covers roundings that the bound neglects.
LARGEST = Fraction(2) ** 127
# More than all roundings of a step add to a value, over its size.
SLACK = 1 + Fraction(1, 2**16)
# Half a unit in the last place, over the number.
UNIT = Fraction(1, 2**PRECISION)


def rounding_share(count: int) -> Fraction:
    """Return the bound on the relative error of a term after 1 to 15 roundings.

    Rounding to nearest changes a result by at most ``u = 2^-24`` of its size; a fused product and
    sum rounds once less. That is ``n u / (1 - n u)``, and ``n u (1 + 2^-20)`` is not less for n up
    to 15: a dyadic number.
    """
    if not 1 <= count <= 15:
        raise ValueError(f"{count} roundings are not counted")
    return count * UNIT * (1 + Fraction(1, 2**20))


@dataclass(frozen=True, slots=True)
class Term:
    """A term of a sum that the processor forms."""

    name: str  # Such as ``b F``
    form: LinearForm  # Value without rounding, over the state
    roundings: int  # Number of roundings of the term

    def times(self, factor: Fraction, prefix: str, roundings: int) -> Term:
        """Return the term times a single-precision factor, which is named in front.

        `prefix` is its name and a blank; `more`, how many roundings, that of the product included.
        """
        return Term(prefix + self.name, combine((factor, self.form)), self.roundings + roundings)


def rounded_terms(
    law: StepLaw,
    mode: int,
    inputs: Mapping[str, LinearForm],
    numbers: Mapping[str, Fraction] | None = None,
    errors: Mapping[str, LinearForm] | None = None,
) -> dict[str, tuple[Term, ...]]:
    """Return the terms of each result, each with its number of roundings.

    Only of results that are used further on: those whose rounding is their own, the outputs and the
    next states. Of a result with a rounding of its own, the operations after it take the rounded
    value, with what `errors` adds to it. A product with a coefficient of the law that is zero or
    one is exact; `numbers` stand in the place of coefficients, with the same roundings.

    The rounding of an angle counts apart, in proportion to the largest angle. Where the angle is
    used within the step, it counts with the rounded terms in it besides: nobody has to know how
    large angles get.
    """
    replacements, off, terms = numbers or {}, errors or {}, dict[str, tuple[Term, ...]]()
    size = len(next(iter(inputs.values())))
    for value in law.values:
        count = int(value.rounding == "term")
        terms[value.name] = (Term(value.symbol, inputs[value.name], count),)
    results: dict[str, tuple[Term, ...]] = {}
    targets = {*law.outputs.values(), *law.following.values()}
    for operation in law.operations:
        found = _terms(law, mode, operation, terms, replacements)
        if operation.rounding == "own" or operation.name in targets:
            results[operation.name] = found
        if operation.rounding == "own":
            forms = [zero(size), *(term.form for term in found)]
            forms += [off[operation.name]] if operation.name in off else []
            found = (Term(operation.symbol, combine(*((ONE, form) for form in forms)), 0),)
        terms[operation.name] = found
    return results


def _terms(
    law: StepLaw,
    mode: int,
    operation: Operation,
    terms: Mapping[str, tuple[Term, ...]],
    numbers: Mapping[str, Fraction],
) -> tuple[Term, ...]:
    right = terms[operation.second]
    if operation.kind == "saturate":
        return right
    if operation.kind == "multiply":
        coefficient = law.coefficient[operation.first]
        factor = coefficient.number(mode)
        if factor in (0, 1):
            # Both products are exact.
            return right if factor else ()
        factor = numbers.get(operation.first, factor)
        return tuple(term.times(factor, f"{coefficient.mode_symbol(mode)} ", 1) for term in right)
    add, left = operation.kind == "add", terms[operation.first]
    sign = ONE if add else -ONE
    if not left or not right:
        # A sum with zero is exact.
        return left or tuple(term.times(sign, "", 0) for term in right)
    summands = (*left, *(term.times(sign, "", 0) for term in right))
    is_angle = operation.rounding == "angle"
    added = int(not is_angle)
    if any(term.roundings for term in summands):
        rounds_again = is_angle and operation.name not in law.following.values()
        return tuple(
            t.times(ONE, "", int(t.roundings > 0) if rounds_again else added) for t in summands
        )
    # Both operands are exact, so the rounding error is proportional to the sum: one term.
    names = [" + ".join(term.name for term in side) for side in (left, right)]
    name = operation.symbol or f"({names[0]} {'+' if add else '-'} {names[1]})"
    return (Term(name, combine(*((ONE, term.form) for term in summands)), added),)


def check_range(law: StepLaw) -> None:
    """Refuse a law that can leave single precision within the limits of its values."""
    bounds = {value.name: value.limit for value in law.values}
    bounds |= {c.name: max(map(abs, c.values)) for c in law.coefficients}
    found = law.read(bounds, _BOUNDS)
    for operation in law.operations:
        if found[operation.name] >= LARGEST:
            raise DesignError(
                f"{operation.name} of the law may be beyond single precision",
                remedy="choose smaller gains, or other units",
            )


_BOUNDS: Mapping[Kind, Callable[[Fraction, Fraction], Fraction]] = {
    "add": lambda left, right: (left + right) * SLACK,
    "subtract": lambda left, right: (left + right) * SLACK,
    "multiply": lambda left, right: left * right * SLACK,
    "saturate": min,
}


def counted_terms(
    law: StepLaw, mode: int, inputs: Mapping[str, LinearForm]
) -> dict[str, dict[str, int]]:
    """Return for each result of `rounded_terms` how often its terms are rounded, by name.

    A difference with a rounding of its own, of terms that are rounded themselves, counts twice:
    with them, and as a whole. So what is subtracted exactly needs no rounding of its own.
    """
    found: dict[str, dict[str, int]] = {}
    symbols = {
        o.name: o.symbol for o in law.operations if o.rounding == "own" and o.kind != "multiply"
    }
    for name, terms in rounded_terms(law, mode, inputs).items():
        counts = {t.name: t.roundings for t in terms if t.roundings and any(t.form)}
        if name in symbols and symbols[name] not in counts:
            # One rounding is that of the difference itself.
            earlier = {term: count for term, count in counts.items() if count > 1}
            counts = {symbols[name]: 1} | earlier
        found[name] = counts
    return found
