"""Chapter 5.1.1.1: the gradient iteration on the pairs that the thesis uses it for."""

from __future__ import annotations

from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.family import Family
from nrs_design.search.gradient import GradientResult, find_by_gradient
from nrs_design.search.gradient_settings import Coordinates, Gradient, Order
from nrs_design.thesis.comparison import ReproducedValue, derived
from nrs_design.thesis.matrices import family, hybrid_rows
from nrs_design.thesis.switching import tool_and_tissue, withdrawal

# Updates that a row tries, enough for what ends at all in the scan below, and quick.
UPDATES, FEW = 20_000, 2000
# One radius of many; the thesis prints none.
RADIUS = 1e5
ENDS = (
    "At every decade of radius from 1 to 1e12 it ends within 20,000 updates, with one start and "
    "order or another; at 0.01 and 0.1 not within 20,000. The count depends on rounding, too."
)
OPEN = (
    "Not within 100,000 updates at any decade of radius from 0.01 to 1e12 (relaxation 1; 20,000 at "
    "0.5 and 1.9), with either start and order, nor within 2,000,000 at 0.01, 1 and 1000; that it "
    "never ends is not shown. The thesis prints no Q, no relaxation and no radius, so its own run "
    "cannot be repeated."
)
SOON = "Other coordinates of the same pair; how many updates it takes depends on rounding, too."


def pairs() -> tuple[tuple[str, str, SwitchedSystem], ...]:
    """Return section, name and system of the three pairs, in the states of the thesis."""
    return (
        ("6.3.2.2", "Bt 2.15 and 1.04", withdrawal()),
        ("6.3.3.2", "position and force", family("hybrid", *hybrid_rows())),
        ("6.4.1", "tool and tissue", tool_and_tissue()),
    )


def rows() -> tuple[ReproducedValue, ...]:
    """Run the iteration on all pairs, in the states of the thesis and in others."""
    return tuple(
        _row(section, name, system, coordinates)
        for section, name, system in pairs()
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
    """Run the iteration once.

    Parameters
    ----------
    system : SwitchedSystem
        The pair.
    coordinates, radius, order, updates, start
        See `Gradient`.
    """
    way = Gradient(
        radius=radius, start=start, order=order, coordinates=coordinates, max_updates=updates
    )
    return find_by_gradient(Family.of(system, gradient=way))


def _row(
    section: str, name: str, system: SwitchedSystem, coordinates: Coordinates
) -> ReproducedValue:
    given = coordinates == Coordinates.GIVEN
    ends = section == "6.3.3.2" or not given
    radius, updates = RADIUS if given else 1.0, UPDATES if ends else FEW
    found = [run(system, coordinates, radius, order, updates) for order in Order]
    ended = [result.Q is not None for result in found]
    states = "the states of the thesis" if given else f"{coordinates} coordinates"
    return derived(
        f"updates of the gradient iteration, {name}, {states}, radius {radius:g}",
        section,
        ", ".join(
            f"not within {updates:,}" if result.Q is None else f"{result.updates:,}"
            for result in found
        ),
        # Of the two orders one suffices: which of them is quicker depends on rounding.
        holds=any(ended) == ends,
        note=f"Modes in turn, at random. {(ENDS if ends else OPEN) if given else SOON}",
    )
