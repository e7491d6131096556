"""The ladder: which searches there are, what they can decide, and in which order they are tried."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import islice, zip_longest
from typing import Any

from nrs_design.late import late_function
from nrs_design.proof.evidence import Shows
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.certification import Limits
from nrs_design.search.method import Method
from nrs_design.search.rung import Facts, Rung, Step
from nrs_design.work import Allowance

# Work of a degree of what is tried before the cheaper rungs.
QUICK = 0.5


def _in(module: str, name: str) -> Callable[..., Any]:
    """Name a function of a module here: most rungs are never reached, and need not be loaded."""
    return late_function(f"nrs_design.search.{module}", name)


def _always(facts: Facts) -> bool:
    """Say yes."""
    return True


def _uniform(facts: Facts) -> bool:
    return facts.system.is_uniform


TOGETHER, MODES = _in("graphs", "search_together"), _in("graphs", "search_modes")
OBSTRUCTION = _in("obstruction", "search_obstruction")
# Cheapest first. A rung that rises is tried here with its first degrees, with higher ones at last.
LADDER: tuple[Rung, ...] = (
    Rung(
        "quadratic for each controller",
        Method.PERIODIC_QUADRATIC,
        Facts.counts_stays,
        _in("counted_stays", "search_stays"),
        clocked=True,
    ),
    Rung(
        "periodic quadratic",
        Method.PERIODIC_QUADRATIC,
        lambda f: not f.counts_stays(),
        _in("graphs", "search_periodic_quadratic"),
        clocked=True,
    ),
    Rung("rounds", Method.PERIOD, _always, _in("period", "search_rounds"), clocked=True),
    Rung("suspicious modes", None, _uniform, _in("unstable_mode", "examine_suspicious_modes")),
    Rung(
        "one state",
        Method.LMI,
        lambda f: f.may_share_a_function() and f.system.order == 1,
        _in("graphs", "decide_one_state"),
    ),
    Rung("conewise quadratic", Method.CONEWISE_QUADRATIC, Facts.loses_contact, TOGETHER),
    Rung("quadratic, with roundings", Method.LMI, Facts.rounds, TOGETHER),
    # Before what takes for granted that contact is kept; that no quadratic function exists is said
    # of the matrices all the same.
    Rung("obstruction in contact", Method.OBSTRUCTION, Facts.may_bounce, OBSTRUCTION),
    Rung(
        "conewise mode quadratic",
        Method.CONEWISE_MODE_QUADRATIC,
        Facts.bounces_in_steps,
        _in("graphs", "search_conewise_modes"),
    ),
    Rung(
        "conewise polynomial",
        Method.CONEWISE_POLYNOMIAL,
        Facts.bounces_in_time,
        _in("graphs", "search_conewise_polynomial"),
        cost=_in("polynomial", "conewise_cost"),
        first=QUICK,
    ),
    # After what proves through the loss of contact, before what speaks of kept contact.
    *(
        Rung(
            f"{what} with loss of contact",
            Method.PERIOD,
            lambda f: f.system.is_losable,
            _in("unstable_contact", "search_contact"),
            clocked=clocked,
            in_kept_contact=False,
        )
        for clocked, what in ((False, "growth"), (True, "rounds"))
    ),
    Rung("lmi", Method.LMI, Facts.may_share_an_ellipsoid, _in("graphs", "search_by_lmi")),
    Rung(
        "obstruction",
        Method.OBSTRUCTION,
        lambda f: f.may_share_a_function() and not f.may_bounce(),
        OBSTRUCTION,
    ),
    Rung(
        "gradient",
        Method.GRADIENT,
        Facts.may_share_a_function,
        _in("gradient", "search_by_gradient"),
    ),
    Rung("every mode", None, _always, _in("unstable_mode", "examine_every_mode")),
    Rung("constant values", Method.VALUE, Facts.has_values, _in("unstable_value", "search_value")),
    Rung(
        "constants quadratic",
        Method.CONSTANTS_QUADRATIC,
        Facts.has_values,
        _in("constants_quadratic", "search_constants_quadratic"),
    ),
    Rung(
        "mode quadratic",
        Method.MODE_QUADRATIC,
        _always,
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
        _in("memory", "search_memory"),
        lengths=_in("memory", "quadratic_memories"),
        first=QUICK,
    ),
    Rung(
        "words in the norms of forms",
        Method.PERIOD,
        Facts.is_of_words,
        _in("memory", "search_extremal_words"),
    ),
    Rung(
        "quartic with a memory",
        Method.MEMORY_POLYNOMIAL,
        Facts.is_of_words,
        _in("memory", "search_quartic_memory"),
        lengths=_in("memory", "quartic_memories"),
        degree=4,
        first=QUICK,
    ),
    Rung(
        "mixture",
        Method.MIXTURE,
        lambda f: f.system.switching.is_arbitrary and f.is_continuous(),
        _in("unstable_value", "search_mixture"),
    ),
    Rung(
        "polynomial",
        Method.POLYNOMIAL,
        Facts.may_share_a_function,
        _in("graphs", "search_polynomial"),
        cost=_in("polynomial", "family_cost"),
    ),
    Rung(
        "mode polynomial",
        Method.MODE_POLYNOMIAL,
        lambda f: f.has_rules() and not f.is_continuous(),
        MODES,
        cost=_in("polynomial", "functions_cost"),
    ),
    Rung("period", Method.PERIOD, _uniform, _in("period", "search_period")),
    Rung(
        "switching at constant values",
        Method.VALUE,
        Facts.has_values,
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
