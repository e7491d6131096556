"""A value of a constant parameter at which the system is not stable."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar, Self

from nrs_design.proof.constant import system_at
from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows
from nrs_design.proof.evidence.fields import read_ratio
from nrs_design.proof.evidence.unstable_mixture import UnstableMixture
from nrs_design.proof.evidence.unstable_mode import UnstableMode
from nrs_design.proof.evidence.unstable_period import UnstablePeriod
from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.switching import Switching
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import exact_text

Part = UnstableMode | UnstableMixture | UnstablePeriod
PARTS: tuple[type[Part], ...] = (UnstableMode, UnstableMixture, UnstablePeriod)
# Longer shares make no better values, only longer computations.
MAX_DENOMINATOR = 2**64


@dataclass(frozen=True, slots=True)
class UnstableValue(AbstractEvidence):
    """At one value in its range, a parameter that is unknown but constant makes modes unstable.

    The mode in force is ``(1 - s) low + s high`` with one share s for all modes and all times.
    Each share from 0 to 1 is a value that the parameter may have, so instability of the system at
    one share refutes the claim for all of them.
    """

    kind: ClassVar[str] = "unstable-value"

    share: Fraction  # The s
    part: Part  # Evidence of instability of the system at that share

    @property
    def shows(self) -> Shows:
        """Instability."""
        return Shows.INSTABILITY

    def fits(self, switching: Switching) -> bool:
        """Tell whether there is a constant parameter; one mode alone meets no reset."""
        return bool(switching.fixed_ends) and (
            not switching.resets or self.part.names_unstable_mode
        )

    def used_matrices(self, system: SwitchedSystem) -> list[RationalMatrix]:
        """Return the matrices of the part, at that value."""
        return self.part.used_matrices(system_at(system, self.share))

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check the share, and the part at that share."""
        if not _is_share(self.share):
            return "the share is not between 0 and 1, or has too many digits"
        if type(self.part) not in PARTS:
            return "the part is not of a kind that shows instability"
        return self.part.find_fault(system_at(system, self.share))

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield nothing: no matrix has to be positive definite."""
        yield from ()

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the value and what happens there."""
        return (
            f"{value_text(system, self.share)}, which the range allows and which does not change: "
            f"{self.part.claim(system_at(system, self.share))}"
        )

    def to_fields(self) -> dict[str, Any]:
        """Return the share and the fields of the part."""
        part = {"kind": self.part.kind, **self.part.to_fields()}
        return {"share": str(self.share), "part": part}

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read the share, and the part as evidence about the system at that share."""
        share = read_ratio(fields["share"])
        if not _is_share(share) or not system.switching.fixed_ends:
            raise ValueError("the share is out of bounds, or no parameter is constant")
        at_share = system_at(system, share)
        for kind in PARTS:
            if kind.kind == fields["part"]["kind"]:
                return cls(share, kind.from_fields(fields["part"], at_share))
        raise ValueError("the part is not of a kind that shows instability")


def _is_share(share: Fraction) -> bool:
    return 0 <= share <= 1 and share.denominator <= MAX_DENOMINATOR


def value_text(system: SwitchedSystem, share: Fraction) -> str:
    """Say which value of the constant parameter it is, such as ``At k = 12.5``."""
    parameter = system.switching.fixed_parameter
    if parameter is None:
        return f"At {share} of the way from the low to the high end of the parameter"
    value = parameter.low + share * (parameter.high - parameter.low)
    return f"At {parameter.name} = {exact_text(value)}"
