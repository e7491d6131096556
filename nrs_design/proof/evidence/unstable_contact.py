"""A motion that grows while contact is lost and made as the motion itself says."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar, Self

from nrs_design.proof.bounds import at_least
from nrs_design.proof.clock import keeps_turns
from nrs_design.proof.contact import Flights
from nrs_design.proof.enclosure import balls, eigenvector, precision
from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows
from nrs_design.proof.evidence.fields import read_integer, read_ratio, read_text
from nrs_design.proof.evidence.unstable_mode import UnstableMode
from nrs_design.proof.evidence.unstable_period import UnstablePeriod
from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Switching
from nrs_design.proof.system import SwitchedSystem

MAX_STEPS = 1024
MAX_WORK = 5_000_000
# A factor that is known to more digits makes no better witness.
MAX_DENOMINATOR = 2**1024


@dataclass(frozen=True, slots=True)
class UnstableContact(AbstractEvidence):
    """A closed sequence of contact and flight has an eigenvector that grows and keeps its signs.

    M is the product of the matrices along the sequence. It has a real eigenvalue between the two
    numbers of `factor`, of which the lower one is not below 1 (continuous time: not below 0): the
    characteristic polynomial p changes its sign between them. With its coefficients,
    ``v(z) = adj(z I - M) u`` is a polynomial in z with ``(z I - M) v(z) = p(z) u``, so that v is an
    eigenvector where p is zero, if it is not zero. It is enclosed for all z between the two
    numbers. Along the sequence, v (or -v) has a positive deflection and positive forces wherever
    the environment acts, and elsewhere a negative deflection, or forces that would all pull. So
    the motion from v repeats itself, larger by that factor, for ever; contact is lost and made
    where that motion loses and makes it. Not all of v is negative deflection at rest, of which the
    factor would be one.

    In continuous time the sequence is one mode: along an eigenvector no sign ever changes.
    """

    kind: ClassVar[str] = "unstable-contact"
    covers_lost_contact: ClassVar[bool] = True
    covers_clock: ClassVar[bool] = True

    # Modes, of contact and free, each with its number of steps, in order. In continuous time one
    # mode, and the number one.
    steps: tuple[tuple[str, int], ...]
    # Numbers between which the eigenvalue is; in continuous time in 1/s.
    factor: tuple[Fraction, Fraction]

    @property
    def shows(self) -> Shows:
        """Instability."""
        return Shows.INSTABILITY

    @property
    def used(self) -> frozenset[str]:
        """The modes of the sequence."""
        return frozenset(name for name, _ in self.steps)

    def fits(self, switching: Switching) -> bool:
        """Tell whether the rules let the modes follow each other so, and no switch resets."""
        if len(self.steps) == 1:
            return UnstableMode(self.steps[0][0], "").fits(switching)
        steps = tuple((name, Fraction(count)) for name, count in self.steps)
        return not switching.resets and UnstablePeriod(steps, 0).fits(switching)

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check the sequence, and that what it makes of the eigenvector grows and keeps signs."""
        low, high = self.factor
        if not system.is_losable:
            return "the system does not ask for the loss of contact to be covered"
        if any(count < 1 for _, count in self.steps) or not 1 <= self.length <= MAX_STEPS:
            return "the sequence is empty or too long"
        if self.length * system.order**3 > MAX_WORK:
            return "the sequence is too long for so many states"
        if not self.used <= {mode.name for mode in in_contact_and_free(system)}:
            return "the sequence uses modes that do not exist"
        if system.time is Time.CONTINUOUS and self.length != 1:
            return "in continuous time the sequence is one mode"
        if system.clock is not None and not keeps_turns(
            system.clock, [(name, Fraction(count)) for name, count in self.steps]
        ):
            return "a mode is in force when it is not its turn"
        if not (1 if system.time is Time.DISCRETE else 0) <= low < high:
            return "the factor is not beyond the limit of stability"
        if max(low.denominator, high.denominator) > MAX_DENOMINATOR:
            return "the factor has too many digits"
        if not grows(system, self.steps, self.factor):
            return "the enclosure does not show a growing motion that keeps the signs of contact"
        return None

    @property
    def length(self) -> int:
        """Number of steps of the sequence."""
        return sum(count for _, count in self.steps)

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield nothing: no matrix has to be positive definite."""
        yield from ()

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the sequence and what follows."""
        law = "x' = A x" if system.time is Time.CONTINUOUS else "x+ = A x"
        growth = at_least(self.factor[0], "1/s" if system.time is Time.CONTINUOUS else "")
        signs = (
            "Wherever the environment acts, the deflection is positive along it and nothing pulls, "
            f"and elsewhere it is not, so contact is lost and made as that motion says, and {law} "
            "is unstable with contact that may be lost."
        )
        if self.length == 1:
            name = self.steps[0][0]
            return f"Mode {name} has a real eigenvalue {growth}, and a motion along it. {signs}"
        signal = ", ".join(f"{name} for {count} steps" for name, count in self.steps)
        return (
            f"Repeating the sequence ({signal}) makes some motion larger by a factor {growth} each "
            f"time. {signs}"
        )

    def to_fields(self) -> dict[str, Any]:
        """Return the sequence and the two numbers."""
        return {
            "steps": [[name, count] for name, count in self.steps],
            "factor": [str(number) for number in self.factor],
        }

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read the sequence and the two numbers."""
        steps = tuple((read_text(name), read_integer(count)) for name, count in fields["steps"])
        low, high = map(read_ratio, fields["factor"])
        return cls(steps, (low, high))


def in_contact_and_free(system: SwitchedSystem) -> tuple[Mode, ...]:
    """Return the modes of a system in contact and free."""
    return (*system.modes, *(() if system.contact is None else system.contact.free))


def grows(
    system: SwitchedSystem, steps: tuple[tuple[str, int], ...], factor: tuple[Fraction, Fraction]
) -> bool:
    """TRUSTED: decide whether an eigenvector with such a factor and the signs is certain.

    Parameters
    ----------
    system : SwitchedSystem
        The modes, and how contact is lost.
    steps : tuple of (str, int)
        The sequence.
    factor : (Fraction, Fraction)
        Between which the eigenvalue must be, the lower one first.
    """
    with precision():
        matrices = _matrices(system, steps)
        v = eigenvector(product(system, steps), *factor)
        turned = set() if v is None else {False, True}
        for name, count in steps:
            for _ in range(count if turned else 0):
                turned &= _signs(system, name, v)
                v = matrices[name] * v
        return bool(turned)


def product(system: SwitchedSystem, steps: tuple[tuple[str, int], ...]) -> Any:
    """TRUSTED: enclose the matrix of a sequence, at flint's current precision.

    Parameters
    ----------
    system, steps
        As for `grows`.
    """
    matrices = _matrices(system, steps)
    first, *others = (matrices[name] for name, count in steps for _ in range(count))
    for A in others:
        first = A * first
    return first


def _matrices(system: SwitchedSystem, steps: tuple[tuple[str, int], ...]) -> dict[str, Any]:
    used = {name for name, _ in steps}
    return {mode.name: balls(mode.A) for mode in in_contact_and_free(system) if mode.name in used}


def _signs(system: SwitchedSystem, mode: str, v: Any) -> set[bool]:
    """TRUSTED: return for which of v (False) and -v (True) a mode may be in force."""
    contact = system.contact
    if contact is not None:
        flights = Flights(tuple(m.name for m in system.modes), tuple(m.name for m in contact.free))
        pulls = contact.pulls
    else:
        assert system.flights is not None
        flights, pulls = system.flights, system.flights.pulls
    delta = v[system.order - 1, 0]
    forces = [(balls(row) * v)[0, 0] for row in pulls]
    if mode in flights.touching:
        felt = [delta, *forces]
        return {turned for turned in (False, True) if all(_is_positive(f, turned) for f in felt)}
    if mode in flights.flying:
        return {
            turned
            for turned in (False, True)
            if _is_positive(delta, not turned)
            or (forces and all(_is_positive(force, not turned) for force in forces))
        }
    return {False, True}


def _is_positive(ball: Any, turned: bool) -> bool:
    """Tell whether a number, or its negative, is certainly positive."""
    return bool(ball < 0) if turned else bool(ball > 0)
