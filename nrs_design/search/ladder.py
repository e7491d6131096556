"""The ladder: all searches in their order, with the systems that they can decide."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import islice, zip_longest
from math import inf
from typing import Any

from nrs_design.late import late_function
from nrs_design.proof.evidence import AbstractEvidence, Shows
from nrs_design.proof.mode import Time
from nrs_design.proof.spectrum import affordable, is_stable
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import counted
from nrs_design.search.acceptance import Candidates, Search
from nrs_design.search.certification import Limits
from nrs_design.search.family import Family
from nrs_design.search.method import Method
from nrs_design.search.work import Allowance, Cost

# Work of a degree of what is tried before the cheaper rungs.
QUICK = 0.5
# Degrees before the rungs below; these rungs are quicker than higher degrees.
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

    def always(self) -> bool:
        """Return True, for rungs that apply to any system."""
        return True

    def is_uniform(self) -> bool:
        """Tell whether all modes have the same number of states."""
        return self.system.is_uniform

    def is_continuous(self) -> bool:
        """Tell whether time is continuous."""
        return self.system.time is Time.CONTINUOUS

    def counts_stays(self) -> bool:
        """Tell whether modes are scheduled by counted dwell times."""
        return self.system.clock is not None and self.system.clock.counts_stays

    def may_share_a_function(self) -> bool:
        """Tell whether one function for all modes could prove anything."""
        return self.is_uniform() and not self.system.switching.resets and self.leaves_stable

    def may_share_an_ellipsoid(self) -> bool:
        """Tell whether to search for a common quadratic function."""
        return self.may_share_a_function() and self.system.order > 1

    def may_share_a_square(self) -> bool:
        """Tell whether the square of the one state could be a common function."""
        return self.may_share_a_function() and self.system.order == 1

    def loses_contact(self) -> bool:
        """Tell whether one function has to cover the loss of contact."""
        return self.system.contact is not None and self.may_share_an_ellipsoid()

    def may_bounce(self) -> bool:
        """Tell whether functions could be for lost contact with springs."""
        contact = self.system.contact
        return contact is not None and not contact.pulls and self.may_share_an_ellipsoid()

    def rounds(self) -> bool:
        """Tell whether a quadratic function has to cover rounding errors of the arithmetic."""
        kept = self.system.contact is None
        return bool(self.system.roundings) and kept and self.may_share_an_ellipsoid()

    def has_rules(self) -> bool:
        """Tell whether there are rules for switching, and no parameter is constant."""
        switching = self.system.switching
        return not (switching.is_arbitrary or switching.fixed_ends)

    def is_of_words(self) -> bool:
        """Tell whether signals are plain sequences of modes in discrete time."""
        system = self.system
        acting = (system.contact, system.flights, system.clock, system.saturation)
        if any(acting) or system.roundings or system.switching.fixed_ends:
            return False
        return not self.is_continuous() and self.is_uniform() and len(system.modes) > 1

    def has_values(self) -> bool:
        """Tell whether the system has constant parameters."""
        fixed = bool(self.system.switching.fixed_ends)
        return fixed and self.is_uniform() and self.leaves_stable


# Methods that search for growth, or for an obstruction to quadratic functions.
REFUTING = (None, Method.PERIOD, Method.VALUE, Method.OBSTRUCTION)


@dataclass(frozen=True, slots=True)
class Rung:
    """One row of the ladder."""

    name: str  # For the reader
    method: Method | None  # Option that selects this rung; None if every method includes the rung
    applies: Callable[[Facts], bool]  # Tells whether the rung can decide a system
    # Yields candidates for a family, and for a size if the rung has several.
    search: Callable[..., Candidates[AbstractEvidence]]
    # Cost of a degree, for a rung that is tried with ever higher degrees.
    cost: Callable[[SwitchedSystem, int], tuple[Cost, str]] | None = None
    # Tells whether the rung is worth trying where the method is auto.
    in_auto: Callable[[Facts], bool] = lambda facts: True
    # Degrees that are predicted to take more work are tried after all other rungs.
    first: float = inf
    # Costs by length, for a rung whose forms have a memory of ever more steps.
    lengths: Callable[[SwitchedSystem], dict[int, Cost]] | None = None
    degree: int = 2  # Degree of these forms
    clocked: bool = False  # Whether the rung applies to systems with a clock only
    # Whether growth in kept contact refutes the result of the rung, or is it.
    in_kept_contact: bool = True

    def is_idle(self, known: frozenset[Shows]) -> bool:
        """Tell whether the rung can add nothing to known conclusions."""
        gradient = self.method is Method.GRADIENT
        if Shows.STABILITY in known and (gradient or self.method in REFUTING):
            return True
        without_quadratic = gradient and Shows.NO_COMMON_QUADRATIC in known
        return without_quadratic or (self.in_kept_contact and Shows.INSTABILITY_IN_CONTACT in known)

    def count_first(self, system: SwitchedSystem) -> int:
        """Return the number of steps before the rungs below: those of the quick first degrees."""
        if self.first == inf:
            return FIRST_DEGREES
        sizes = islice(self._sizes(system), FIRST_DEGREES if self.cost else None)
        return sum(cost.work <= self.first for _, cost in sizes)

    def _sizes(self, system: SwitchedSystem, highest: float = inf) -> Iterator[tuple[int, Cost]]:
        """Yield lengths or halves of degrees, up to the highest half, with their costs.

        In one state, all forms of a degree are alike.
        """
        if self.lengths is not None and self.degree <= 2 * highest:
            yield from self.lengths(system).items()
        if self.cost is not None and system.order > 1:
            from nrs_design.search.polynomial import rising_degrees

            for d in rising_degrees(system.order, highest):
                yield d, self.cost(system, d)[0]

    def is_wanted(self, facts: Facts, method: Method) -> bool:
        """Tell whether to try the rung for a method."""
        asked = self.in_auto(facts) if method is Method.AUTO else self.method in {None, method}
        return asked and self.can_decide(facts)

    def can_decide(self, facts: Facts) -> bool:
        """Tell whether the rung can decide a system."""
        return self.clocked == (facts.system.clock is not None) and self.applies(facts)

    def _sized(self, size: int, family: Family) -> Candidates[AbstractEvidence]:
        return self.search(family, size)

    def steps(self, system: SwitchedSystem, limits: Limits, allowance: Allowance) -> Iterator[Step]:
        """Yield the search, or searches of rising size and why there is no higher degree.

        Sizes rise while their predicted cost fits into the budget, on any machine.
        """
        if self.cost is None and self.lengths is None:
            yield self.name, self.search
            return
        highest = inf if limits.max_degree is None else limits.max_degree // 2
        for size, cost in self._sizes(system, highest):
            fits = allowance.affords(cost)
            text = f"degree {2 * size}" if self.cost else counted(size, "step")
            yield f"{self.name} of {text}", partial(self._sized, size)
            if not fits:
                return
        if self.cost is None or system.order == 1:
            return
        from nrs_design.search.polynomial import SIZE_LIMITS, highest_degree

        if highest < highest_degree(system.order):
            step = f"{self.name} of degree {2 * highest + 2}"
            yield step, _refuse(f"not tried: --max-degree is {limits.max_degree}")
        else:
            yield f"{self.name} of higher degree", _refuse(f"not tried: {SIZE_LIMITS}")


def _refuse(reason: str) -> Search:
    """Return a search that is not made."""

    def search(family: Family) -> Candidates[AbstractEvidence]:
        yield from ()
        return reason

    return search


def _load_lazily(place: str) -> Callable[..., Any]:
    """Return a function of a module here, which is loaded when it is first called."""
    module, _, name = place.partition(".")
    return late_function(f"nrs_design.search.{module}", name)


SHARED_FORM, MODES = _load_lazily("graphs.search_together"), _load_lazily("graphs.search_modes")
OBSTRUCTION, GRADIENT = (
    _load_lazily("obstruction.search_obstruction"),
    _load_lazily("gradient.search_by_gradient"),
)
CONSTANT_VALUES = _load_lazily("unstable_value.search_switching_at_values")
# Cheapest first. A rung with rising degrees starts here with the first degrees; higher degrees
# follow after the last rung.
LADDER: tuple[Rung, ...] = (
    Rung(
        "quadratic for each controller",
        Method.PERIODIC_QUADRATIC,
        Facts.counts_stays,
        _load_lazily("counted_stays.search_stays"),
        clocked=True,
    ),
    Rung(
        "periodic quadratic",
        Method.PERIODIC_QUADRATIC,
        lambda f: not f.counts_stays(),
        _load_lazily("graphs.search_periodic_quadratic"),
        clocked=True,
    ),
    Rung("rounds", Method.PERIOD, Facts.always, _load_lazily("period.search_rounds"), clocked=True),
    Rung(
        "suspicious modes",
        None,
        Facts.is_uniform,
        _load_lazily("unstable_mode.examine_suspicious_modes"),
    ),
    Rung(
        "one state", Method.LMI, Facts.may_share_a_square, _load_lazily("graphs.decide_one_state")
    ),
    Rung("conewise quadratic", Method.CONEWISE_QUADRATIC, Facts.loses_contact, SHARED_FORM),
    Rung("quadratic, with roundings", Method.LMI, Facts.rounds, SHARED_FORM),
    # Before the rungs that assume that contact is kept. That no quadratic function exists is a
    # statement on the matrices in any contact.
    Rung("obstruction in contact", Method.OBSTRUCTION, Facts.may_bounce, OBSTRUCTION),
    Rung(
        "conewise mode quadratic",
        Method.CONEWISE_MODE_QUADRATIC,
        lambda f: f.may_bounce() and not f.is_continuous(),
        _load_lazily("graphs.search_conewise_modes"),
    ),
    Rung(
        "conewise polynomial",
        Method.CONEWISE_POLYNOMIAL,
        lambda f: f.may_bounce() and f.is_continuous(),
        _load_lazily("graphs.search_conewise_polynomial"),
        cost=_load_lazily("polynomial.conewise_cost"),
        first=QUICK,
    ),
    # After the proofs that cover the loss of contact, before those for kept contact.
    *(
        Rung(
            f"{what} with loss of contact",
            Method.PERIOD,
            lambda f: f.system.is_losable,
            _load_lazily("unstable_contact.search_contact"),
            clocked=clocked,
            in_kept_contact=False,
        )
        for clocked, what in ((False, "growth"), (True, "rounds"))
    ),
    Rung("lmi", Method.LMI, Facts.may_share_an_ellipsoid, _load_lazily("graphs.search_by_lmi")),
    Rung(
        "obstruction",
        Method.OBSTRUCTION,
        lambda f: f.may_share_a_function() and not f.may_bounce(),
        OBSTRUCTION,
    ),
    Rung("gradient", Method.GRADIENT, Facts.may_share_a_function, GRADIENT),
    Rung("every mode", None, Facts.always, _load_lazily("unstable_mode.examine_every_mode")),
    Rung(
        "constant values",
        Method.VALUE,
        Facts.has_values,
        _load_lazily("unstable_value.search_value"),
    ),
    Rung(
        "constants quadratic",
        Method.CONSTANTS_QUADRATIC,
        Facts.has_values,
        _load_lazily("constants_quadratic.search_constants_quadratic"),
    ),
    Rung(
        "mode quadratic",
        Method.MODE_QUADRATIC,
        Facts.always,
        MODES,
        # Under arbitrary switching in continuous time, all modes have the same function.
        in_auto=lambda f: (
            f.has_rules() or (f.system.switching.is_arbitrary and not f.is_continuous())
        ),
    ),
    Rung(
        "quadratic with a memory",
        Method.MEMORY_QUADRATIC,
        Facts.is_of_words,
        _load_lazily("memory.search_memory"),
        lengths=_load_lazily("memory.quadratic_memories"),
        first=QUICK,
    ),
    Rung(
        "words in the norms of forms",
        Method.PERIOD,
        Facts.is_of_words,
        _load_lazily("memory.search_extremal_words"),
    ),
    Rung(
        "quartic with a memory",
        Method.MEMORY_POLYNOMIAL,
        Facts.is_of_words,
        _load_lazily("memory.search_quartic_memory"),
        lengths=_load_lazily("memory.quartic_memories"),
        degree=4,
        first=QUICK,
    ),
    Rung(
        "mixture",
        Method.MIXTURE,
        lambda f: f.system.switching.is_arbitrary and f.is_continuous(),
        _load_lazily("unstable_value.search_mixture"),
    ),
    Rung(
        "polynomial",
        Method.POLYNOMIAL,
        Facts.may_share_a_function,
        _load_lazily("graphs.search_polynomial"),
        cost=_load_lazily("polynomial.family_cost"),
    ),
    Rung(
        "mode polynomial",
        Method.MODE_POLYNOMIAL,
        lambda f: f.has_rules() and not f.is_continuous(),
        MODES,
        cost=_load_lazily("polynomial.functions_cost"),
    ),
    Rung("period", Method.PERIOD, Facts.is_uniform, _load_lazily("period.search_period")),
    Rung("switching at constant values", Method.VALUE, Facts.has_values, CONSTANT_VALUES),
)


def applicable_methods(system: SwitchedSystem) -> set[Method]:
    """Return the methods that apply to a system."""
    facts = Facts.of(system)
    return {rung.method for rung in LADDER if rung.method is not None and rung.can_decide(facts)}


def steps(
    system: SwitchedSystem,
    method: Method,
    limits: Limits,
    allowance: Allowance,
    known: Callable[[], frozenset[Shows]],
) -> Iterator[Step]:
    """Yield the names of the rungs with their searches, in the order in which they are tried.

    What is left of the budget when a step is asked for decides how far degrees rise. `known` tells
    what has been shown by now: where there is no common quadratic function, none is searched for;
    where it is not stable in kept contact, only growth with contact that is lost.
    """
    facts = Facts.of(system)
    rising = []
    for rung in LADDER:
        if not rung.is_wanted(facts, method) or rung.is_idle(known()):
            continue
        own = rung.steps(system, limits, allowance)
        yield from islice(own, rung.count_first(system))
        rising.append(own)
    for higher in zip_longest(*rising):
        if Shows.INSTABILITY_IN_CONTACT in known():
            return
        yield from (step for step in higher if step is not None)
