"""What no proof of a design covers, in words: it stands in every file that leaves."""

from __future__ import annotations

CONTINUOUS = (
    "Sampling and delay: the proof is about continuous time, and a program that runs the law in "
    "steps is not covered."
)
OUTSIDE = (
    "Whatever a program does beside the law: clamps, saturation, rate limits, guards against wrong "
    "input, its start and its stop.",
    "Input and output: sensors, buses, drivers, clocks and schedulers, beyond what the assumptions "
    "say of them.",
    "Whether the program, its compiler and its processor compute the law with these numbers.",
)


def outside_of(*, sampled: bool) -> tuple[str, ...]:
    """Return what is outside a proof.

    Parameters
    ----------
    sampled : bool
        Whether the proof is about the loop as a processor samples it.
    """
    return OUTSIDE if sampled else (CONTINUOUS, *OUTSIDE)
