"""What a rung of the ladder is, and the facts of a system that decide which rungs apply."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from math import inf

from nrs_design.proof.evidence import AbstractEvidence, Shows
from nrs_design.proof.mode import Time
from nrs_design.proof.spectrum import affordable, is_stable
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import counted
from nrs_design.search.acceptance import Candidates, Search
from nrs_design.search.certification import Limits
from nrs_design.search.family import Family
from nrs_design.search.method import Method
from nrs_design.work import Allowance, Cost

# Degrees that are tried before the rungs below, which are quicker than higher ones.
FIRST_DEGREES = 2

Step = tuple[str, Search]


@dataclass(frozen=True, slots=True)
class Facts:
    """What decides which rungs apply."""

    system: SwitchedSystem  # The modes and their switching
    # The modes that must be left are stable, too, as far as the exact test goes.
    leaves_stable: bool

    @classmethod
    def of(cls, system: SwitchedSystem) -> Facts:
        """Look at a system, exactly."""
        lasting = {mode.name for mode in system.lasting_modes()}
        left = affordable(mode for mode in system.modes if mode.name not in lasting)
        return cls(system, all(fits and is_stable(mode.A, system.time) for mode, fits in left))

    def is_continuous(self) -> bool:
        """Tell whether time is continuous."""
        return self.system.time is Time.CONTINUOUS

    def counts_stays(self) -> bool:
        """Tell whether modes take turns as dwell times allow."""
        return self.system.clock is not None and self.system.clock.counts_stays

    def may_share_a_function(self) -> bool:
        """Tell whether one function for all modes could prove anything."""
        system = self.system
        return system.is_uniform and not system.switching.resets and self.leaves_stable

    def may_share_an_ellipsoid(self) -> bool:
        """Tell whether a common quadratic function has to be searched for."""
        return self.may_share_a_function() and self.system.order > 1

    def loses_contact(self) -> bool:
        """Tell whether one function has to cover the loss of contact."""
        return self.system.contact is not None and self.may_share_an_ellipsoid()

    def may_bounce(self) -> bool:
        """Tell whether functions could be for lost contact with springs."""
        contact = self.system.contact
        return contact is not None and not contact.pulls and self.may_share_an_ellipsoid()

    def bounces_in_steps(self) -> bool:
        """Tell the same of discrete time."""
        return self.may_bounce() and not self.is_continuous()

    def bounces_in_time(self) -> bool:
        """Tell the same of continuous time."""
        return self.may_bounce() and self.is_continuous()

    def rounds(self) -> bool:
        """Tell whether a quadratic function has to cover what the arithmetic rounds."""
        kept = self.system.contact is None
        return bool(self.system.roundings) and kept and self.may_share_an_ellipsoid()

    def has_rules(self) -> bool:
        """Tell whether there are rules for switching, and no parameter is constant."""
        switching = self.system.switching
        return not (switching.is_arbitrary or switching.fixed_ends)

    def is_of_words(self) -> bool:
        """Tell whether signals are words of modes in discrete time, and nothing else acts."""
        system = self.system
        acting = (system.contact, system.flights, system.clock, system.saturation)
        if any(acting) or system.roundings or system.switching.fixed_ends:
            return False
        return not self.is_continuous() and system.is_uniform and len(system.modes) > 1

    def has_values(self) -> bool:
        """Tell whether the modes at the values of a constant parameter can be looked at."""
        switching = self.system.switching
        return bool(switching.fixed_ends) and self.system.is_uniform and self.leaves_stable


# What looks for growth, or for why there is no quadratic function.
REFUTING = (None, Method.PERIOD, Method.VALUE, Method.OBSTRUCTION)


@dataclass(frozen=True, slots=True)
class Rung:
    """One row of the ladder."""

    name: str  # What the reader is told
    method: Method | None  # What asks for it alone; None for what is tried whatever is asked for
    applies: Callable[[Facts], bool]  # Tells whether it can decide a system
    # Yields candidates for a family, and for a degree if it rises.
    search: Callable[..., Candidates[AbstractEvidence]]
    # Predicts what a degree takes, for a rung that is tried with ever higher ones.
    cost: Callable[[SwitchedSystem, int], tuple[Cost, str]] | None = None
    # Tells whether it is worth trying where it was not asked for alone.
    in_auto: Callable[[Facts], bool] = lambda facts: True
    # A degree that is predicted to take more work is tried with the higher ones, at last.
    first: float = inf
    # Of a rung that rises in the steps that its forms remember: how many, and what that takes.
    lengths: Callable[[SwitchedSystem], dict[int, Cost]] | None = None
    degree: int = 2  # Of these forms
    clocked: bool = False  # It is for modes that take turns, and for no others
    # What it finds is refuted by growth in kept contact, or is such growth itself.
    in_kept_contact: bool = True

    def is_idle(self, known: frozenset[Shows]) -> bool:
        """Tell whether it can find nothing more."""
        gradient = self.method is Method.GRADIENT
        if Shows.STABILITY in known and (gradient or self.method in REFUTING):
            return True
        without_quadratic = gradient and Shows.NO_COMMON_QUADRATIC in known
        return without_quadratic or (self.in_kept_contact and Shows.INSTABILITY_IN_CONTACT in known)

    def count_first(self, system: SwitchedSystem) -> int:
        """Return how many steps are made before the rungs below: of the quick first degrees."""
        if self.lengths is not None:
            return sum(cost.work <= self.first for cost in self.lengths(system).values())
        if self.cost is None or self.first == inf:
            return FIRST_DEGREES
        degrees = range(2, 2 + FIRST_DEGREES)
        return sum(self.cost(system, d)[0].work <= self.first for d in degrees)

    def is_wanted(self, facts: Facts, method: Method) -> bool:
        """Tell whether to try it, given what was asked for."""
        asked = self.in_auto(facts) if method is Method.AUTO else self.method in {None, method}
        return asked and self.can_decide(facts)

    def can_decide(self, facts: Facts) -> bool:
        """Tell whether it can decide a system."""
        return self.clocked == (facts.system.clock is not None) and self.applies(facts)

    def steps(self, system: SwitchedSystem, limits: Limits, allowance: Allowance) -> Iterator[Step]:
        """Yield itself, or searches of rising degree and the reason why there is no higher one.

        Degrees rise while they are predicted to fit into what is left of the budget, so how far
        they rise does not depend on the machine. In one state, all forms of a degree are alike.
        """
        if self.lengths is not None:
            if limits.max_degree is not None and self.degree > limits.max_degree:
                return
            for length, cost in self.lengths(system).items():
                fits = allowance.affords(cost)
                yield (
                    f"{self.name} of {counted(length, 'step')}",
                    partial(self.search, length=length),
                )
                if not fits:
                    return
            return
        if self.cost is None:
            yield self.name, self.search
            return
        if system.order == 1:
            return
        from nrs_design.search.polynomial import HELD, highest_degree

        highest = highest_degree(system.order)
        asked = highest if limits.max_degree is None else limits.max_degree // 2
        for d in _rising(min(highest, asked)):
            fits = allowance.affords(self.cost(system, d)[0])
            yield f"{self.name} of degree {2 * d}", partial(self.search, degree=d)
            if not fits:
                return
        if asked < highest:
            step = f"{self.name} of degree {2 * asked + 2}"
            yield step, _refuse(f"not tried: --max-degree is {limits.max_degree}")
            return
        yield f"{self.name} of higher degree", _refuse(f"not tried: {HELD}")


def _rising(highest: int) -> Iterator[int]:
    """Yield halves of degrees up to the highest: each form takes about four times the one before.

    What all lower degrees took is then a part of what the last one takes.
    """
    d = 2
    while d < highest:
        yield d
        d += max(1, d // 3)
    if highest >= 2:
        yield highest


def _refuse(reason: str) -> Search:
    """Return a search that is not made."""

    def search(family: Family) -> Candidates[AbstractEvidence]:
        yield from ()
        return reason

    return search
