"""The assumptions of a system as a register: bound, consequence if false, and test of each.

An `nrs_design.loop.assumption.Assumption` knows them. One that was read from a certificate is
a plain string, and the register says that they are unknown.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from nrs_design.loop.assumption import Assumption, AssumptionKind, Standing
from nrs_design.spec import InteractionDesignSpec

if TYPE_CHECKING:
    from nrs_design.spec import Spec

_LOST = "not in a certificate; report its spec to know"
_UNKNOWN = AssumptionKind("", "taken for granted", "", "as the sentence says", _LOST, _LOST)


@dataclass(frozen=True, slots=True)
class Entry:
    """One thing that a certificate takes for granted."""

    statement: str  # As the certificate says it
    kind: AssumptionKind  # What breaks if it is false, and how to test it
    bound: str  # Within what it must hold
    # Tested by records that the spec names, argued from how the product is made, or open.
    standing: Standing


def register_of(statements: Iterable[str], spec: Spec | None = None) -> tuple[Entry, ...]:
    """Return the register of assumptions, in order; plain statements (a certificate's) are open.

    Motor and environments count as tested where the spec names measured records that they were
    identified from, and no doubt.
    """
    tested = frozenset(_tested(spec)) if isinstance(spec, InteractionDesignSpec) else frozenset()
    return tuple(_entry(statement, tested) for statement in statements)


def _entry(statement: str, tested: frozenset[str]) -> Entry:
    if not isinstance(statement, Assumption):
        return Entry(statement, _UNKNOWN, _UNKNOWN.within, _UNKNOWN.standing)
    kind = statement.kind
    standing = Standing.TESTED if kind.id in tested else kind.standing
    return Entry(str(statement), kind, statement.bound, standing)


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
