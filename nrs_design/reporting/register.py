"""The assumptions of a system as a register: bound, consequence if false, and test of each.

The catalogue of certificates has them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from nrs_design.certificates.catalogue import (
    AssumptionKind,
    Standing,
    bound_of,
    catalogue_kind,
    sentence,
)
from nrs_design.proof.assumption import Assumption
from nrs_design.spec import InteractionDesignSpec

if TYPE_CHECKING:
    from nrs_design.spec import Spec


@dataclass(frozen=True, slots=True)
class Entry:
    """One thing that a certificate takes for granted."""

    statement: str  # In words
    kind: AssumptionKind  # What breaks if it is false, and how to test it
    bound: str  # Within what it must hold
    # Tested by records that the spec names, argued from how the product is made, or open.
    standing: Standing


def register_of(granted: Iterable[Assumption], spec: Spec | None = None) -> tuple[Entry, ...]:
    """Return the register of assumptions, in order.

    Motor and environments count as tested where the spec names measured records that they were
    identified from, and no doubt.
    """
    tested = frozenset(_tested(spec)) if isinstance(spec, InteractionDesignSpec) else frozenset()
    return tuple(_entry(assumption, tested) for assumption in granted)


def _entry(assumption: Assumption, tested: frozenset[str]) -> Entry:
    kind = catalogue_kind(assumption)
    standing = Standing.TESTED if kind.id in tested else kind.standing
    return Entry(sentence(assumption), kind, bound_of(assumption), standing)


def _tested(spec: InteractionDesignSpec) -> Iterator[str]:
    measured = {
        at[-1]
        for at, item in spec.identified.items()
        if item.provenance
        and all(source.data == "measured" for source in item.provenance)
        and not item.doubts
    }
    if "actuator" in measured:
        yield from ("motor", "nominal-motor")
    if spec.touched and measured.issuperset(spec.touched):
        yield "tissue"
