"""Limits of the search for a proof that a spec may give."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated

from pydantic import Field

from nrs_design.spec.faults import fault
from nrs_design.spec.fields import read_exact
from nrs_design.spec.model import ParsedBy, SpecModel, optional

HIGHEST_DEGREE = 64
# A spec may come from anyone: who runs the command may allow more, the spec may not.
LARGEST_BUDGET = 600
_BUDGET_SCHEMA = {"type": "number", "exclusiveMinimum": 0, "maximum": LARGEST_BUDGET}
_DEGREE_SCHEMA = {"type": "integer", "minimum": 2, "maximum": HIGHEST_DEGREE}


def _read_degree(value: object) -> int:
    number = read_exact(value)
    if number.denominator != 1 or number % 2 or not 2 <= number <= HIGHEST_DEGREE:
        raise fault(
            f"{value} is not an even integer from 2 to {HIGHEST_DEGREE}",
            "a positive form has an even degree",
        )
    return int(number)


def _read_budget(value: object) -> Fraction:
    budget = read_exact(value)
    if not 0 < budget <= LARGEST_BUDGET:
        raise fault(
            f"{value} is not above 0 and at most {LARGEST_BUDGET}",
            "write such a number here; the option --budget allows more",
        )
    return budget


class CertificationSpec(SpecModel, stronger="beside"):
    """Limits of the search for a proof; options of the commands override them."""

    max_degree: Annotated[int | None, ParsedBy(_read_degree, _DEGREE_SCHEMA)] = optional(
        "highest degree of a polynomial Lyapunov function: even, at most 64; default: by the budget"
    )
    budget: Annotated[Fraction | None, ParsedBy(_read_budget, _BUDGET_SCHEMA)] = optional(
        "work of the search in units of about a second; at most 600, default 60"
    )


# The default is made without validation, for which a validator of its own would be built.
SearchExtent = Annotated[
    CertificationSpec,
    Field(
        default_factory=CertificationSpec.model_construct,
        description="how far the search for a proof goes",
    ),
]
