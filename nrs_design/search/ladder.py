"""The ladder: which searches there are, what they can decide, and in which order they are tried."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import islice, zip_longest
from math import inf
from typing import Any

from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.evidence.unstable_mode import affordable, is_stable
from nrs_design.proof.late import late_function
from nrs_design.proof.mode import Time
from nrs_design.proof.noun import dataclass
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.allowance import Allowance, Cost
from nrs_design.search.candidates import Candidates, Search
from nrs_design.search.certification import Limits
from nrs_design.search.family import Family
from nrs_design.search.method import Method

# Degrees that are tried before the rungs below, which are quicker than higher ones.
FIRST_DEGREES = 2
# Seconds of a degree of what is tried before the cheaper rungs.
QUICK = 0.5

Step = tuple[str, Search]


@dataclass(frozen=True, slots=True)
class Facts:
    """What decides which rungs apply.

    Parameters
    ----------
    system : SwitchedSystem
        The modes and their switching.
    leaves_stable : bool
        The modes that must be left are stable, too, as far as the exact test goes.
    """

    system: SwitchedSystem
    leaves_stable: bool

    @classmethod
    def of(cls, system: SwitchedSystem) -> Facts:
        """Look at a system, exactly."""
        lasting = {mode.name for mode in system.lasting_modes()}
        left = affordable(mode for mode in system.modes if mode.name not in lasting)
        return cls(system, all(fits and is_stable(mode.A, system.time) for mode, fits in left))

    @property
    def is_continuous(self) -> bool:
        """Whether time is continuous."""
        return self.system.time is Time.CONTINUOUS

    @property
    def is_arbitrary(self) -> bool:
        """Whether switching follows no rule."""
        return self.system.switching.is_arbitrary

    @property
    def may_share_a_function(self) -> bool:
        """Whether one function for all modes could prove anything."""
        system = self.system
        return system.is_uniform and not system.switching.resets and self.leaves_stable

    @property
    def may_share_an_ellipsoid(self) -> bool:
        """Whether a common quadratic function has to be searched for."""
        return self.may_share_a_function and self.system.order > 1

    @property
    def may_lose_contact(self) -> bool:
        """Whether the system says how contact is lost."""
        return self.system.contact is not None

    @property
    def rounds(self) -> bool:
        """Whether the system says what its arithmetic rounds."""
        return bool(self.system.roundings)

    @property
    def is_coupled(self) -> bool:
        """Whether the system says what axes do to each other."""
        return bool(self.system.couplings)

    @property
    def takes_turns(self) -> bool:
        """Whether its modes take turns."""
        return self.system.clock is not None

    @property
    def may_bounce(self) -> bool:
        """Whether functions could be for lost contact with springs."""
        contact = self.system.contact
        springs = contact is not None and not contact.pulls
        return self.may_share_an_ellipsoid and springs

    @property
    def has_rules(self) -> bool:
        """Whether there are rules for switching, and no parameter is constant."""
        return not (self.is_arbitrary or self.has_constant)

    @property
    def has_constant(self) -> bool:
        """Whether a parameter is unknown but constant."""
        return bool(self.system.switching.fixed_ends)

    @property
    def has_values(self) -> bool:
        """Whether the modes at the values of a constant parameter can be looked at."""
        return self.has_constant and self.system.is_uniform and self.leaves_stable


def _always(facts: Facts) -> bool:
    """Say yes."""
    return True


@dataclass(frozen=True, slots=True)
class Rung:
    """One row of the ladder.

    Parameters
    ----------
    name : str
        What the reader is told.
    method : Method or None
        What asks for it alone; None for what is tried whatever is asked for.
    applies : callable
        Tells whether it can decide a system.
    search : callable
        Yields candidates for a family, and for a degree if it rises.
    cost : callable or None
        Predicts what a degree takes, for a rung that is tried with ever higher ones.
    in_auto : callable
        Tells whether it is worth trying where it was not asked for alone.
    only_quadratic : bool
        Left out once it is known that there is no common quadratic function.
    first : float
        A degree that is predicted to take more seconds is tried with the higher ones, at last.
    coupled : bool
        What it finds of one axis says something about all axes that act on each other; other rungs
        are not tried where they do.
    clocked : bool
        It is for modes that take turns, and for no others.
    """

    name: str
    method: Method | None
    applies: Callable[[Facts], bool]
    search: Callable[..., Candidates[AbstractEvidence]]
    cost: Callable[[SwitchedSystem, int], tuple[Cost, str]] | None = None
    in_auto: Callable[[Facts], bool] = _always
    only_quadratic: bool = False
    first: float = inf
    coupled: bool = False
    clocked: bool = False

    def count_first(self, system: SwitchedSystem) -> int:
        """Return how many steps are made before the rungs below: of the first degrees, the quick.

        Parameters
        ----------
        system : SwitchedSystem
            The modes.
        """
        if self.cost is None or self.first == inf:
            return FIRST_DEGREES
        degrees = range(2, 2 + FIRST_DEGREES)
        return sum(self.cost(system, d)[0].seconds <= self.first for d in degrees)

    def is_wanted(self, facts: Facts, method: Method) -> bool:
        """Tell whether to try it, given what was asked for."""
        asked = self.in_auto(facts) if method is Method.AUTO else self.method in {None, method}
        return asked and self.can_decide(facts)

    def can_decide(self, facts: Facts) -> bool:
        """Tell whether it can decide a system.

        Parameters
        ----------
        facts : Facts
            Of the system.
        """
        if self.clocked != facts.takes_turns:
            return False
        return (self.coupled or not facts.is_coupled) and self.applies(facts)

    def steps(self, system: SwitchedSystem, limits: Limits, allowance: Allowance) -> Iterator[Step]:
        """Yield itself, or searches of rising degree and the reason why there is no higher one.

        Degrees rise while they are predicted to fit into what is left of the budget, so how far
        they rise does not depend on the machine. In one state, all forms of a degree are alike.

        Parameters
        ----------
        system : SwitchedSystem
            The modes.
        limits : Limits
            With the highest degree.
        allowance : Allowance
            What is left of the budget.
        """
        if self.cost is None:
            yield self.name, self.search
            return
        if system.order == 1:
            return
        from nrs_design.search.polynomial import HELD, highest_degree

        for d in range(2, highest_degree(system.order) + 1):
            step = f"{self.name} of degree {2 * d}"
            if limits.max_degree is not None and 2 * d > limits.max_degree:
                yield step, _refuse(f"not tried: --max-degree is {limits.max_degree}")
                return
            fits = allowance.affords(self.cost(system, d)[0])
            yield step, partial(self.search, degree=d)
            if not fits:
                return
        yield f"{self.name} of higher degree", _refuse(f"not tried: {HELD}")


def _refuse(reason: str) -> Search:
    """Return a search that is not made."""

    def search(family: Family) -> Candidates[AbstractEvidence]:
        yield from ()
        return reason

    return search


def _in(module: str, name: str) -> Callable[..., Any]:
    """Name a function of a module here: most rungs are never reached, and need not be loaded."""
    return late_function(f"nrs_design.search.{module}", name)


# Cheapest first. A rung that rises is tried here with its first degrees, with higher ones at last.
LADDER: tuple[Rung, ...] = (
    Rung(
        "periodic quadratic",
        Method.PERIODIC_QUADRATIC,
        _always,
        _in("periodic_quadratic", "search_periodic_quadratic"),
        clocked=True,
    ),
    Rung("rounds", Method.PERIOD, _always, _in("rounds", "search_rounds"), clocked=True),
    Rung(
        "suspicious modes",
        None,
        lambda f: f.system.is_uniform,
        _in("unstable_mode", "examine_suspicious_modes"),
        coupled=True,
    ),
    Rung(
        "coupled axes",
        Method.COUPLED_AXES,
        lambda f: f.is_coupled and f.is_continuous and f.may_share_an_ellipsoid,
        _in("coupled_axes", "search_coupled_axes"),
        coupled=True,
    ),
    Rung(
        "coupled axes in steps",
        Method.COUPLED_AXES,
        lambda f: f.is_coupled and not f.is_continuous and f.may_share_an_ellipsoid,
        _in("coupled_steps", "search_coupled_steps"),
        coupled=True,
    ),
    Rung(
        "one state",
        Method.LMI,
        lambda f: f.may_share_a_function and not f.may_share_an_ellipsoid,
        _in("common_quadratic", "decide_one_state"),
    ),
    Rung(
        "conewise quadratic",
        Method.CONEWISE_QUADRATIC,
        lambda f: f.may_lose_contact and f.may_share_an_ellipsoid,
        _in("conewise_quadratic", "search_conewise"),
    ),
    Rung(
        "quadratic, with roundings",
        Method.LMI,
        lambda f: f.rounds and not f.may_lose_contact and f.may_share_an_ellipsoid,
        _in("conewise_quadratic", "search_conewise"),
    ),
    # Before what takes for granted that contact is kept; that no quadratic function exists is said
    # of the matrices all the same.
    Rung(
        "obstruction in contact",
        Method.OBSTRUCTION,
        lambda f: f.may_bounce,
        _in("obstruction", "search_obstruction"),
    ),
    Rung(
        "conewise mode quadratic",
        Method.CONEWISE_MODE_QUADRATIC,
        lambda f: f.may_bounce and not f.is_continuous,
        _in("conewise_mode_quadratic", "search_conewise_modes"),
    ),
    Rung(
        "conewise polynomial",
        Method.CONEWISE_POLYNOMIAL,
        lambda f: f.may_bounce and f.is_continuous,
        _in("conewise_polynomial", "search_conewise_polynomial"),
        cost=_in("conewise_polynomial", "conewise_cost"),
        first=QUICK,
    ),
    Rung(
        "lmi",
        Method.LMI,
        lambda f: f.may_share_an_ellipsoid,
        _in("common_quadratic", "search_by_lmi"),
    ),
    Rung(
        "obstruction",
        Method.OBSTRUCTION,
        lambda f: f.may_share_a_function and not f.may_bounce,
        _in("obstruction", "search_obstruction"),
    ),
    # The solver may have stalled: other coordinates, before giving up on quadratics.
    Rung(
        "lmi, raw",
        Method.LMI,
        lambda f: f.may_share_an_ellipsoid,
        _in("common_quadratic", "search_raw"),
        only_quadratic=True,
    ),
    Rung(
        "lmi, preconditioned",
        Method.LMI,
        lambda f: f.may_share_an_ellipsoid,
        _in("common_quadratic", "search_preconditioned"),
        only_quadratic=True,
    ),
    Rung(
        "gradient",
        Method.GRADIENT,
        lambda f: f.may_share_a_function,
        _in("common_quadratic", "search_by_gradient"),
        only_quadratic=True,
    ),
    Rung("every mode", None, _always, _in("unstable_mode", "examine_every_mode"), coupled=True),
    Rung(
        "constant values",
        Method.VALUE,
        lambda f: f.has_values,
        _in("unstable_value", "search_value"),
    ),
    Rung(
        "parameter quadratic",
        Method.PARAMETER_QUADRATIC,
        lambda f: f.has_constant and f.leaves_stable,
        _in("parameter_quadratic", "search_parameter_quadratic"),
    ),
    Rung(
        "mode quadratic",
        Method.MODE_QUADRATIC,
        _always,
        _in("mode_quadratic", "search_mode_functions"),
        # Under arbitrary switching in continuous time, all modes have the same function.
        in_auto=lambda f: f.has_rules or (f.is_arbitrary and not f.is_continuous),
    ),
    Rung(
        "mixture",
        Method.MIXTURE,
        lambda f: f.is_arbitrary and f.is_continuous,
        _in("mixture", "search_mixture"),
        coupled=True,
    ),
    Rung(
        "polynomial",
        Method.POLYNOMIAL,
        lambda f: f.may_share_a_function,
        _in("polynomial", "search_polynomial"),
        cost=_in("polynomial", "family_cost"),
    ),
    Rung(
        "mode polynomial",
        Method.MODE_POLYNOMIAL,
        lambda f: f.has_rules and not f.is_continuous,
        _in("mode_quadratic", "search_mode_functions"),
        cost=_in("mode_quadratic", "functions_cost"),
    ),
    Rung(
        "period",
        Method.PERIOD,
        lambda f: f.system.is_uniform,
        _in("period", "search_period"),
        coupled=True,
    ),
    Rung(
        "switching at constant values",
        Method.VALUE,
        lambda f: f.has_values,
        _in("unstable_value", "search_switching_at_values"),
    ),
)


def applicable_methods(system: SwitchedSystem) -> set[Method]:
    """Return what can be asked for, given the system's kind of switching and time."""
    facts = Facts.of(system)
    return {rung.method for rung in LADDER if rung.method is not None and rung.can_decide(facts)}


def steps(
    system: SwitchedSystem,
    method: Method,
    limits: Limits,
    allowance: Allowance,
    has_no_quadratic: Callable[[], bool],
) -> Iterator[Step]:
    """Yield the names of the rungs with their searches, in the order in which they are tried.

    Parameters
    ----------
    system : SwitchedSystem
        The modes and their switching.
    method : Method
        What was asked for: one of the `applicable_methods`, or all of them.
    limits : Limits
        How far to go.
    allowance : Allowance
        What is left of the budget when a step is asked for decides how far degrees rise.
    has_no_quadratic : callable
        Tells whether it has been shown by now that there is no common quadratic function.
    """
    facts = Facts.of(system)
    rising = []
    for rung in LADDER:
        if not rung.is_wanted(facts, method) or (rung.only_quadratic and has_no_quadratic()):
            continue
        own = rung.steps(system, limits, allowance)
        yield from islice(own, rung.count_first(system))
        rising.append(own)
    for higher in zip_longest(*rising):
        yield from (step for step in higher if step is not None)
