"""What is stated beside a proof of stability: bounds, and regions under saturation."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from functools import partial

from nrs_design.progress import Progress
from nrs_design.proof.channels import Channel, Output
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.acceptance import Candidates, attempted
from nrs_design.search.certification import Attempt
from nrs_design.work import Allowance, NotAffordableError

# Share of the work on a bound for ellipsoids off the origin.
OFF_THE_ORIGIN = 0.7
SATURATION = "decay under saturation"
NOT_IN_TURNS = (
    "not looked for: where the loop has two periods, misses deadlines or counts dwell times, decay "
    "is proved, and no bound"
)


def bounds(
    system: SwitchedSystem, allowance: Allowance, progress: Progress
) -> tuple[tuple[AbstractEvidence, ...], tuple[Attempt, ...]]:
    """Bound every output under all disturbances at once, and the first one under each alone."""
    alone = [(channel,) for channel in system.channels]
    pairs = [(system.channels, output) for output in system.outputs if alone]
    if len(alone) > 1:
        pairs += [(channels, output) for channels in alone for output in system.outputs[:1]]
    if not pairs:
        return (), ()
    if system.clock is not None:
        return (), tuple(Attempt(_bound_name(*pair), NOT_IN_TURNS, 0.0) for pair in pairs)
    found: list[AbstractEvidence] = []
    attempts: list[Attempt] = []
    for count, (channels, output) in enumerate(pairs):
        name = _bound_name(channels, output)
        progress(name)
        own = allowance.part(1 / (len(pairs) - count))
        search = partial(_ellipsoids, system, channels, output, own)
        evidence, attempt = attempted(name, search, system, own)
        found += evidence
        attempts += attempt
    return tuple(found), tuple(attempts)


def _ellipsoids(
    system: SwitchedSystem, channels: Sequence[Channel], output: Output, allowance: Allowance
) -> Candidates[AbstractEvidence]:
    """Yield ellipsoids off the origin, where contact may be lost, before those around it."""
    if not any(any(map(any, B.numerators)) for channel in channels for B in channel.columns):
        return "it moves nothing in any mode"
    from nrs_design.search.invariant_ellipsoid import search_ellipsoid, search_offset_ellipsoid

    if system.contact is not None:
        own = allowance.part(OFF_THE_ORIGIN)
        with suppress(NotAffordableError):
            yield from search_offset_ellipsoid(system, channels, output, own)
    return (yield from search_ellipsoid(system, channels, output, allowance))


def _bound_name(channels: Sequence[Channel], output: Output) -> str:
    return f"bound on {output.name} under {' and '.join(channel.name for channel in channels)}"


def regions(
    system: SwitchedSystem, allowance: Allowance, progress: Progress
) -> tuple[tuple[AbstractEvidence, ...], tuple[Attempt, ...]]:
    """Show from where motions decay although signals saturate, where the system has some."""
    if system.saturation is None:
        return (), ()
    from nrs_design.search.saturated_ellipsoid import search_saturated

    progress(SATURATION)
    search = partial(search_saturated, system, allowance)
    return attempted(SATURATION, search, system, allowance)
