"""A closed sequence of steps along which some motion does not decay."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import lcm
from typing import ClassVar

from nrs_design.proof.bounds import at_least, nearly
from nrs_design.proof.clock import keeps_turns
from nrs_design.proof.constant import find_odd_shares, system_at, value_text
from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows
from nrs_design.proof.evidence.growth import (
    MAX_DOUBLINGS,
    Steps,
    grows_in_contact,
    grows_throughout,
    has_growing_trace,
)
from nrs_design.proof.exact import IntegerMatrix, TooLargeError, common_denominator
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.spectrum import is_stable, worst_eigenvalue
from nrs_design.proof.switching import Switching
from nrs_design.proof.system import SwitchedSystem

MAX_STEPS = 1024
MAX_TIME = 4096
MAX_WORK = 5_000_000
# Longer shares make no better averages and values, only longer computations.
MAX_SHARE_DENOMINATOR = 2**64
# A corner of an enclosure refutes nothing.
UNATTAINED = "no loop of the spec need be there"
# Nor does a factor that is known to more digits.
MAX_FACTOR_DENOMINATOR = 2**1024


@dataclass(frozen=True, slots=True)
class GrowingSequence(AbstractEvidence):
    """Some steps may be repeated for ever, and along them some motion does not decay.

    That is shown in one of three ways.

    - With neither `doublings` nor `factor`: the average ``sum w_i A_i`` with ``sum w_i = 1`` is not
      Hurwitz. One mode is its own average, with the weight 1: staying in it is admissible unless it
      has a longest dwell time (discrete time: it is not Schur). Where contact must be covered as it
      is lost, it may be a mode of free motion without the deflection: far enough from the surface,
      such a motion goes on for as long as is wanted. Of several modes, periodic switching with
      these shares and a short period follows the average: uniform exponential stability under
      arbitrary switching carries over to all convex combinations (Molchanov and Pyatnitskiy 1989).
    - With `doublings`: all eigenvalues at most one in modulus would give ``|tr M^k| <= n`` for
      every k, where M is the product of flows (powers) and resets over a period, enclosed in balls.
      But ``|tr M^k| > n`` for the whole enclosure.
    - With `factor`, where the loss of contact must be covered: M, the product of the matrices along
      the sequence, has a real eigenvalue between the two numbers, of which the lower one is not
      below 1 (continuous time: M is one mode, and the number not below 0). Along the sequence its
      eigenvector v (or -v) has a positive deflection and positive forces wherever the environment
      acts, and elsewhere a negative deflection, or forces that would all pull. So the motion from v
      repeats itself, larger by that factor, for ever; contact is lost and made where that motion
      loses and makes it. Not all of v is negative deflection at rest, whose factor would be one.

    With `shares`, all this is about the modes at one value of the parameters that are unknown but
    constant: they may have it all the time.
    """

    kind: ClassVar[str] = "growing-sequence"
    allows_unequal_modes: ClassVar[bool] = True  # For one mode; see `find_misfit`
    covers_clock: ClassVar[bool] = True

    # Each mode with its time in s, or number of steps; with its weight in an average.
    steps: Steps
    doublings: int | None = None  # The k above is two to this power
    # For each step, which of the resets to the next mode is taken, counted from zero in the order
    # of the spec. Empty where there is no choice.
    edges: tuple[int, ...] = ()
    factor: tuple[Fraction, Fraction] | None = None  # In continuous time in 1/s
    # For each constant parameter, of the way from its low end to its high one.
    shares: tuple[Fraction, ...] = ()

    @property
    def shows(self) -> Shows:
        """Instability."""
        return Shows.INSTABILITY

    @property
    def is_average(self) -> bool:
        """Whether it is about an average of modes, or one mode."""
        return self.doublings is None and self.factor is None

    @property
    def names_unstable_mode(self) -> bool:
        """Whether it is about one mode that is not stable, at any value of a parameter."""
        return self.is_average and len(self.steps) == 1 and not self.shares

    @property
    def used(self) -> frozenset[str] | None:
        """The modes of the sequence; at a value of a parameter, modes have other names."""
        return None if self.shares else frozenset(name for name, _ in self.steps)

    def at_value(self, system: SwitchedSystem) -> tuple[SwitchedSystem, GrowingSequence]:
        """TRUSTED: return the system at the value of the parameters, and this without shares."""
        if not self.shares:
            return system, self
        return system_at(system, self.shares), replace(self, shares=())

    def used_matrices(self, system: SwitchedSystem) -> list[RationalMatrix]:
        """Return the matrices of the modes of the sequence."""
        at_value, plain = self.at_value(system)
        return AbstractEvidence.used_matrices(plain, at_value)

    def covers_loss(self, system: SwitchedSystem) -> bool:
        """Tell whether signs are kept, or what is used is free motion or the same in both."""
        if self.shares:
            return False
        free = {mode.name for mode in system.free_motions()}
        is_free = self.names_unstable_mode and self.steps[0][0] in free
        return self.factor is not None or is_free or AbstractEvidence.covers_loss(self, system)

    def fits(self, switching: Switching) -> bool:
        """Tell whether the steps may be repeated: every time and every switch is allowed."""
        if self.shares:
            alone = self.is_average and len(self.steps) == 1
            return bool(switching.fixed_ends) and (not switching.resets or alone)
        if not 1 <= len(self.steps) <= MAX_STEPS:
            return False
        if len(self.steps) == 1 and not self.edges:
            return switching.stay(self.steps[0][0]).longest is None
        if self.is_average:
            return switching.is_arbitrary
        if self.factor is not None and switching.resets:
            return False
        names = [name for name, _ in self.steps]
        following = self.switches()
        allowed = switching.transitions
        staying = {a for a, b in following if a == b}
        return (
            (allowed is None or {(a, b) for a, b in following if a != b} <= set(allowed))
            and all(_may_stay(switching, *step, step[0] in staying) for step in self.steps)
            and self._takes_edges(switching)
            # Constant parameters are at one of their corners all the time.
            and switching.share_a_corner(names)
        )

    def switches(self) -> list[tuple[str, str]]:
        """Return what follows what, round the period; a mode alone follows itself."""
        names = [name for name, _ in self.steps]
        return list(zip(names, (*names[1:], *names[:1]), strict=True))

    def _takes_edges(self, switching: Switching) -> bool:
        """Tell whether the chosen resets exist; without a choice there is at most one each."""
        maps = switching.maps()
        counts = [len(maps.get(switch, ())) for switch in self.switches()]
        if not self.edges:
            return all(count <= 1 for count in counts)
        return len(self.edges) == len(counts) and all(
            0 <= edge < max(count, 1) for edge, count in zip(self.edges, counts, strict=True)
        )

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check the steps, and that a motion along them does not decay."""
        if self.shares:
            if (odd := self._find_odd_shares(system)) is not None:
                return odd
            at_value, plain = self.at_value(system)
            return plain.find_fault(at_value)
        return self._find_odd_steps(system) or self._find_decay(system)

    def _find_odd_steps(self, system: SwitchedSystem) -> str | None:
        alone = self.names_unstable_mode
        if alone:
            known = (*system.modes, *system.free_motions())
        else:
            known = system.modes if self.factor is None else (*system.modes, *system.free)
        if not 1 <= len(self.steps) <= MAX_STEPS:
            return "the sequence is empty or too long"
        if not {name for name, _ in self.steps} <= {mode.name for mode in known}:
            return "the sequence uses modes that do not exist"
        if not (alone or system.is_uniform):
            return "a sequence of several steps needs modes of equal size"
        if any(not 0 < time <= MAX_TIME for _, time in self.steps):
            return f"a time is not between 0 and {MAX_TIME}"
        if system.clock is not None and not keeps_turns(system.clock, self.steps):
            return "a mode is in force when it is not its turn"
        if self.edges and self.doublings is None:
            return "only a period has resets"
        if self.is_average:
            return self._find_odd_weights(system.time) or self._find_unattained(system)
        whole = system.time is Time.DISCRETE or self.factor is not None
        if whole and any(time.denominator != 1 for _, time in self.steps):
            return "a number of steps is not whole"
        return self._find_unattained(system)

    def _find_unattained(self, system: SwitchedSystem) -> str | None:
        """Say which mode need not be attained, where what is cannot be enclosed; or None."""
        if system.time is Time.DISCRETE:
            return None
        odd = (name for name, _ in self.steps if system.enclosure_of(name) != (name,))
        return next(
            (f"mode {name} is a corner of an enclosure: {UNATTAINED}" for name in odd), None
        )

    def _find_odd_weights(self, time: Time) -> str | None:
        if time is Time.DISCRETE and len(self.steps) > 1:
            return "an average of modes is for continuous time"
        if len({name for name, _ in self.steps}) < len(self.steps):
            return "a mode is named twice in an average"
        if not _are_short(self.steps):
            return "the weights have too many digits"
        return None if sum(w for _, w in self.steps) == 1 else "the sum of the weights is not one"

    def _find_decay(self, system: SwitchedSystem) -> str | None:
        if self.doublings is not None and self.factor is not None:
            return "the evidence is of two kinds at once"
        if self.factor is not None:
            return self._find_decay_in_contact(system, *self.factor)
        if self.doublings is not None:
            if not 0 <= self.doublings <= MAX_DOUBLINGS:
                return f"the trace is not that of a power up to {MAX_DOUBLINGS} doublings"
            if len(self.steps) * system.order**3 > MAX_WORK:
                return "the sequence is too long for so many states"
            try:
                if has_growing_trace(system, self.steps, self.edges, self.doublings):
                    return None
            except TooLargeError as error:
                return str(error)
            return "the enclosure of the monodromy matrix does not show growth"
        enclosed = system.enclosure_of(self.steps[0][0])
        if len(enclosed) > 1:
            modes = {mode.name: mode.A for mode in (*system.modes, *system.free_motions())}
            if grows_throughout(modes[name] for name in enclosed):
                return None
            name = self.steps[0][0]
            return f"not all that mode {name} is a corner of is surely unstable: {UNATTAINED}"
        what = f"mode {self.steps[0][0]}" if len(self.steps) == 1 else "the average of the modes"
        try:
            stable = is_stable(average(system, self.steps), system.time)
        except TooLargeError:
            return f"the numbers of {what} are too large to check"
        return f"{what} is stable" if stable else None

    def _find_decay_in_contact(
        self, system: SwitchedSystem, low: Fraction, high: Fraction
    ) -> str | None:
        length = sum(count for _, count in self.steps)
        if not system.is_losable:
            return "the system does not ask for the loss of contact to be covered"
        if length > MAX_STEPS or length * system.order**3 > MAX_WORK:
            return "the sequence is too long for so many states"
        if system.time is Time.CONTINUOUS and length != 1:
            return "in continuous time the sequence is one mode"
        if not (1 if system.time is Time.DISCRETE else 0) <= low < high:
            return "the factor is not beyond the limit of stability"
        if max(low.denominator, high.denominator) > MAX_FACTOR_DENOMINATOR:
            return "the factor has too many digits"
        if grows_in_contact(system, self.steps, low, high):
            return None
        return "the enclosure does not show a growing motion that keeps the signs of contact"

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield nothing: no matrix has to be positive definite."""
        yield from ()

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the sequence and what follows."""
        if self.shares:
            at_value, plain = self.at_value(system)
            where = value_text(system, self.shares)
            return (
                f"{where}, which the range allows and which does not change: "
                f"{plain.claim(at_value)}"
            )
        law = "x' = A x" if system.time is Time.CONTINUOUS else "x+ = A x"
        if self.factor is not None:
            return self._claim_in_contact(system.time, law, self.factor[0])
        if self.doublings is not None:
            return (
                f"Repeating the signal ({self._signal(system)}) makes some solution grow without "
                f"bound: the spectral radius over one period is above 1, so {law} is unstable "
                "under this switching."
            )
        region = "Hurwitz" if system.time is Time.CONTINUOUS else "Schur"
        eigenvalue = worst_eigenvalue(average(system, self.steps), system.time)
        not_stable = f"is not {region} (eigenvalue about {eigenvalue})"
        if len(self.steps) > 1:
            shares = " + ".join(f"{weight} {name}" for name, weight in self.steps)
            return (
                f"The average {shares} of modes {not_stable}: fast switching with these shares "
                f"follows it, so {law} is not uniformly exponentially stable under arbitrary "
                "switching."
            )
        ((name, _),) = self.steps
        free = any(mode.name == name for mode in system.free_motions())
        beside = ", the deflection aside," if free else ""
        again = ", for as long as is wanted if it begins far from the surface" if free else ""
        return (
            f"Mode {name}{beside} {not_stable}: staying in it is an admissible switching signal"
            f"{again}, so {law} is not uniformly exponentially stable."
        )

    def _signal(self, system: SwitchedSystem) -> str:
        unit = "s" if system.time is Time.CONTINUOUS else "steps"
        maps, switches = system.switching.maps(), self.switches()
        parts = []
        for (name, time), way, switch in zip(
            self.steps, self.edges or (0,) * len(switches), switches, strict=True
        ):
            reset = f", then reset {way + 1} to {switch[1]}"
            choice = len(maps.get(switch, ())) > 1
            parts.append(f"{name} for {nearly(time, unit)}{reset * choice}")
        if any(nearly(time).startswith("about") for _, time in self.steps):
            parts[-1] += "; the certificate holds the exact times"
        return ", ".join(parts)

    def _claim_in_contact(self, time: Time, law: str, factor: Fraction) -> str:
        growth = at_least(factor, "1/s" if time is Time.CONTINUOUS else "")
        signal = ", ".join(f"{name} for {count} steps" for name, count in self.steps)
        if sum(count for _, count in self.steps) == 1:
            first = (
                f"Mode {self.steps[0][0]} has a real eigenvalue {growth}, and a motion along it."
            )
        else:
            first = (
                f"Repeating the sequence ({signal}) makes some motion larger by a factor {growth} "
                "each time."
            )
        return (
            f"{first} Wherever the environment acts, the deflection is positive along it and "
            "nothing pulls, and elsewhere it is not, so contact is lost and made as that motion "
            f"says, and {law} is unstable with contact that may be lost."
        )

    def find_unsayable(self, system: SwitchedSystem) -> str | None:
        """Say what keeps the steps from being put into words, or None."""
        if not self.steps or (self.edges and len(self.edges) != len(self.steps)):
            return "there are no steps, or there is not one edge for each of them"
        return self._find_odd_shares(system) if self.shares else None

    def _find_odd_shares(self, system: SwitchedSystem) -> str | None:
        if any(share.denominator > MAX_SHARE_DENOMINATOR for share in self.shares):
            return "a share has too many digits"
        return find_odd_shares(system.switching, self.shares)


def average(system: SwitchedSystem, weights: Sequence[tuple[str, Fraction]]) -> RationalMatrix:
    """TRUSTED: return the weighted sum of modes; of free motion, without the deflection.

    A KeyError if there is no mode of a name, a `TooLargeError` for too many digits.
    """
    modes = {mode.name: mode.A for mode in (*system.modes, *system.free_motions())}
    matrices = [modes[name] for name, _ in weights]
    common = common_denominator(A.denominator for A in matrices)
    if common is None or len(weights) > len(modes) or not _are_short(weights):
        raise TooLargeError("the numbers of an average are too large to check")
    if len(weights) == 1:
        return matrices[0]
    rows = zip(*(A.fractions() for A in matrices), strict=True)
    return RationalMatrix.from_rows(
        [
            [
                sum((w * a for (_, w), a in zip(weights, entries, strict=True)), Fraction(0))
                for entries in zip(*row, strict=True)
            ]
            for row in rows
        ]
    )


def decides(system: SwitchedSystem, mode: str) -> bool:
    """Tell whether a mode that is not stable refutes the system, and not in kept contact alone."""
    return staying(mode).shown(system) is Shows.INSTABILITY


def staying(mode: str) -> GrowingSequence:
    """Return that staying in a mode does not decay."""
    return GrowingSequence(((mode, Fraction(1)),))


def _are_short(weights: Sequence[tuple[str, Fraction]]) -> bool:
    single = all(w <= 1 and w.denominator <= MAX_SHARE_DENOMINATOR for _, w in weights)
    return single and lcm(*(w.denominator for _, w in weights)) <= MAX_SHARE_DENOMINATOR


def _may_stay(switching: Switching, mode: str, time: Fraction, goes_on: bool) -> bool:
    """Tell whether a mode may be active for so long: one that must be left, not twice in turn."""
    stay = switching.stay(mode)
    if stay.longest is None:
        return time >= stay.shortest
    return stay.shortest <= time <= stay.longest and not goes_on
