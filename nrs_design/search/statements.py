"""Searches for further statements: bounds, and regions of attraction under saturation."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import partial

from nrs_design.proof.channels import Channel, Output
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.acceptance import Candidates
from nrs_design.search.work import Allowance, NotAffordableError

# Share of the work on a bound for ellipsoids off the origin.
OFF_THE_ORIGIN = 0.7
SATURATION = "decay under saturation"
NOT_IN_TURNS = (
    "not looked for: where the loop has two periods, misses deadlines or counts dwell times, decay "
    "is proved, and no bound"
)

Aside = tuple[str, Callable[[], Candidates[AbstractEvidence]], Allowance]


def asides(system: SwitchedSystem, allowance: Allowance) -> Iterator[Aside]:
    """Yield names of statements with their searches, and the work that each may take.

    Bounds are on every output under all disturbances at once, and on the first output under each
    disturbance alone. Under saturation, regions show from where motions decay.
    """
    alone = [(channel,) for channel in system.channels]
    pairs = [(system.channels, output) for output in system.outputs if alone]
    if len(alone) > 1:
        pairs += [(channels, output) for channels in alone for output in system.outputs[:1]]
    for count, (channels, output) in enumerate(pairs):
        name = f"bound on {output.name} under {' and '.join(channel.name for channel in channels)}"
        own = allowance.part(1 / (len(pairs) - count))
        yield name, partial(_ellipsoids, system, channels, output, own), own
    if system.saturation is not None:
        from nrs_design.search.saturated_ellipsoid import search_saturated

        yield SATURATION, partial(search_saturated, system, allowance), allowance


def _ellipsoids(
    system: SwitchedSystem, channels: Sequence[Channel], output: Output, allowance: Allowance
) -> Candidates[AbstractEvidence]:
    """Yield ellipsoids off the origin, where contact may be lost, before those around it."""
    if system.clock is not None:
        return NOT_IN_TURNS
    if not any(any(map(any, B.numerators)) for channel in channels for B in channel.columns):
        return "it moves nothing in any mode"
    from nrs_design.search.invariant_ellipsoid import search_ellipsoid, search_offset_ellipsoid

    if system.contact is not None:
        own = allowance.part(OFF_THE_ORIGIN)
        with suppress(NotAffordableError):
            yield from search_offset_ellipsoid(system, channels, output, own)
    return (yield from search_ellipsoid(system, channels, output, allowance))
