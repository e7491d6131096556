"""Chapter 5.1.1.1: the gradient iteration on the pairs that the thesis uses it for."""

from __future__ import annotations

from collections.abc import Iterable

from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.family import Family
from nrs_design.search.gradient import GradientResult, find_by_gradient
from nrs_design.search.gradient_settings import Coordinates, Gradient, Order
from nrs_design.thesis.comparison import Found, Recomputed
from nrs_design.thesis.matrices import family, hybrid_rows
from nrs_design.thesis.switching import tool_and_tissue, withdrawal

# Updates that a row tries, enough for what ends at all in the scan below, and quick.
UPDATES, FEW = 20_000, 2000
# One radius of many; the thesis prints none.
RADIUS = 1e5


def pairs() -> tuple[tuple[str, SwitchedSystem], ...]:
    """Return section and system of the three pairs, in the states of the thesis."""
    return (
        ("6.3.2.2", withdrawal()),
        ("6.3.3.2", family("hybrid", *hybrid_rows())),
        ("6.4.1", tool_and_tissue()),
    )


def results() -> Iterable[Found]:
    """Run the iteration on all pairs, in the states of the thesis and in others."""
    return (
        _result(system, coordinates, ends=section == "6.3.3.2" or coordinates != Coordinates.GIVEN)
        for section, system in pairs()
        for coordinates in reversed(Coordinates)
    )


def run(
    system: SwitchedSystem,
    coordinates: Coordinates = Coordinates.GIVEN,
    radius: float = RADIUS,
    order: Order = Order.ROUND_ROBIN,
    updates: int = UPDATES,
    start: str | None = None,
) -> GradientResult:
    """Run the iteration once; for what is given see `Gradient`."""
    way = Gradient(
        radius=radius, start=start, order=order, coordinates=coordinates, max_updates=updates
    )
    return find_by_gradient(Family.of(system, gradient=way))


def _result(system: SwitchedSystem, coordinates: Coordinates, *, ends: bool) -> Recomputed:
    radius = RADIUS if coordinates == Coordinates.GIVEN else 1.0
    updates = UPDATES if ends else FEW
    found = [run(system, coordinates, radius, order, updates) for order in Order]
    told = ", ".join(
        f"not within {updates:,}" if result.Q is None else f"{result.updates:,}" for result in found
    )
    # Of the two orders one suffices: which of them is quicker depends on rounding.
    return Recomputed(told, any(result.Q is not None for result in found) == ends)
