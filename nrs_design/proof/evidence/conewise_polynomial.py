"""One homogeneous polynomial for all modes and for free motion, while contact comes and goes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, ClassVar, Self

from nrs_design.proof.contact import Contact
from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows
from nrs_design.proof.evidence.common_polynomial import CommonPolynomial
from nrs_design.proof.evidence.conewise_quadratic import NO_CONTACT
from nrs_design.proof.evidence.fields import Matrix, rate_words, read_integers
from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.lift import monomials
from nrs_design.proof.matrix import RationalMatrix, leading
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import counted


@dataclass(frozen=True, slots=True)
class ConewisePolynomial(AbstractEvidence):
    """``V(w)`` of degree 2d decreases in contact and free, with ``w = (y, max(delta, 0))``.

    In contact V is a common polynomial of the modes, free it is the same with delta at zero: a
    common polynomial of the free modes in y alone, whose Gram matrix is the block of Q that belongs
    to the monomials without delta. It is continuous where the two meet. For continuous time, and
    for springs: an environment with damping, which could pull, is not covered.
    """

    kind: ClassVar[str] = "conewise-polynomial"
    bounds_at_once: ClassVar[bool] = True
    attains_rate: ClassVar[bool] = True
    covers_mixtures: ClassVar[bool] = True
    covers_lost_contact: ClassVar[bool] = True

    in_contact: CommonPolynomial  # For the modes in contact, with the rate that is claimed
    # For each free mode, a form in the monomials of y that vanishes, as in `CommonPolynomial`.
    vanishing_free: tuple[Matrix, ...]

    @property
    def shows(self) -> Shows:
        """Stability."""
        return Shows.STABILITY

    def proved_rate(self, system: SwitchedSystem) -> Fraction:
        """Return the claimed rate, in contact and free."""
        return self.in_contact.rate

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check that contact can be lost, and each of the two functions for itself."""
        if system.contact is None:
            return NO_CONTACT
        if system.time is not Time.CONTINUOUS:
            return "a polynomial for contact and free motion is for continuous time"
        if system.contact.pulls:
            return "a polynomial does not cover an environment that could pull"
        if (misfit := self.in_contact.find_misfit(system)) is not None:
            return misfit
        return self._in_flight(system.order).find_misfit(flight(system, system.contact))

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield Q and its block, and the decrease in contact and free."""
        assert system.contact is not None  # find_misfit
        yield from self.in_contact.forms(system)
        yield from self._in_flight(system.order).forms(flight(system, system.contact))

    def _in_flight(self, order: int) -> CommonPolynomial:
        """Return V with the deflection at zero."""
        kept, Q = without_last(order, self.in_contact.degree), self.in_contact.Q
        block = tuple(tuple(Q[i][j] for j in kept) for i in kept)
        return replace(self.in_contact, Q=block, vanishing=self.vanishing_free)

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the bound on every solution, with contact or without."""
        assert system.contact is not None  # find_misfit
        degree, modes = 2 * self.in_contact.degree, len(system.modes)
        rate = rate_words(self.in_contact.rate, system.time)
        return (
            "Every solution, with contact lost and made again at any time and switching "
            f"arbitrarily among {counted(modes, 'mode')} in contact and "
            f"{counted(len(system.contact.free), 'mode')} of free motion, satisfies "
            f"|w(t)| <= exp(-alpha t) |w(0)| with {rate}, where w holds the states other than "
            "the deflection, and the deflection where it is positive, "
            f"and |w|^{degree} is a positive definite form of degree {degree} in w. Where free "
            "motion ends is not claimed."
        )

    def spread(self, merged: SwitchedSystem, system: SwitchedSystem) -> Self:
        """Repeat the vanishing form of every mode in contact for its equals."""
        return replace(self, in_contact=self.in_contact.spread(merged, system))

    def to_fields(self) -> dict[str, Any]:
        """Return the polynomial in contact, and the vanishing forms of free motion."""
        free = [[list(row) for row in N] for N in self.vanishing_free]
        return {**self.in_contact.to_fields(), "vanishing_free": free}

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read the polynomial and the vanishing forms; they say nothing without loss of contact."""
        if system.contact is None:
            raise ValueError(NO_CONTACT)
        free = tuple(read_integers(N) for N in fields["vanishing_free"])
        return cls(CommonPolynomial.from_fields(fields, system), free)


def without_last(order: int, degree: int) -> tuple[int, ...]:
    """Return which monomials of a degree lack the last state: in order, all those of the others.

    Parameters
    ----------
    order : int
        Number of states.
    degree : int
        Of the monomials.
    """
    return tuple(k for k, term in enumerate(monomials(order, degree)) if term[-1] == 0)


def flight(system: SwitchedSystem, contact: Contact) -> SwitchedSystem:
    """TRUSTED: return the free modes as a family of its own, in all states but the deflection.

    Parameters
    ----------
    system : SwitchedSystem
        In which contact is lost.
    contact : Contact
        How it is lost.
    """
    modes = tuple(
        Mode(mode.name, RationalMatrix(tuple(leading(mode.A.numerators)), mode.A.denominator))
        for mode in contact.free
    )
    return system.with_modes(modes, system.states[:-1], system.switching)
