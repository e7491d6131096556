"""Abstract evidence: its check, its words, and its fields in a certificate."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from typing import Any, ClassVar, Self

from nrs_design.proof.bounds import at_least
from nrs_design.proof.channels import Channel, Output
from nrs_design.proof.contradiction import find_contradiction
from nrs_design.proof.evidence.fields import MAX_INTEGER_BITS, find_unreadable, read_object, written
from nrs_design.proof.exact import IntegerMatrix, is_positive_definite, is_symmetric, is_too_large
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Switching
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import exact_text

PULLING = ", the environment pulling as it pushes"
ROUNDED = "What single-precision arithmetic rounds in the law is included."
NOT_ROUNDED = "This holds for the law computed without rounding."
GROWN_WITHOUT_ROUNDING = "The instability is proved for exact arithmetic."
GROWN_THROUGHOUT = (
    "No corner of an enclosure need be attained: the growth is that of all maps between its "
    "corners."
)
# Scope in a few words, beside a verdict that leaves the loss of contact open.
IN_KEPT_CONTACT = "in kept contact"
AT_ANY_DEFLECTION = "where contact is lost and made at any deflection"


# Fields of a statement beside its numbers.
_OF_A_STATEMENT = frozenset({"kind", "block"})


class Shows(StrEnum):
    """What follows if the evidence holds."""

    STABILITY = "stability"
    INSTABILITY = "instability"
    INSTABILITY_IN_CONTACT = "instability if the environment pulled"
    NO_COMMON_QUADRATIC = "no common quadratic function"
    BOUND = "a bound on an output"
    REGION = "decay from a region under saturation"

    @property
    def is_good(self) -> bool:
        """Whether the conclusion is about every motion, not about one that grows."""
        goods = (Shows.STABILITY, Shows.BOUND, Shows.REGION)
        return self in goods


@dataclass(frozen=True, slots=True)
class Bound:
    """What evidence of a bound says, in numbers."""

    output: Output  # What is bounded
    level: Fraction  # Its size is never above this, from rest
    channels: tuple[Channel, ...]  # The disturbances that act at once; no other does
    share: Fraction  # How fast what is left of an earlier state goes: in 1/s, or per step


class AbstractEvidence(ABC):
    """Numbers that prove a statement about a switched system.

    A kind of evidence is a set of conditions on integers: its shape (`find_misfit`) and symmetric
    integer matrices that must be positive definite (`forms`). Both are computed from the system,
    so that evidence for one system is no evidence for another.
    """

    kind: ClassVar[str]

    @property
    @abstractmethod
    def shows(self) -> Shows:
        """Conclusion of the evidence."""

    @property
    def allows_unequal_modes(self) -> bool:
        """Whether modes may have different numbers of states."""
        return False

    @property
    def bounds_at_once(self) -> bool:
        """Whether its bound has no constant factor in front."""
        return False

    @property
    def attains_rate(self) -> bool:
        """Whether the claim holds at the proved rate itself, not only at slower rates."""
        return False

    @property
    def covers_mixtures(self) -> bool:
        """Whether the conclusion covers convex combinations of the modes."""
        return False

    @property
    def covers_lost_contact(self) -> bool:
        """Whether it holds while contact is lost and made, where the system says how.

        Ask `covers_loss` of evidence of instability, which may be that of free motion alone.
        """
        return False

    @property
    def covers_clock(self) -> bool:
        """Whether the conclusion covers scheduled modes."""
        return False

    @property
    def is_common_quadratic(self) -> bool:
        """Whether there is a common quadratic function, or one for every diagonal block."""
        return False

    @property
    def covers_rounding(self) -> bool:
        """Whether the conclusion covers the rounding errors of the system."""
        return False

    @property
    def keeps_bound_in_mixtures(self) -> bool:
        """Whether convex combinations of modes get no further constant factor in discrete time."""
        return False

    @property
    def names_unstable_mode(self) -> bool:
        """Whether the evidence names a mode that is not stable."""
        return False

    @property
    def used(self) -> frozenset[str] | None:
        """Names of the modes that a motion which grows is in; None if that may be any of them."""
        return None

    def covers_loss(self, system: SwitchedSystem) -> bool:
        """TRUSTED: tell whether it holds for contact as the system says that it is lost and made.

        What grows in modes that are the same in contact and free does.
        """
        if system.flights is None or self.used is None:
            return self.covers_lost_contact
        felt = {*system.flights.touching, *system.flights.flying}
        return self.covers_lost_contact or not self.used & felt

    def is_of_modes(self, system: SwitchedSystem) -> bool:
        """Tell whether it is about the modes of a system, none of `Contact.free` among them."""
        return self.used is None or self.used <= {mode.name for mode in system.modes}

    def shown(self, system: SwitchedSystem) -> Shows:
        """TRUSTED: say what follows for a system if it holds.

        Growth for which the environment would have to pull refutes nothing where contact is lost.
        """
        if self.shows is Shows.INSTABILITY and system.is_losable and not self.covers_loss(system):
            return Shows.INSTABILITY_IN_CONTACT
        return self.shows

    @property
    def quadratic(self) -> tuple[IntegerMatrix, int] | None:
        """The Q of one quadratic function in contact: numerators over two to a power; or None."""
        return None

    @property
    def start_size(self) -> Fraction | None:
        """Size of the start of a saturating system that motions decay from, if it shows one."""
        return None

    def start_rate(self, system: SwitchedSystem) -> Fraction | None:
        """Return the rate in 1/s at which they decay, if it shows one; others may not decay."""
        return None

    def proved_rate(self, system: SwitchedSystem) -> Fraction | None:
        """Return the rate of decay (alpha in 1/s, or rho per step), if it shows one."""
        return None

    def bound(self, system: SwitchedSystem) -> Bound | None:
        """Return the bound on an output, if it shows one."""
        return None

    @abstractmethod
    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Say why the evidence cannot belong to the system, or None."""

    @abstractmethod
    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield what must be positive definite, each with the name of its failure."""

    def claim(self, system: SwitchedSystem) -> str:
        """Say in words what is shown, how fast in seconds, and what it takes for granted."""
        said, rate = [self.claim_in_scope(system)], self.proved_rate(system)
        if system.sample_time is not None and rate is not None:
            said.append(in_seconds(rate, system.sample_time))
        said += self._said_of_contact(system)
        if system.roundings and self.covers_rounding:
            said.append(ROUNDED)
        elif system.roundings and self.shows.is_good:
            said.append(NOT_ROUNDED)
        elif system.roundings and self.shows is Shows.INSTABILITY:
            said.append(GROWN_WITHOUT_ROUNDING)
        if system.enclosures and self.shows is Shows.INSTABILITY:
            said.append(GROWN_THROUGHOUT)
        return " ".join(said)

    def _said_of_contact(self, system: SwitchedSystem) -> Iterator[str]:
        """Say for which contact it holds, where that is not the one that the system describes."""
        pulling = PULLING if self._is_pulled(system) else ""
        if self.shows is Shows.INSTABILITY and not self.covers_loss(system):
            if system.flights is not None:
                said = "This growth is that of contact that is lost and made at any deflection"
                yield f"{said}{pulling}."
            elif system.contact is not None:
                yield f"This growth is that in kept contact{pulling}."
        elif self.shows.is_good and system.contact is not None and not self.covers_lost_contact:
            yield f"This holds as long as contact is kept{pulling}."

    def _is_pulled(self, system: SwitchedSystem) -> bool:
        """Tell whether the environment acts in a mode of it, which is then none of free motion."""
        if system.flights is not None:
            flying = frozenset(system.flights.flying)
            free = [mode.A for mode in system.modes if mode.name in flying]
        else:
            free = [mode.A for mode in system.free]
        return any(A not in free for A in self.used_matrices(system))

    def used_matrices(self, system: SwitchedSystem) -> list[RationalMatrix]:
        """Return the matrices of the modes that it is about."""
        used = self.used
        return [mode.A for mode in system.modes if used is None or mode.name in used]

    @abstractmethod
    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """Say in words what is shown, for the motions that this kind of evidence speaks about."""

    def to_fields(self) -> dict[str, Any]:
        """Return its numbers for the certificate file."""
        fields: dict[str, Any] = written(self)
        return fields

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read its numbers from a certificate file.

        A KeyError, TypeError or ValueError if a field is missing, malformed or unknown, or no
        sentence about the system can be made of them.
        """
        own = {key: value for key, value in fields.items() if key not in _OF_A_STATEMENT}
        evidence = read_object(cls, own)
        if (unsayable := evidence.find_unsayable(system)) is not None:
            raise ValueError(unsayable)
        return evidence

    def find_unsayable(self, system: SwitchedSystem) -> str | None:
        """Say why no claim about the system can be put into words, or None.

        What a claim says is compared before what it rests on is checked.
        """
        return None

    def fits(self, switching: Switching) -> bool:
        """Tell whether the argument covers these switching signals.

        By default: whatever holds under arbitrary switching holds for fewer signals, as long as
        no reset changes the state.
        """
        return not switching.resets

    def spread(self, merged: SwitchedSystem, system: SwitchedSystem) -> AbstractEvidence:
        """Carry evidence over from modes of which no two are equal to all modes of a system.

        By default nothing changes: names of modes stay valid, and what holds for a mode, the first
        of its equals in `merged`, holds for its equals. A kind with numbers for every mode repeats
        them.
        """
        return self

    def find_fault(
        self, system: SwitchedSystem, made: list[IntegerMatrix] | None = None
    ) -> str | None:
        """TRUSTED: say why the evidence does not hold for the system, or None if it holds.

        Every form that is decided is put into `made`, for a second opinion.
        """
        unfit = self.find_unfit(system)
        return find_indefinite(self.forms(system), made) if unfit is None else unfit

    def find_unfit(self, system: SwitchedSystem) -> str | None:
        """TRUSTED: say what, other than a form, keeps the evidence from holding, or None."""
        if not system.modes:
            return "the system has no modes"
        if len({mode.name for mode in system.modes}) < len(system.modes):
            return "two modes of the system have the same name"
        for mode in system.modes:
            if not mode.A.is_well_formed or mode.A.shape[0] != mode.A.shape[1]:
                return f"mode {mode.name} is not a square matrix over a positive denominator"
        if (unreadable := find_unreadable(self)) is not None:
            return unreadable
        if (contradiction := find_contradiction(system)) is not None:
            return contradiction
        if not self.fits(system.switching):
            return f"evidence of kind {self.kind} does not cover this kind of switching"
        if not system.is_uniform and not self.allows_unequal_modes:
            return f"evidence of kind {self.kind} needs modes of equal size"
        loses = system.contact is not None and system.contact.required
        if loses and self.shows.is_good and not self.covers_lost_contact:
            return f"evidence of kind {self.kind} does not cover the loss of contact"
        if system.clock is not None and not self.covers_clock:
            return f"evidence of kind {self.kind} does not know that modes take turns"
        return self.find_misfit(system)


def in_seconds(rate: Fraction, step: Fraction) -> str:
    """Say what a contraction rho per step, below one, is in seconds: ``-log(rho) >= 1 - rho``.

    The step is in s.
    """
    alpha = at_least((1 - rate) / step, "1/s")
    return f"A step takes {exact_text(step)} s, so that is exp(-alpha t) with alpha {alpha}."


def find_indefinite(
    forms: Iterable[tuple[str, IntegerMatrix]], made: list[IntegerMatrix] | None = None
) -> str | None:
    """TRUSTED: name the failure of the first form that is not positive definite, or None."""
    for failure, form in forms:
        if made is not None:
            made.append(form)
        if is_too_large(form):
            return f"{failure}, or it does but its numbers are too large to check"
        if not is_symmetric(form) or not is_positive_definite(form):
            return failure
    return None


class AbstractFunction(AbstractEvidence):
    """Lyapunov functions; the rate is alpha in 1/s, or rho per step, and is itself proved."""

    rate: Fraction

    @property
    def attains_rate(self) -> bool:
        """True: the function decreases at it."""
        return True

    @property
    def shows(self) -> Shows:
        """Stability."""
        return Shows.STABILITY

    def proved_rate(self, system: SwitchedSystem) -> Fraction:
        """Return the claimed rate."""
        return self.rate

    def find_rate_misfit(self, time: Time) -> str | None:
        """Say why the rate is not one of exponential decay, or None."""
        if self.rate <= 0 or (time is Time.DISCRETE and self.rate >= 1):
            return "the claimed rate is not one of exponential decay"
        return None


def find_odd_form(Q: IntegerMatrix, denominator_log2: int, order: int) -> str | None:
    """Say why a form, of numerators over a power of two, does not have its shape, or None."""
    if not is_square(Q, order):
        return f"Q is not a {order} x {order} matrix"
    if not 0 <= denominator_log2 <= MAX_INTEGER_BITS:
        return f"the denominator of Q is not two to a power up to {MAX_INTEGER_BITS}"
    return None


def is_square(M: IntegerMatrix, n: int) -> bool:
    """Tell whether a matrix has n rows and n columns."""
    return len(M) == n and all(len(row) == n for row in M)
