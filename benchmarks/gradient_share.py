"""Settle by the gradient iteration what the LMI proves: which share, and in what time."""

from __future__ import annotations

from time import perf_counter

from benchmarks.families import to_system
from benchmarks.measure import Finding, Size
from benchmarks.random_families import COUNT, DECIMALS, QUICK_COUNT, SMOKE_COUNT, draw_families
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from nrs_design.search.family import Family
from nrs_design.search.gradient import Coordinates, Gradient, Order, find_by_gradient
from nrs_design.search.method import Method

# Numbers of states that are counted together.
ORDERS = ((2, 4), (5, 8), (9, 12))
MAX_UPDATES, QUICK_MAX_UPDATES = 5000, 1000
AIM = 0.9


def run(size: Size) -> tuple[Finding, ...]:
    """Take the families that the LMI proves, and run the iteration on each."""
    families = draw_families(size.pick(COUNT, QUICK_COUNT, SMOKE_COUNT))
    systems = [to_system(matrices, DECIMALS) for matrices in families]
    proved = [system for system in systems if _is_proved(system)]
    updates = size.pick(MAX_UPDATES, QUICK_MAX_UPDATES, 10)
    default, balanced, printed = (
        Gradient(coordinates=coordinates, max_updates=updates) for coordinates in Coordinates
    )
    random = Gradient(order=Order.RANDOM, max_updates=updates)
    small = Gradient(radius=0.01, max_updates=updates)
    return (
        *(_settle(f"n = {low}..{high}", _between(proved, low, high), default)
          for low, high in ORDERS),
        _settle("all, modes at random", proved, random),
        _settle("all, r = 0.01", proved, small),
        _settle("all, balanced", proved, balanced),
        _settle("all, states as given", proved, printed),
    )  # fmt: skip


def _between(systems: list[SwitchedSystem], low: int, high: int) -> list[SwitchedSystem]:
    return [system for system in systems if low <= system.order <= high]


def _settle(what: str, systems: list[SwitchedSystem], gradient: Gradient) -> Finding:
    start = perf_counter()
    _ = [_is_proved(system) for system in systems]
    middle = perf_counter()
    settled = sum(find_by_gradient(Family.of(s), gradient).Q is not None for s in systems)
    seconds = perf_counter() - middle
    return Finding(
        f"gradient on families with a proof by LMI: {what}",
        f"{settled} of {len(systems)} within {gradient.max_updates} updates each; the LMI needs "
        f"{middle - start:.1f} s for all of them",
        f"at least {AIM:.0%}",
        settled >= AIM * len(systems),
        seconds,
    )


def _is_proved(system: SwitchedSystem) -> bool:
    return certify(system, Method.LMI, Limits(optimize_rate=False)).verdict == "proved"
