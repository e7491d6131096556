"""How far the search for a proof goes, as far as a spec says it."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, WithJsonSchema

from nrs_design.spec import kinds
from nrs_design.spec.faults import fault
from nrs_design.spec.fields import read_exact
from nrs_design.spec.model import ReadBy, SpecModel
from nrs_design.spec.quantity import Quantity
from nrs_design.spec.quantity_fields import quantity_schema, read_quantity

HIGHEST_DEGREE = 64
# A spec may come from anyone: who runs the command may allow more, the spec may not.
LONGEST_BUDGET = 600
_DEGREE_SCHEMA: dict[str, Any] = {"type": "integer", "minimum": 2, "maximum": HIGHEST_DEGREE}


def _read_degree(value: object) -> int:
    number = read_exact(value)
    if number.denominator != 1 or number % 2 or not 2 <= number <= HIGHEST_DEGREE:
        raise fault(
            f"{value} is not an even integer from 2 to {HIGHEST_DEGREE}",
            "a positive form has an even degree",
        )
    return int(number)


def _read_budget(value: object) -> Quantity:
    budget = read_quantity(value, kinds.SEARCH_BUDGET, positive=True)
    if budget.exact > LONGEST_BUDGET:
        raise fault(
            f"{budget.text!r} is beyond {LONGEST_BUDGET} s",
            "write less here; the option --budget allows more",
        )
    return budget


class CertificationSpec(SpecModel):
    """How far the search for a proof goes; options of the commands override it."""

    max_degree: Annotated[int | None, ReadBy(_read_degree), WithJsonSchema(_DEGREE_SCHEMA)] = Field(
        default=None,
        description="highest degree of a polynomial Lyapunov function, even, at most 64; default: "
        "as high as the budget allows",
    )
    budget: Annotated[
        Quantity | None,
        ReadBy(_read_budget),
        WithJsonSchema(quantity_schema(kinds.SEARCH_BUDGET)),
    ] = Field(
        default=None, description="time for the search, at most 600 s; default 60 s, such as '30 s'"
    )
