"""What no proof of a design covers; every exported file says it."""

from __future__ import annotations

NOTHING = "Everything: nothing is proved."
CONTINUOUS = (
    "Sampling and delay: the proof is about continuous time, and a program that runs the law in "
    "steps is not covered."
)
NOT_ROUNDED = (
    "Rounding: the proof is about the law computed without it, not about single-precision "
    "arithmetic."
)
OUTSIDE = (
    "Whatever a program does beside the law: clamps, saturation, rate limits, guards against wrong "
    "input, its start and its stop.",
    "Input and output: sensors, buses, drivers, clocks and schedulers, beyond what the assumptions "
    "say of them.",
    "Whether the program, its compiler and its processor compute the law with these numbers.",
)


def outside_of(*, sampled: bool, rounded: bool) -> tuple[str, ...]:
    """Return the effects outside a proof."""
    if not sampled:
        return (CONTINUOUS, *OUTSIDE)
    return OUTSIDE if rounded else (NOT_ROUNDED, *OUTSIDE)
