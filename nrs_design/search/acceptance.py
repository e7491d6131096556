"""Candidates of a search, and their acceptance by the exact check."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable
from dataclasses import dataclass
from time import perf_counter
from typing import Generic, TypeVar

from numpy.linalg import LinAlgError

from nrs_design.errors import InternalError
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.exact import IntegerMatrix, TooLargeError, bit_length
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.certification import Attempt
from nrs_design.search.family import Family, floats_in_silence
from nrs_design.search.work import Allowance, NotAffordableError

# Work of a check per candidate, per form, per form for which stays are enclosed anew, per product
# of entries, and per product and square of bits.
PER_CANDIDATE, PER_FORM, PER_ENCLOSED_FORM = 1e-3, 1e-4, 5e-4
PER_PRODUCT, PER_SQUARED_BITS = 1.5e-7, 2e-13
# The end of a search that had a solution, but no rate to claim for it.
NO_RATE = "what was found shows no rate of decay"
NO_MARGIN = "the solver found no solution with positive margins"
OUT_OF_RANGE = "the modes are beyond the range of floating point"

E = TypeVar("E", bound=AbstractEvidence, covariant=True)


@dataclass(frozen=True, slots=True)
class Candidate(Generic[E]):
    """Proposed evidence, and the outcome that is reported if the exact check accepts it."""

    evidence: E
    words: str = "found"


# Candidates, the best first. The generator returns the reason for a failure; None stands for the
# reason of the exact check.
Candidates = Generator[Candidate[E], None, str | None]
Search = Callable[[Family], Candidates[AbstractEvidence]]


def take_candidate(
    search: Callable[[], Candidates[E]], system: SwitchedSystem, allowance: Allowance
) -> tuple[E | None, str]:
    """Make one search; without a result if floating point fails or the budget does not suffice."""
    try:
        with floats_in_silence():
            return first_accepted(search(), system, allowance)
    except TooLargeError as error:
        return None, f"not tried: {error}"
    except NotAffordableError as reason:
        return None, str(reason)
    except (LinAlgError, ArithmeticError) as error:
        return None, f"floating point failed ({error})"


def first_accepted(
    candidates: Candidates[E], system: SwitchedSystem, allowance: Allowance | None = None
) -> tuple[E | None, str]:
    """Return the first candidate that the exact check accepts, and the outcome as text.

    Nothing becomes evidence but here, or from evidence that was accepted here. No more candidates
    than needed are asked for. Checks are charged to the allowance; none is left out for it.
    """
    allowance = allowance or Allowance()
    fault: str | None = None
    while True:
        try:
            candidate = next(candidates)
        except StopIteration as end:
            refused = f"a candidate was found, but {fault}" if fault else NO_RATE
            return None, end.value or refused
        checked_forms: list[IntegerMatrix] = []
        fault = candidate.evidence.find_fault(system, checked_forms)
        # Evidence with enclosed stays has a number of pieces.
        encloses = getattr(getattr(candidate.evidence, "stays", None), "pieces", 1) > 1
        work_per_form = PER_ENCLOSED_FORM if encloses else PER_FORM
        products = (
            len(M) ** 3 * (PER_PRODUCT + PER_SQUARED_BITS * bit_length(M) ** 2)
            for M in checked_forms
        )
        allowance.charge(PER_CANDIDATE + work_per_form * len(checked_forms) + sum(products))
        if fault is None:
            return candidate.evidence, candidate.words


def attempted(
    name: str,
    search: Callable[[], Candidates[AbstractEvidence]],
    system: SwitchedSystem,
    allowance: Allowance,
) -> tuple[AbstractEvidence | None, Attempt]:
    """Take the first candidate that holds, and say how it went."""
    start, before = perf_counter(), allowance.charged
    evidence, outcome = take_candidate(search, system, allowance)
    return evidence, Attempt(name, outcome, perf_counter() - start, allowance.charged - before)


def check_again(statements: Iterable[AbstractEvidence], system: SwitchedSystem) -> None:
    """Check evidence that was put together from evidence for fewer modes or states."""
    for statement in statements:
        if fault := statement.find_fault(system):
            raise InternalError(f"the search returned evidence that does not hold: {fault}")
