"""Chapter 5.1.1.1: the gradient iteration on the pairs that the thesis uses it for."""

from __future__ import annotations

from nrs_design.proof.system import SwitchedSystem
from nrs_design.reproduction.comparison import ReproducedValue, derived
from nrs_design.reproduction.switching import tool_and_tissue, withdrawal
from nrs_design.search.family import Family
from nrs_design.search.gradient import find_by_gradient
from nrs_design.search.gradient_settings import Coordinates, Gradient, Order

# Enough to tell tens from never, and quick.
UPDATES = 2000
NEVER = (
    "No end either within 2,000,000 updates, for relaxations 0.5, 1 and 1.9, radii 0.01, 1 and "
    "1000, both starts and both orders; with the printed (4, 1), (4, 2) and (3, 3), neither. The "
    "thesis prints no Q, no relaxation and no radius, so its own run cannot be repeated."
)
SOON = "Other coordinates of the same pair; how many updates it takes depends on rounding, too."


def rows() -> tuple[ReproducedValue, ...]:
    """Run the iteration on both pairs, in the states of the thesis and in others."""
    pairs = (
        ("6.3.2.2", "Bt 2.15 and 1.04", withdrawal()),
        ("6.4.1", "tool and tissue", tool_and_tissue()),
    )
    return tuple(
        _row(section, name, system, coordinates)
        for section, name, system in pairs
        for coordinates in reversed(Coordinates)
    )


def _row(
    section: str, name: str, system: SwitchedSystem, coordinates: Coordinates
) -> ReproducedValue:
    ways = [Gradient(order=order, coordinates=coordinates, max_updates=UPDATES) for order in Order]
    found = [find_by_gradient(Family.of(system, gradient=way)) for way in ways]
    printed = coordinates == Coordinates.GIVEN
    states = "the states of the thesis" if printed else f"{coordinates} coordinates"
    return derived(
        f"updates of the gradient iteration, {name}, {states}",
        section,
        ", ".join(
            f"no end within {UPDATES}" if result.Q is None else str(result.updates)
            for result in found
        ),
        holds=all((result.Q is None) == printed for result in found),
        note=f"Modes in turn, at random. {NEVER if printed else SOON}",
    )
